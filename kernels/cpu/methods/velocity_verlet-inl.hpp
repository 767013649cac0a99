// velocity-verlet. Included once per instruction set.
#if defined(EVODEVO_CPU_METHODS_VELOCITY_VERLET_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef EVODEVO_CPU_METHODS_VELOCITY_VERLET_INL_HPP
#undef EVODEVO_CPU_METHODS_VELOCITY_VERLET_INL_HPP
#else
#define EVODEVO_CPU_METHODS_VELOCITY_VERLET_INL_HPP
#endif

#include "cpu/stepper-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace evodevo::HWY_NAMESPACE {

/// A step: half a step of damping and drag; kick (half a step of forces and friction); drift (x <- x + dt v); forces at
/// the new positions; kick; half a step of damping and drag. The sequence is symmetric, so the method has second order.
/// The forces at the end of a step are used again at the beginning of the next step.
struct VelocityVerlet : StepMethod {
  template <class T>
  static void begin(const Stepper<T>& s) {
    set_forces(s, s.springs, 0);
  }

  template <class T>
  static void step(const Stepper<T>& s, std::size_t row) {
    slow_down(s);
    kick(s);
    advance_positions(s.motion, s.constants.step.dt, s.masses);
    set_forces(s, s.recording_springs, row + 1);
    kick(s);
    slow_down(s);
  }

 private:
  template <class T>
  static void set_forces(const Stepper<T>& s, SpringPass<T> springs, std::size_t row) {
    springs(s.motion, s.actuation, row);
    if (s.constants.gravity) add_gravity(s.motion, s.constants, s.masses);
    if (s.constants.floor) add_floor(s.motion, s.constants, s.masses);
  }

  /// Half a step of damping and drag, solved exactly.
  template <class T>
  static void slow_down(const Stepper<T>& s) {
    if (s.constants.drag) apply_drag<false>(s.motion, s.constants, s.constants.half_step.damped_dt, s.masses);
    if (s.constants.damping) damp(s.motion, s.constants.half_step.decay, s.masses);
  }

  /// Half a step of the forces and of friction under their normal forces.
  template <class T>
  static void kick(const Stepper<T>& s) {
    const T time = s.constants.half_step.dt;
    advance_velocities(s.motion, time, s.masses);
    if (s.constants.friction) apply_friction(s.motion, s.constants, time, s.motion.vx, s.motion.vy, s.masses);
  }
};

}  // namespace evodevo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
