// velocity-verlet; kernels/cpu/methods/velocity_verlet.cpp describes it.
#pragma once

#include "cuda/device/mass_step.cuh"

namespace evodevo::cuda {

/// Each pass ends one step and begins the next, because both use the same forces, which then need not be stored. The
/// first pass after a check only begins a step, and the last pass before a check only ends one.
struct Method : OnePass {
  /// Moving::push of the step that a pass begins, for the pass that ends it; used with a rigid floor.
  struct Kept {
    Number push;
  };

  static __device__ __forceinline__ bool is_recorded(unsigned index) { return index > 0; }
  static __device__ __forceinline__ bool ends_motion(Pass pass) { return !pass.last; }

  static __device__ __forceinline__ void move(const StepConstants<Number>& constants, Pass pass, Kept& kept,
                                              Moving& m) {
    add_gravity(constants, m);
    add_floor(constants, m);
    if (pass.index > 0) {
      kick(constants, m);
      if constexpr (rigid_floor) stay_landed(constants, kept.push, m);
      slow_down(constants, m);
    }
    if (pass.last) return;
    slow_down(constants, m);
    note_arrival(constants, sum(m.velocity, -(constants.dt / 2 * m.inverse_mass), m.force), m);
    kick(constants, m);
    land(constants, m);
    if constexpr (rigid_floor) kept.push = m.push;
    advance_position(constants.dt, m);
  }

  /// The velocity that the present forces, a rigid floor, and then drag and damping predict for the end of the step.
  /// The last pass predicts none: the pass that begins the next step computes the same forces again.
  static __device__ __forceinline__ Vector dashpot_velocity(const StepConstants<Number>& constants, Pass pass, Moving m,
                                                            Vector before) {
    if (pass.last) return before;
    advance_velocity(constants.dt / 2, m);
    if constexpr (rigid_floor) stay_landed(constants, m.push, m);
    slow_down(constants, m);
    return m.velocity;
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
    apply_friction(constants, Number(0.5), m, m.velocity);
  }

  /// Stops the descent of a mass that a rigid floor has pushed before the drift, after half a step of its forces.
  static __device__ __forceinline__ void stay_landed(const StepConstants<Number>& constants, Number push, Moving& m) {
    const auto ground = ground_of(constants, m.position);
    const Number rise = physics::along_normal(ground, m.velocity);
    if (!(push > 0 && rise < 0)) return;
    const Number by = constants.dt / 2 * m.inverse_mass;
    const Number pressed = physics::press(Number(0), by * physics::along_normal(ground, m.force));
    rub(constants, ground, push_off(ground, -rise, m.velocity), along_unit_normal(ground, pressed), m.velocity);
  }
};

}  // namespace evodevo::cuda
