// Code shared by all kernels: the features for which they are compiled, the materials as functions of time, and the
// parts of a step for one mass.
//
// A method's `move` gets a mass with the sum of its spring forces (Moving) and calls the following functions, in an
// order of its own:
//   note_arrival                                    velocity ─► how fast the mass arrives at a rigid floor
//   add_gravity, add_floor, add_drag, add_damping   position, velocity ─► added to the force
//   advance_velocity, damp, apply_drag, apply_friction, land   force ─► velocity
//   advance_position                                velocity ─► position
#pragma once

#include "cuda/layout/feature_list.hpp"
#include "cuda/layout/formats.hpp"
#include "physics/physics.hpp"

namespace evodevo::cuda {

using Number = EVODEVO_NUMBER;
constexpr bool always = true;
#define EVODEVO_CONSTANT(name, whole)       \
  constexpr bool name = EVODEVO_HAS_##name; \
  static_assert(!name || whole, #name " is a part of " #whole);
EVODEVO_FEATURES(EVODEVO_CONSTANT)
#undef EVODEVO_CONSTANT

/// Functions that exist for a feature alone are templates that assert only_for<feature, T>. So a kernel without the
/// feature does not compile if it calls one.
template <bool feature, class>
constexpr bool only_for = feature;

constexpr unsigned rows_per_step = EVODEVO_ROWS_PER_STEP;      // rows per step in the tables of lengths
constexpr unsigned end_rows = EVODEVO_END_ROWS;                // 1 if a step reads the row at its end, otherwise 0
constexpr unsigned opening_passes = EVODEVO_OPENING_PASSES;    // over the springs before the first step after a check
constexpr unsigned passes_per_step = EVODEVO_PASSES_PER_STEP;  // over the springs in each step

using Vector = physics::Triple<Number>;

/// The phase of a material's actuation at `time` (s since birth), half turns. The phase is reduced in double precision,
/// so that late times lose no digits.
template <class T>
__device__ __forceinline__ double half_turns(const T& actuator, double time) {
  static_assert(only_for<actuation, T>);
  const double turns = actuator.frequency * time;
  return 2 * (turns - floor(turns)) + actuator.phase;
}

/// A material at a given time (s since birth).
__device__ __forceinline__ Entry<Number> entry_of(const Actuator& actuator, double time) {
  double length = 1;  // L/L0
  if constexpr (actuation) length += actuator.amplitude * sinpi(half_turns(actuator, time));
  return {static_cast<Number>(actuator.stiffness), static_cast<Number>(actuator.stiffness * length)};
}

/// The rate of change of L/L0 at a given time (s since birth), 1/s.
template <class T>
__device__ __forceinline__ Number length_rate(const T& actuator, double time) {
  static_assert(only_for<work, T>);
  double rate = 0;
  if constexpr (actuation)
    rate = 2 * 3.14159265358979323846 * actuator.frequency * actuator.amplitude * cospi(half_turns(actuator, time));
  return static_cast<Number>(rate);
}

/// A mass while it is moved.
struct Moving {
  Vector position;          ///< m
  Vector velocity;          ///< m/s
  Vector force;             ///< N
  Number mass;              ///< kg
  Number inverse_mass;      ///< 1/kg; 0 for masses that never move
  Number normal_force = 0;  ///< normal force of an elastic floor, N
  Number arrival = 0;       ///< rise at the beginning of the step, m/s; of a rigid floor
  Number push = 0;          ///< velocity that a rigid floor has added in the step along its unit normal, m/s
};

/// A pass over all springs, after which every mass is moved. Passes are numbered from one check to the next.
struct Pass {
  unsigned index;  ///< from 0
  bool last;       ///< whether this is the last pass before the next check
};

/// The base of an explicit method, with defaults that the method may override. The method adds
/// `move(constants, pass, kept, m)`, which moves the mass m by the forces of a pass.
struct OnePass {
  /// The state that a mass keeps from one pass to the next.
  struct Kept {};
  /// The row of the tables from which pass `index` reads the lengths.
  static __device__ __forceinline__ unsigned row(unsigned index) { return index; }
  /// Whether the forces of pass `index` are recorded.
  static __device__ __forceinline__ bool is_recorded(unsigned) { return true; }
  /// Whether a pass brings masses to where they are at the end of a step.
  static __device__ __forceinline__ bool ends_motion(Pass) { return true; }
  /// The velocity (m/s) at which dashpots act on a mass in the next pass. `m` is the mass after it has been moved;
  /// `before` is that velocity of the pass that moved it.
  static __device__ __forceinline__ Vector dashpot_velocity(const StepConstants<Number>&, Pass, const Moving& m,
                                                            Vector /*before*/) {
    return m.velocity;
  }
};

/// a + factor b
__device__ __forceinline__ Vector sum(const Vector& a, Number factor, const Vector& b) {
  return {physics::multiply_add(factor, b.x, a.x), physics::multiply_add(factor, b.y, a.y),
          physics::multiply_add(factor, b.z, a.z)};
}

/// a - b
__device__ __forceinline__ Vector difference(const Vector& a, const Vector& b) { return sum(a, Number(-1), b); }

__device__ __forceinline__ Vector scaled(const Vector& a, Number factor) {
  return {a.x * factor, a.y * factor, a.z * factor};
}

__device__ __forceinline__ void add_gravity(const StepConstants<Number>& constants, Moving& m) {
  if constexpr (gravity) m.force.z += physics::weight(m.mass, constants.acceleration);
  if constexpr (slope)
    m.force.x += physics::downhill_force(physics::weight(m.mass, constants.acceleration), constants.grade);
}

/// The rough ground under a point.
template <class T>
__device__ __forceinline__ physics::Ground<T> ground_under(const StepConstants<T>& constants, const Vector& position) {
  static_assert(only_for<rough, T>);
  return physics::ground_at(position.x, position.y,
                            physics::Roughness<T>{constants.roughness, constants.cells, constants.seed});
}

/// The height of a point above the ground, m.
__device__ __forceinline__ Number clearance(const StepConstants<Number>& constants, const Vector& position) {
  Number z = position.z;
  if constexpr (rough) z -= ground_under(constants, position).height;
  return z;
}

/// 1 if an elastic floor pushes a mass now, or if a rigid floor has pushed it in the step, otherwise 0.
__device__ __forceinline__ unsigned touches(const StepConstants<Number>& constants, const Moving& m) {
  bool is_pushed = false;
  if constexpr (elastic_floor) is_pushed = clearance(constants, m.position) < 0;
  if constexpr (rigid_floor) is_pushed = m.push > 0;
  return is_pushed ? 1 : 0;
}

/// The scalar product of a velocity with the ground's normal (-slope_x, -slope_y, 1), m/s.
__device__ __forceinline__ Number normal_velocity(const StepConstants<Number>& constants, const Vector& position,
                                                  const Vector& velocity) {
  Number up = velocity.z;
  if constexpr (rough) up = physics::along_normal(ground_under(constants, position), velocity);
  return up;
}

/// The height of a mass above the ground at the end of the step (m), with the ground's slope at the beginning of the
/// step.
__device__ __forceinline__ Number next_clearance(const StepConstants<Number>& constants, const Moving& m) {
  return physics::advanced_position(clearance(constants, m.position),
                                    normal_velocity(constants, m.position, m.velocity), constants.dt);
}

/// On rough ground, adds the x and y components of the vector up (-slope_x, -slope_y, 1) to v.
__device__ __forceinline__ void add_horizontal_part(const StepConstants<Number>& constants, const Vector& position,
                                                    Number up, Vector& v) {
  if constexpr (rough) v = physics::add_horizontal_part(ground_under(constants, position), v, up);
}

__device__ __forceinline__ void add_floor(const StepConstants<Number>& constants, Moving& m) {
  if constexpr (elastic_floor) {
    m.normal_force = physics::floor_force(constants.floor_stiffness, clearance(constants, m.position));
    m.force.z += m.normal_force;
    add_horizontal_part(constants, m.position, m.normal_force, m.force);
  }
}

__device__ __forceinline__ void add_drag(const StepConstants<Number>& constants, Moving& m) {
  if constexpr (drag) m.force = sum(m.force, physics::drag_factor(constants.drag_coefficient, m.velocity), m.velocity);
}

/// Adds damping to the force.
__device__ __forceinline__ void add_damping(const StepConstants<Number>& constants, Moving& m) {
  if constexpr (damping) m.force = sum(m.force, physics::damping_factor(constants.damping_rate, m.mass), m.velocity);
}

/// Applies quadratic drag over a step whose damped_dt is `time` (s): scales the velocity and, if `forces_too`, the
/// force that acts during the step (physics::drag_retention()).
template <bool forces_too>
__device__ __forceinline__ void apply_drag(const StepConstants<Number>& constants, Number time, Moving& m) {
  if constexpr (drag) {
    const Number coefficient = constants.drag_coefficient * time * m.inverse_mass;
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

/// Reduces a velocity by the friction of a floor that has added `push` (m/s) along its unit normal, of which forces
/// have caused `pressed` (physics::after_friction()).
__device__ __forceinline__ void rub(const StepConstants<Number>& constants, const physics::Ground<Number>& ground,
                                    Number push, Number pressed, Vector& velocity) {
  if constexpr (friction) {
    Number at_rest = 0;
    if constexpr (static_friction) at_rest = constants.static_coefficient;
    velocity = physics::after_friction(ground, velocity, push, pressed, constants.friction_coefficient, at_rest);
  }
}

/// Reduces a velocity by the friction of an elastic floor, which acts for `part` of the step (1). On rough ground,
/// m.normal_force is the vertical part of the normal force.
__device__ __forceinline__ void apply_friction(const StepConstants<Number>& constants, Number part, const Moving& m,
                                               Vector& velocity) {
  if constexpr (elastic_floor && friction) {
    // most masses do not touch the floor, and keep their velocity
    if (!(m.normal_force > 0)) return;
    if constexpr (rough) {
      const auto ground = ground_under(constants, m.position);
      const Number up = constants.dt * part * m.normal_force * m.inverse_mass;
      const Number push = up * physics::square_root(physics::normal_squared(ground));
      rub(constants, ground, push, push, velocity);
      return;
    }
    Number kept = physics::friction_factor(velocity.x, velocity.y,
                                           constants.friction_dt * part * m.normal_force * m.inverse_mass);
    if constexpr (static_friction) {
      const Number held = constants.static_coefficient * (constants.dt * part) * m.normal_force * m.inverse_mass;
      kept = physics::kept_unless_held(velocity.x, velocity.y, held, kept);
    }
    velocity.x *= kept;
    velocity.y *= kept;
  }
}

/// The ground under a mass; level ground is at height 0.
__device__ __forceinline__ auto ground_of(const StepConstants<Number>& constants, const Vector& position) {
  physics::Ground<Number> ground{0, 0, 0};
  if constexpr (rough) ground = ground_under(constants, position);
  return ground;
}

/// Notes how fast a mass rises at the beginning of a step, when its velocity is `before`.
__device__ __forceinline__ void note_arrival(const StepConstants<Number>& constants, const Vector& before, Moving& m) {
  if constexpr (rigid_floor) m.arrival = normal_velocity(constants, m.position, before);
}

/// The component along the ground's unit normal (m/s) of a velocity whose rise is `rise` (m/s).
__device__ __forceinline__ Number along_unit_normal(const physics::Ground<Number>& ground, Number rise) {
  return rise / physics::square_root(physics::normal_squared(ground));
}

/// Adds `lift` (m/s) to the rise of a mass with the given velocity. Returns what this adds along the unit normal, m/s.
__device__ __forceinline__ Number push_off(const physics::Ground<Number>& ground, Number lift, Vector& velocity) {
  velocity = physics::add_along_normal(ground, velocity, lift / physics::normal_squared(ground));
  return along_unit_normal(ground, lift);
}

/// Lets a rigid floor and its friction act on the velocity that all other forces have given a mass in a step.
__device__ __forceinline__ void land(const StepConstants<Number>& constants, Moving& m) {
  if constexpr (rigid_floor) {
    const auto ground = ground_of(constants, m.position);
    const Number rise = physics::along_normal(ground, m.velocity), height = m.position.z - ground.height;
    // most masses stay far enough above the ground; a test with some reserve saves their divisions
    if (height > 0 && -rise * constants.dt < Number(0.999) * height) return;
    // a mass at rest is at height 0, which takes a GPU longest as a dividend
    const Number lowest = height != 0 ? physics::lowest_rise(height, constants.dt) : 0;
    if (lowest > rise && m.inverse_mass > 0) {
      const Number pressed = physics::press(m.arrival, rise);
      const Number after =
          physics::rise_after_contact(lowest, physics::bounce(constants.restitution, m.arrival, pressed));
      m.push = push_off(ground, after - rise, m.velocity);
      rub(constants, ground, m.push, along_unit_normal(ground, pressed), m.velocity);
    }
  }
}

/// x <- x + time v
__device__ __forceinline__ void advance_position(Number time, Moving& m) {
  m.position.x = physics::advanced_position(m.position.x, m.velocity.x, time);
  m.position.y = physics::advanced_position(m.position.y, m.velocity.y, time);
  m.position.z = physics::advanced_position(m.position.z, m.velocity.z, time);
}

}  // namespace evodevo::cuda
