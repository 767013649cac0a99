// velocity-verlet; kernels/cpu/methods/velocity_verlet-inl.hpp describes it.
#pragma once

#include "cuda/device/mass_step.cuh"

namespace evodevo::cuda {

/// Each pass ends one step and begins the next, because both use the same forces, which then need not be stored. The
/// first pass after a check only begins a step, and the last pass before a check only ends one.
struct Method : OnePass {
  static __device__ __forceinline__ bool is_recorded(unsigned index) { return index > 0; }
  static __device__ __forceinline__ bool ends_motion(Pass pass) { return !pass.last; }

  static __device__ __forceinline__ void move(const StepConstants<Number>& constants, Pass pass, Kept&, Moving& m) {
    add_gravity(constants, m);
    add_floor(constants, m);
    if (pass.index > 0) {
      kick(constants, m);
      slow_down(constants, m);
    }
    if (pass.last) return;
    slow_down(constants, m);
    kick(constants, m);
    advance_position(constants.dt, m);
  }

 private:
  /// Half a step of damping and drag, solved exactly.
  static __device__ __forceinline__ void slow_down(const StepConstants<Number>& constants, Moving& m) {
    apply_drag<false>(constants, constants.half_damped_dt, m);
    damp(constants.half_decay, m);
  }

  /// Half a step of the forces and of friction under their normal forces.
  static __device__ __forceinline__ void kick(const StepConstants<Number>& constants, Moving& m) {
    advance_velocity(constants.dt / 2, m);
    apply_friction(constants.friction_dt / 2, m, m.velocity);
  }
};

}  // namespace evodevo::cuda
