// velocity-verlet. Compiled once for each instruction set.
#include "cpu/instruction_sets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cpu/methods/velocity_verlet.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "cpu/stepper-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace evodevo::HWY_NAMESPACE {

/// A step: half a step of damping and drag; kick (half a step of forces and friction); drift (x <- x + dt v); forces at
/// the new positions; kick; half a step of damping and drag. The sequence is symmetric, so the method has second order.
/// The forces at the end of a step are used again at the beginning of the next step. Dashpots act at the velocities
/// that the forces at the beginning of the step predict for its end, which is exact enough for the second order. These
/// velocities are therefore part of the motion, and are kept where a run is interrupted (Course::dashpot_velocity).
///
/// A rigid floor acts on the velocity of the drift, which the last drift and the forces since then determine. Masses
/// that it has pushed before a drift do not enter it after the second kick either, so that a mass at rest has no
/// velocity. The same holds for the velocities at which dashpots act, so that they see a mass at rest as one at rest.
struct VelocityVerlet : StepMethod {
  template <class T>
  static void begin(const Stepper<T>& s) {
    set_forces(s, s.springs, 0);
  }

  template <class T>
  static void step(const Stepper<T>& s, std::size_t row) {
    slow_down(s);
    if (s.constants.rigid) note_arrivals(s.motion, s.constants, s.constants.half_step.dt, s.masses);
    kick(s);
    if (s.constants.rigid) land(s.motion, s.constants, s.masses);
    advance_positions(s.motion, s.constants.step.dt, s.masses);
    if (s.motion.damping != nullptr) interleave_predicted_velocities(s.motion, s.constants, s.masses);
    set_forces(s, s.recording_springs, row + 1);
    kick(s);
    if (s.constants.rigid) end_landed(s);
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
    if (s.constants.friction && !s.constants.rigid)
      apply_friction(s.motion, s.constants, time, velocities(s.motion), s.masses);
  }

  /// Stops the descent of masses that a rigid floor has pushed before the drift.
  template <class T>
  static void end_landed(const Stepper<T>& s) {
    const hn::ScalableTag<T> d;
    using V = hn::Vec<decltype(d)>;
    const cpu::Motion<T>& m = s.motion;
    for (std::size_t i = 0; i < s.masses; i += hn::Lanes(d)) {
      Triple<V> v{hn::Load(d, m.vx + i), hn::Load(d, m.vy + i), hn::Load(d, m.vz + i)};
      stay_landed(m, s.constants, i, v);
      hn::Store(v.x, d, m.vx + i);
      hn::Store(v.y, d, m.vy + i);
      hn::Store(v.z, d, m.vz + i);
    }
  }
};

template cpu::Integrator<float> integrator<VelocityVerlet, float>();
template cpu::Integrator<double> integrator<VelocityVerlet, double>();

}  // namespace evodevo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
