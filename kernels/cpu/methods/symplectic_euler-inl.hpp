// symplectic-euler: semi-implicit Euler with the true terminal velocity. Included once per instruction set.
#if defined(EVODEVO_CPU_METHODS_SYMPLECTIC_EULER_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef EVODEVO_CPU_METHODS_SYMPLECTIC_EULER_INL_HPP
#undef EVODEVO_CPU_METHODS_SYMPLECTIC_EULER_INL_HPP
#else
#define EVODEVO_CPU_METHODS_SYMPLECTIC_EULER_INL_HPP
#endif

#include "cpu/stepper-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace evodevo::HWY_NAMESPACE {

/// A step: positions ─► forces F; v <- (decay v + damped_dt F/m)/(1 + damped_dt c |v|/m); rigid floor; friction; x <- x
/// + dt v. c is the coefficient of drag. Damping and drag are exact if no force acts. Under a constant force, at any
/// dt, the velocity tends to the one at which damping and drag balance that force.
struct SymplecticEuler : StepMethod {
  template <class T>
  static void step(const Stepper<T>& s, std::size_t row) {
    const cpu::TimeSpan<T>& time = s.constants.step;
    s.compute(s.recording_springs, row);
    if (s.constants.rigid) note_arrivals(s.motion, s.constants, T(0), s.masses);
    if (s.constants.gravity) add_gravity(s.motion, s.constants, s.masses);
    if (s.constants.floor) add_floor(s.motion, s.constants, s.masses);
    if (s.constants.drag) apply_drag<true>(s.motion, s.constants, time.damped_dt, s.masses);
    if (s.constants.damping) damp(s.motion, time.decay, s.masses);
    advance_velocities(s.motion, time.damped_dt, s.masses);
    touch_floor(s);
    advance_positions(s.motion, time.dt, s.masses);
  }
};

}  // namespace evodevo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
