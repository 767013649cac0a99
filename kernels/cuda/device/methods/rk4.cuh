// rk4; kernels/cpu/methods/rk4-inl.hpp describes it.
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
      go_to_stage(stage == 2 ? constants.dt : constants.dt / 2, kept, m);
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
  /// velocity and acceleration of this stage.
  static __device__ __forceinline__ void go_to_stage(Number time, const Kept& kept, Moving& m) {
    m.position = sum(kept.position, time, m.velocity);
    m.velocity = sum(kept.velocity, time * m.inverse_mass, m.force);
  }

  /// Ends the step. Friction takes half as much from the mean velocity as from the velocity at the end.
  static __device__ __forceinline__ void finish(const StepConstants<Number>& constants, Kept& kept, Moving& m) {
    m.velocity = sum(kept.velocity, constants.dt, kept.mean_acceleration);
    m.normal_force = kept.mean_normal_force;
    apply_friction(constants.friction_dt, m, m.velocity);
    apply_friction(constants.friction_dt / 2, m, kept.mean_velocity);
    m.position = sum(kept.position, constants.dt, kept.mean_velocity);
  }
};

}  // namespace evodevo::cuda
