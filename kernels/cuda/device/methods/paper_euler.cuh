// paper-euler; kernels/cpu/methods/paper_euler.cpp describes it.
#pragma once

#include "cuda/device/mass_step.cuh"

namespace evodevo::cuda {

struct Method : OnePass {
  static __device__ __forceinline__ void move(const StepConstants<Number>& constants, Pass, Kept&, Moving& m) {
    note_arrival(constants, m.velocity, m);
    add_gravity(constants, m);
    add_floor(constants, m);
    apply_drag<true>(constants, constants.dt, m);
    advance_velocity(constants.dt, m);
    damp(constants.decay, m);
    land(constants, m);
    apply_friction(constants, 1, m, m.velocity);
    advance_position(constants.dt, m);
  }
};

}  // namespace evodevo::cuda
