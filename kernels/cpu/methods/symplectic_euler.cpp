// symplectic-euler: semi-implicit Euler with the true terminal velocity. Compiled once for each instruction set.
#include "cpu/instruction_sets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cpu/methods/symplectic_euler.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

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

template cpu::Integrator<float> integrator<SymplecticEuler, float>();
template cpu::Integrator<double> integrator<SymplecticEuler, double>();

}  // namespace evodevo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
