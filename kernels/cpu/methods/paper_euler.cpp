// paper-euler: semi-implicit Euler, which is our interpretation of the paper's equations (section IV-C;
// kernels/README.md). Compiled once for each instruction set.
#include "cpu/instruction_sets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cpu/methods/paper_euler.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "cpu/stepper-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace evodevo::HWY_NAMESPACE {

/// A step: positions, velocities ─► forces; v <- (v + dt F/m) exp(-rate dt)/(1 + dt c |v|/m), with the coefficient of
/// drag c; rigid floor; friction; x <- x + dt v. Because damping acts after the forces, the terminal velocity of a
/// falling mass is below g/rate, by a share that grows with dt.
struct PaperEuler : StepMethod {
  template <class T>
  static void step(const Stepper<T>& s, std::size_t row) {
    s.compute(s.recording_springs, row);
    if (s.constants.rigid) note_arrivals(s.motion, s.constants, T(0), s.masses);
    if (s.constants.gravity) add_gravity(s.motion, s.constants, s.masses);
    if (s.constants.floor) add_floor(s.motion, s.constants, s.masses);
    if (s.constants.drag) apply_drag<true>(s.motion, s.constants, s.constants.step.dt, s.masses);
    advance_velocities(s.motion, s.constants.step.dt, s.masses);
    if (s.constants.damping) damp(s.motion, s.constants.step.decay, s.masses);
    touch_floor(s);
    advance_positions(s.motion, s.constants.step.dt, s.masses);
  }
};

template cpu::Integrator<float> integrator<PaperEuler, float>();
template cpu::Integrator<double> integrator<PaperEuler, double>();

}  // namespace evodevo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
