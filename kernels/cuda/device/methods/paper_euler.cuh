// The method that the paper's equations read as: kernels/cpu/methods/paper_euler-inl.hpp.
#pragma once

#include "cuda/device/mass_step.cuh"

namespace evodevo::cuda {

struct Method : OnePass {
  static __device__ __forceinline__ void move(const World<Number>& world, Pass, Kept&, Moving& m) {
    add_gravity(world, m);
    add_floor(world, m);
    add_drag(world, m);
    advance_velocity(world.dt, m);
    damp(world.decay, m);
    rub(world.friction_dt, m, m.velocity);
    move_on(world.dt, m);
  }
};

}  // namespace evodevo::cuda
