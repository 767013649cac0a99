// rk4; kernels/cpu/methods/rk4.cpp describes it.
#pragma once

#include "cuda/device/mass_step.cuh"

namespace evodevo::cuda {

/// Each pass is a stage; four make a step.
struct Method : OnePass {
  struct Kept {
    Vector position, velocity;  ///< at the beginning of the step
    Vector mean_velocity, mean_acceleration;
    Number mean_normal_force;  ///< of the floor, N
  };

  /// There are two rows per step: stage 0 reads the row of the beginning, stages 1 and 2 that of the middle, and stage
  /// 3 that of the end, which is the beginning of the next step.
  static __device__ __forceinline__ unsigned row(unsigned index) { return index / 4 * 2 + (index % 4 + 1) / 2; }
  static __device__ __forceinline__ bool is_recorded(unsigned index) { return index % 4 == 0; }
  static __device__ __forceinline__ bool ends_motion(Pass pass) { return pass.index % 4 == 3; }

  static __device__ __forceinline__ void move(const StepConstants<Number>& constants, Pass pass, Kept& kept,
                                              Moving& m) {
    const unsigned stage = pass.index % 4;
    if (stage == 0) kept = {m.position, m.velocity, {0, 0, 0}, {0, 0, 0}, 0};
    add_gravity(constants, m);
    add_floor(constants, m);
    add_drag(constants, m);
    add_damping(constants, m);
    add_to_means(Number(1) / (stage == 0 || stage == 3 ? 6 : 3), m, kept);
    if (stage < 3)
      go_to_stage(constants, stage == 2 ? constants.dt : constants.dt / 2, Number(1) / (stage == 2 ? 6 : 3), kept, m);
    else
      finish(constants, kept, m);
  }

 private:
  static __device__ __forceinline__ void add_to_means(Number share, const Moving& m, Kept& kept) {
    kept.mean_velocity = sum(kept.mean_velocity, share, m.velocity);
    kept.mean_acceleration = sum(kept.mean_acceleration, share, scaled(m.force, m.inverse_mass));
    if constexpr (friction)
      kept.mean_normal_force = physics::multiply_add(share, m.normal_force, kept.mean_normal_force);
  }

  /// Sets position and velocity for the next stage: those at the beginning of the step, advanced by `time` (s) with the
  /// velocity and acceleration of this stage. `share` is the weight of the next stage in the means.
  static __device__ __forceinline__ void go_to_stage(const StepConstants<Number>& constants, Number time, Number share,
                                                     Kept& kept, Moving& m) {
    if constexpr (rigid_floor) return go_to_held_stage(constants, time, share, kept, m);
    m.position = sum(kept.position, time, m.velocity);
    m.velocity = sum(kept.velocity, time * m.inverse_mass, m.force);
  }

  /// The same on a rigid floor, which holds the mass in the stage, too.
  static __device__ __forceinline__ void go_to_held_stage(const StepConstants<Number>& constants, Number time,
                                                          Number share, Kept& kept, Moving& m) {
    const auto ground = ground_of(constants, kept.position);
    const Number clearance = kept.position.z - ground.height;
    hold(ground, physics::lowest_rise(clearance, time), m, m.velocity);
    const Number there = physics::advanced_position(clearance, physics::along_normal(ground, m.velocity), time);
    m.position = sum(kept.position, time, m.velocity);
    m.velocity = sum(kept.velocity, time * m.inverse_mass, m.force);
    if (!(there < Number(1e-3) * constants.dt)) return;
    const Vector free = m.velocity;
    const Number pressed =
        physics::press(physics::along_normal(ground, kept.velocity), physics::along_normal(ground, free));
    const Number push = hold(ground, physics::lowest_rise(there, constants.dt / 2), m, m.velocity);
    rub(constants, ground, push, along_unit_normal(ground, pressed), m.velocity);
    kept.mean_velocity = sum(kept.mean_velocity, share, difference(free, m.velocity));
  }

  /// Raises a velocity that rises less than `lowest` (m/s) to it. Returns what this adds along the unit normal, m/s.
  static __device__ __forceinline__ Number hold(const physics::Ground<Number>& ground, Number lowest, const Moving& m,
                                                Vector& velocity) {
    const Number rise = physics::along_normal(ground, velocity);
    return lowest > rise && m.inverse_mass > 0 ? push_off(ground, lowest - rise, velocity) : Number(0);
  }

  /// Ends the step. Friction takes half as much from the mean velocity as from the velocity at the end.
  static __device__ __forceinline__ void finish(const StepConstants<Number>& constants, Kept& kept, Moving& m) {
    m.velocity = sum(kept.velocity, constants.dt, kept.mean_acceleration);
    m.normal_force = kept.mean_normal_force;
    if constexpr (rigid_floor) land_at_end(constants, kept, m);
    apply_friction(constants, 1, m, m.velocity);
    apply_friction(constants, Number(0.5), m, kept.mean_velocity);
    m.position = sum(kept.position, constants.dt, kept.mean_velocity);
  }

  /// Lets a rigid floor act on the mean velocity, which brings the mass to its position at the end of the step, and
  /// then on the velocity there.
  static __device__ __forceinline__ void land_at_end(const StepConstants<Number>& constants, Kept& kept, Moving& m) {
    const auto ground = ground_of(constants, kept.position);
    const Number rise = physics::along_normal(ground, kept.mean_velocity);
    const Number lowest = physics::lowest_rise(kept.position.z - ground.height, constants.dt);
    if (!(lowest > rise && m.inverse_mass > 0)) return;
    const Number arrival = physics::along_normal(ground, kept.velocity);
    const Number pressed = physics::press(arrival, physics::along_normal(ground, m.velocity));
    const Number speed = physics::bounce(constants.restitution, arrival, pressed);
    const Number departure = physics::maximum(speed, lowest), along = along_unit_normal(ground, pressed);
    const Number passage = speed > 0 ? physics::maximum((departure + arrival) / 2, lowest) : lowest;
    push_off(ground, passage - rise, kept.mean_velocity);
    const Number lift = physics::maximum(departure - physics::along_normal(ground, m.velocity), Number(0));
    rub(constants, ground, along_unit_normal(ground, lift) / 2, along / 2, kept.mean_velocity);
    const auto there = ground_of(constants, sum(kept.position, constants.dt, kept.mean_velocity));
    const Number missing = physics::maximum(departure - physics::along_normal(there, m.velocity), Number(0));
    m.push = push_off(there, missing, m.velocity);
    rub(constants, there, m.push, along, m.velocity);
  }
};

}  // namespace evodevo::cuda
