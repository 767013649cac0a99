// The common frame of all time-stepping methods on the CPU. Included once per instruction set.
//
// Each step of a method calls the following functions, in an order of its own:
//   springs(..)              positions, relative lengths ─► spring forces (and records of the springs)
//   add_gravity, add_floor.. positions, velocities ─► added to the forces
//   advance_velocities, damp, apply_drag, touch_floor   forces ─► velocities
//   advance_positions        velocities ─► positions
#if defined(EVODEVO_CPU_STEPPER_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef EVODEVO_CPU_STEPPER_INL_HPP
#undef EVODEVO_CPU_STEPPER_INL_HPP
#else
#define EVODEVO_CPU_STEPPER_INL_HPP
#endif

#include "cpu/actuation-inl.hpp"
#include "cpu/masses-inl.hpp"
#include "cpu/step.hpp"

HWY_BEFORE_NAMESPACE();
namespace evodevo::HWY_NAMESPACE {

/// A function that sets the motion's forces to the forces of springs and dashpots at the relative lengths in row `row`
/// of the tables and at the interleaved velocities.
template <class T>
using SpringPass = void (*)(const cpu::Motion<T>&, const cpu::Actuation<T>&, std::size_t row);

/// Returns the pass over the springs that adds to the given sums, with dashpots if `damped` (springs.cpp).
template <class T>
SpringPass<T> spring_pass(bool damped, const cpu::Actuation<T>& actuation, cpu::Sums sums);

/// The input of a method: a body in motion, the constants of the step and the passes over the springs.
template <class T>
struct Stepper {
  const cpu::Motion<T>& motion;
  const cpu::StepConstants<T>& constants;
  const cpu::Actuation<T>& actuation;
  cpu::Sums sums;
  std::size_t masses;               ///< padded to whole groups
  SpringPass<T> springs;            ///< pass without recording
  SpringPass<T> recording_springs;  ///< pass that also adds to the enabled sums
  SpringPass<T> undamped_springs;   ///< pass without recording and without dashpots

  /// Computes the forces of springs and dashpots at the present velocities.
  void compute(SpringPass<T> pass, std::size_t row) const {
    if (motion.damping != nullptr) interleave_velocities(motion, masses);
    pass(motion, actuation, row);
  }

  /// Whether anything is recorded.
  bool is_recording() const { return sums.force || sums.power || sums.peak || sums.tension; }

  /// Array `index` of the method's scratch memory, one number for each mass.
  T* scratch(std::size_t index) const { return motion.mass_scratch + index * masses; }
};

/// Lets the floor act on velocities that all other forces have changed in a whole step: a rigid floor with its
/// friction, or the friction of an elastic floor, whose normal forces have acted already.
template <class T>
void touch_floor(const Stepper<T>& s) {
  if (s.constants.rigid)
    land(s.motion, s.constants, s.masses);
  else if (s.constants.friction)
    apply_friction(s.motion, s.constants, s.constants.step.dt, velocities(s.motion), s.masses);
}

/// The base of a method, with defaults that the method may override. The method adds `step(stepper, row)`, which
/// computes one step; row `row` of the tables holds the relative lengths at the beginning of the step.
struct StepMethod {
  static constexpr std::size_t rows_per_step = 1, mass_arrays = 0, slot_arrays = 0;
  static constexpr bool coloured = false;
  /// Called before the first step of each call of Integrator::advance.
  template <class T>
  static void begin(const Stepper<T>&) {}
};

template <class M, class T>
void advance(const cpu::Motion<T>& motion, const cpu::StepConstants<T>& constants, const cpu::Actuation<T>& actuation,
             std::size_t steps, cpu::Sums sums) {
  const bool damped = motion.damping != nullptr;
  const Stepper<T> stepper{motion,
                           constants,
                           actuation,
                           sums,
                           motion.groups * hn::Lanes(hn::ScalableTag<T>()),
                           spring_pass(damped, actuation, {}),
                           spring_pass(damped, actuation, sums),
                           spring_pass(false, actuation, {})};
  M::begin(stepper);
  for (std::size_t step = 0; step < steps; ++step) {
    M::step(stepper, step * M::rows_per_step);
    if (motion.contact_steps != nullptr) count_contacts(motion, constants, stepper.masses);
  }
}

/// The method M. Each method's file instantiates it for both precisions.
template <class M, class T>
cpu::Integrator<T> integrator() {
  return {M::rows_per_step, M::mass_arrays, M::slot_arrays, M::coloured, advance<M, T>};
}

}  // namespace evodevo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
