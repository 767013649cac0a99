// Velocity Verlet: kernels/cpu/methods/velocity_verlet-inl.hpp.
#pragma once

#include "cuda/device/mass_step.cuh"

namespace evodevo::cuda {

/// A pass ends one step and begins the next, so that its forces, which serve both, need not be kept. Before some steps
/// there is one that only begins; the last only ends.
struct Method : OnePass {
  static __device__ __forceinline__ bool is_noted(unsigned index) { return index > 0; }

  static __device__ __forceinline__ void move(const World<Number>& world, Pass pass, Kept&, Moving& m) {
    add_gravity(world, m);
    add_floor(world, m);
    if (pass.index > 0) {
      kick(world, m);
      slow_down(world, m);
    }
    if (pass.last) return;
    slow_down(world, m);
    kick(world, m);
    move_on(world.dt, m);
  }

 private:
  /// Half a step of damping and drag, exactly.
  static __device__ __forceinline__ void slow_down(const World<Number>& world, Moving& m) {
    yield_to_drag<false>(world, world.half_push, m);
    damp(world.half_decay, m);
  }

  /// Half a step of the forces, and of the friction that goes with them.
  static __device__ __forceinline__ void kick(const World<Number>& world, Moving& m) {
    advance_velocity(world.dt / 2, m);
    rub(world.friction_dt / 2, m, m.velocity);
  }
};

}  // namespace evodevo::cuda
