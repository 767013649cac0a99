// What the time-stepping methods are written with; included once per instruction set.
#if defined(EVODEVO_CPU_STEPPER_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef EVODEVO_CPU_STEPPER_INL_HPP
#undef EVODEVO_CPU_STEPPER_INL_HPP
#else
#define EVODEVO_CPU_STEPPER_INL_HPP
#endif

#include "cpu/masses-inl.hpp"
#include "cpu/springs-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace evodevo::HWY_NAMESPACE {

/// Sets the motion's forces to those of the springs, whose relative lengths are in row `row` of the tables.
template <class T>
using SpringPass = void (*)(const cpu::Motion<T>&, const cpu::Actuation<T>&, std::size_t row);

template <class Table, class Sums, class T>
void set_spring_forces(const cpu::Motion<T>& motion, const cpu::Actuation<T>& actuation, std::size_t row) {
  const Sums sums(motion);
  const T* relative_length = actuation.relative_length + row * actuation.padded;
  const Table lengths(relative_length);
  const Table rates(sums.power ? actuation.relative_rate + row * actuation.padded : relative_length);
  for (std::size_t group = 0; group < motion.groups; ++group) set_spring_forces(motion, sums, group, lengths, rates);
}

template <class Table, class T>
SpringPass<T> spring_pass_with(cpu::Sums sums) {
  if (sums.peak || sums.tension) return set_spring_forces<Table, AnySums, T>;
  if (sums.force && sums.power) return set_spring_forces<Table, UsualSums<true, true>, T>;
  if (sums.force) return set_spring_forces<Table, UsualSums<true, false>, T>;
  if (sums.power) return set_spring_forces<Table, UsualSums<false, true>, T>;
  return set_spring_forces<Table, UsualSums<false, false>, T>;
}

/// The pass that adds to `sums`.
template <class T>
SpringPass<T> spring_pass(const cpu::Actuation<T>& actuation, cpu::Sums sums) {
  if constexpr (register_table_size<T>() > 0)
    if (actuation.materials <= register_table_size<T>()) return spring_pass_with<TableInRegisters<T>, T>(sums);
  return spring_pass_with<TableInMemory<T>, T>(sums);
}

/// A body, its constants and the passes over its springs.
template <class T>
struct Stepper {
  const cpu::Motion<T>& motion;
  const cpu::StepConstants<T>& constants;
  const cpu::Actuation<T>& actuation;
  cpu::Sums sums;
  std::size_t masses;               ///< padded to whole groups
  SpringPass<T> springs;            ///< adds to no sum
  SpringPass<T> recording_springs;  ///< adds to the sums that are on

  /// Whether any sum is on.
  bool is_recording() const { return sums.force || sums.power || sums.peak || sums.tension; }

  /// Array `index` of the method's own.
  T* scratch(std::size_t index) const { return motion.mass_scratch + index * masses; }
};

/// What a method may leave as it is. It adds `step(stepper, row)`: one step, at whose beginning the relative lengths
/// are those in row `row` of the tables.
struct StepMethod {
  static constexpr std::size_t rows_per_step = 1, mass_arrays = 0, slot_arrays = 0;
  static constexpr bool coloured = false;
  /// Called before the first of some steps.
  template <class T>
  static void begin(const Stepper<T>&) {}
};

template <class M, class T>
void advance(const cpu::Motion<T>& motion, const cpu::StepConstants<T>& constants, const cpu::Actuation<T>& actuation,
             std::size_t steps, cpu::Sums sums) {
  const Stepper<T> stepper{motion,
                           constants,
                           actuation,
                           sums,
                           motion.groups * hn::Lanes(hn::ScalableTag<T>()),
                           spring_pass(actuation, {}),
                           spring_pass(actuation, sums)};
  M::begin(stepper);
  for (std::size_t step = 0; step < steps; ++step) M::step(stepper, step * M::rows_per_step);
}

template <class M, class T>
constexpr cpu::Integrator<T> integrator() {
  return {M::rows_per_step, M::mass_arrays, M::slot_arrays, M::coloured, advance<M, T>};
}

}  // namespace evodevo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
