// What all kernels share: the features that they are compiled for, the materials in time and what methods move a mass
// with.
#pragma once

#include "cuda/layout/formats.hpp"
#include "physics/physics.hpp"

namespace evodevo::cuda {

using Number = EVODEVO_NUMBER;
constexpr bool actuation = EVODEVO_ACTUATION;
constexpr bool gravity = EVODEVO_GRAVITY;
constexpr bool slope = EVODEVO_SLOPE;
constexpr bool floor_on = EVODEVO_FLOOR;
constexpr bool rough = EVODEVO_ROUGH;
constexpr bool friction = EVODEVO_FRICTION;
constexpr bool damping = EVODEVO_DAMPING;
constexpr bool drag = EVODEVO_DRAG;
constexpr bool stress = EVODEVO_STRESS;
constexpr bool work = EVODEVO_WORK;
constexpr bool peak_force = EVODEVO_PEAK_FORCE;
constexpr bool muscle_work = EVODEVO_MUSCLE_WORK;
constexpr bool mean_tension = EVODEVO_TENSION;

constexpr unsigned rows_per_step = EVODEVO_ROWS_PER_STEP;      // of the tables of lengths
constexpr unsigned end_rows = EVODEVO_END_ROWS;                // 1 where a step reads the row at its end, else 0
constexpr unsigned opening_passes = EVODEVO_OPENING_PASSES;    // over the springs, before the first of some steps
constexpr unsigned passes_per_step = EVODEVO_PASSES_PER_STEP;  // over the springs

using Place = physics::Triple<Number>;

/// Where in its cycle a material is at `time` (s since birth), half turns. It is reduced in double precision, so that
/// late times lose no digits.
__device__ __forceinline__ double half_turns(const Actuator& actuator, double time) {
  const double turns = actuator.frequency * time;
  return 2 * (turns - floor(turns)) + actuator.phase;
}

/// A material at a time.
__device__ __forceinline__ Entry<Number> entry_of(const Actuator& actuator, double time) {
  double length = 1;  // L/L0
  if constexpr (actuation) length += actuator.amplitude * sinpi(half_turns(actuator, time));
  return {static_cast<Number>(actuator.stiffness), static_cast<Number>(actuator.stiffness * length)};
}

/// The rate of L/L0 at a time, 1/s.
__device__ __forceinline__ Number length_rate(const Actuator& actuator, double time) {
  double rate = 0;
  if constexpr (actuation)
    rate = 2 * 3.14159265358979323846 * actuator.frequency * actuator.amplitude * cospi(half_turns(actuator, time));
  return static_cast<Number>(rate);
}

/// A mass while it is moved.
struct Moving {
  Place place;          ///< m
  Place velocity;       ///< m/s
  Place force;          ///< N
  Number mass;          ///< kg
  Number inverse_mass;  ///< 1/kg; 0 for what never moves
  Number push = 0;      ///< of the floor, N
};

/// A pass over all springs, after which every mass is moved.
struct Pass {
  unsigned index;  ///< of some steps'
  bool last;       ///< of them
};

/// What a method may leave as it is. It adds `move(world, pass, kept, m)`: what the forces of a pass do to a mass.
struct OnePass {
  /// What a mass keeps from one pass to the next.
  struct Kept {};
  /// The row of the tables, from the one at the beginning of the steps, that pass `index` takes the lengths from.
  static __device__ __forceinline__ unsigned row(unsigned index) { return index; }
  /// Whether the forces of pass `index` count for stress and work.
  static __device__ __forceinline__ bool is_noted(unsigned) { return true; }
};

/// a + factor b
__device__ __forceinline__ Place sum(const Place& a, Number factor, const Place& b) {
  return {physics::multiply_add(factor, b.x, a.x), physics::multiply_add(factor, b.y, a.y),
          physics::multiply_add(factor, b.z, a.z)};
}

__device__ __forceinline__ Place scaled(const Place& a, Number factor) {
  return {a.x * factor, a.y * factor, a.z * factor};
}

__device__ __forceinline__ void add_gravity(const World<Number>& world, Moving& m) {
  if constexpr (gravity) m.force.z += physics::weight(m.mass, world.acceleration);
  if constexpr (slope) m.force.x += physics::downhill_force(physics::weight(m.mass, world.acceleration), world.grade);
}

/// The rough ground under a place.
__device__ __forceinline__ auto ground_under(const World<Number>& world, const Place& place) {
  return physics::ground_at(place.x, place.y, physics::Roughness<Number>{world.roughness, world.cells, world.seed});
}

/// How far a mass is above the ground, m.
__device__ __forceinline__ Number clearance(const World<Number>& world, const Place& place) {
  Number z = place.z;
  if constexpr (rough) z -= ground_under(world, place).height;
  return z;
}

/// A mass's velocity away from the ground, as far as z counts, m/s.
__device__ __forceinline__ Number rise(const World<Number>& world, const Place& place, const Place& velocity) {
  Number up = velocity.z;
  if constexpr (rough) up = physics::off_ground(ground_under(world, place), velocity);
  return up;
}

/// Where a mass is above the ground after a step, m, the ground going on as it is at its beginning.
__device__ __forceinline__ Number next_clearance(const World<Number>& world, const Moving& m) {
  return physics::moved(clearance(world, m.place), rise(world, m.place, m.velocity), world.dt);
}

/// Adds what the ground's push, `up` along z, has along x and y where the ground is not level.
__device__ __forceinline__ void lean(const World<Number>& world, const Place& place, Number up, Place& v) {
  if constexpr (rough) v = physics::leaned(ground_under(world, place), v, up);
}

__device__ __forceinline__ void add_floor(const World<Number>& world, Moving& m) {
  if constexpr (floor_on) {
    m.push = physics::floor_force(world.floor_stiffness, clearance(world, m.place));
    m.force.z += m.push;
    lean(world, m.place, m.push, m.force);
  }
}

__device__ __forceinline__ void add_drag(const World<Number>& world, Moving& m) {
  if constexpr (drag) m.force = sum(m.force, physics::drag_factor(world.drag_coefficient, m.velocity), m.velocity);
}

/// Damping as a force.
__device__ __forceinline__ void add_damping(const World<Number>& world, Moving& m) {
  if constexpr (damping) m.force = sum(m.force, physics::damping_factor(world.damping_rate, m.mass), m.velocity);
}

/// Drag for a time in which acceleration adds `time` (s) of itself: scales the velocity and, where forces act in it,
/// the forces.
template <bool forces_too>
__device__ __forceinline__ void yield_to_drag(const World<Number>& world, Number time, Moving& m) {
  if constexpr (drag) {
    const Number coefficient = world.drag_coefficient * time * m.inverse_mass;
    const Number kept = physics::drag_retention(coefficient, m.velocity);
    m.velocity = scaled(m.velocity, kept);
    if constexpr (forces_too) m.force = scaled(m.force, kept);
  }
}

/// v <- v + time F/m
__device__ __forceinline__ void advance_velocity(Number time, Moving& m) {
  const Number time_over_mass = time * m.inverse_mass;
  m.velocity.x = physics::advanced_velocity(m.velocity.x, m.force.x, time_over_mass);
  m.velocity.y = physics::advanced_velocity(m.velocity.y, m.force.y, time_over_mass);
  m.velocity.z = physics::advanced_velocity(m.velocity.z, m.force.z, time_over_mass);
}

__device__ __forceinline__ void damp(Number decay, Moving& m) {
  if constexpr (damping) m.velocity = scaled(m.velocity, decay);
}

/// What the floor's friction leaves of a velocity; `friction_time`: its coefficient times the time, s.
__device__ __forceinline__ void rub(Number friction_time, const Moving& m, Place& velocity) {
  if constexpr (friction) {
    // of a mass off the floor it takes nothing, and most are
    if (m.push > 0) {
      const Number kept = physics::friction_factor(velocity.x, velocity.y, friction_time * m.push * m.inverse_mass);
      velocity.x *= kept;
      velocity.y *= kept;
    }
  }
}

/// x <- x + time v
__device__ __forceinline__ void move_on(Number time, Moving& m) {
  m.place.x = physics::moved(m.place.x, m.velocity.x, time);
  m.place.y = physics::moved(m.place.y, m.velocity.y, time);
  m.place.z = physics::moved(m.place.z, m.velocity.z, time);
}

}  // namespace evodevo::cuda
