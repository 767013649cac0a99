// Semi-implicit Euler that ends in the true terminal velocity: kernels/cpu/methods/symplectic_euler-inl.hpp.
#pragma once

#include "cuda/device/mass_step.cuh"

namespace evodevo::cuda {

struct Method : OnePass {
  static __device__ __forceinline__ void move(const World<Number>& world, Pass, Kept&, Moving& m) {
    add_gravity(world, m);
    add_floor(world, m);
    yield_to_drag<true>(world, world.push, m);
    damp(world.decay, m);
    advance_velocity(world.push, m);
    rub(world.friction_dt, m, m.velocity);
    move_on(world.dt, m);
  }
};

}  // namespace evodevo::cuda
