// What both kernels share: the features that they are compiled for, the materials in time and the step of one mass.
#pragma once

#include "cuda/formats.hpp"
#include "physics.hpp"

namespace evodevo::cuda {

using Number = EVODEVO_NUMBER;
constexpr bool actuation = EVODEVO_ACTUATION;
constexpr bool gravity = EVODEVO_GRAVITY;
constexpr bool floor_on = EVODEVO_FLOOR;
constexpr bool friction = EVODEVO_FRICTION;
constexpr bool damping = EVODEVO_DAMPING;
constexpr bool drag = EVODEVO_DRAG;
constexpr bool stress = EVODEVO_STRESS;
constexpr bool work = EVODEVO_WORK;

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

/// All other forces, and the step of one mass.
__device__ __forceinline__ void move(const World<Number>& world, Place& place, Place& v, Place force, Number mass,
                                     Number inverse_mass) {
  if constexpr (gravity) force.z += physics::weight(mass, world.acceleration);
  Number push = 0;
  if constexpr (floor_on) {
    push = physics::floor_force(world.floor_stiffness, place.z);
    force.z += push;
  }
  if constexpr (drag) {
    const Number factor = physics::drag_factor(world.drag_coefficient, v);
    force.x = physics::multiply_add(factor, v.x, force.x);
    force.y = physics::multiply_add(factor, v.y, force.y);
    force.z = physics::multiply_add(factor, v.z, force.z);
  }
  const Number dt_over_mass = world.dt * inverse_mass;
  v.x = physics::advanced_velocity(v.x, force.x, dt_over_mass);
  v.y = physics::advanced_velocity(v.y, force.y, dt_over_mass);
  v.z = physics::advanced_velocity(v.z, force.z, dt_over_mass);
  if constexpr (damping) {
    v.x *= world.decay;
    v.y *= world.decay;
    v.z *= world.decay;
  }
  if constexpr (friction) {
    // of a mass off the floor it takes nothing, and most are
    if (push > 0) {
      const Number kept = physics::friction_factor(v.x, v.y, world.friction_dt * push * inverse_mass);
      v.x *= kept;
      v.y *= kept;
    }
  }
  place.x = physics::moved(place.x, v.x, world.dt);
  place.y = physics::moved(place.y, v.y, world.dt);
  place.z = physics::moved(place.z, v.z, world.dt);
}

}  // namespace evodevo::cuda
