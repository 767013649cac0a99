// A body's steps on the CPU, compiled once for each instruction set.
#include "cpu/step.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cpu/step.cpp"
// sets between these are rare or bring nothing here
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "cpu/actuation-inl.hpp"
#include "cpu/energies-inl.hpp"
#include "cpu/masses-inl.hpp"
#include "cpu/springs-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace evodevo::HWY_NAMESPACE {

/// The time step of paper-euler: all forces from the places, velocities from the forces, places from the velocities.
template <class Table, bool tension_on, bool power_on, class T>
void advance_with(const cpu::Motion<T>& motion, const cpu::World<T>& world, const cpu::Actuation<T>& actuation,
                  std::size_t steps) {
  const std::size_t masses = motion.groups * hn::Lanes(hn::ScalableTag<T>());
  for (std::size_t step = 0; step < steps; ++step) {
    const std::size_t row = step * actuation.padded;
    const Table lengths(actuation.relative_length + row);
    const Table rates(power_on ? actuation.relative_rate + row : actuation.relative_length + row);
    for (std::size_t group = 0; group < motion.groups; ++group)
      add_spring_forces<tension_on, power_on>(motion, group, lengths, rates);
    if (world.gravity) add_gravity(motion, world, masses);
    if (world.floor) add_floor(motion, world, masses);
    if (world.drag) add_drag(motion, world, masses);
    advance_velocities(motion, world, masses);
    if (world.damping) damp(motion, world, masses);
    if (world.friction) rub(motion, world, masses);
    move(motion, world.dt, masses);
  }
}

template <class Table, class T>
void advance_recording(const cpu::Motion<T>& motion, const cpu::World<T>& world, const cpu::Actuation<T>& actuation,
                       std::size_t steps, cpu::Sums sums) {
  if (sums.tension && sums.power) return advance_with<Table, true, true>(motion, world, actuation, steps);
  if (sums.tension) return advance_with<Table, true, false>(motion, world, actuation, steps);
  if (sums.power) return advance_with<Table, false, true>(motion, world, actuation, steps);
  advance_with<Table, false, false>(motion, world, actuation, steps);
}

template <class T>
void advance(const cpu::Motion<T>& motion, const cpu::World<T>& world, const cpu::Actuation<T>& actuation,
             std::size_t steps, cpu::Sums sums) {
  if constexpr (register_table_size<T>() > 0)
    if (actuation.materials <= register_table_size<T>())
      return advance_recording<TableInRegisters<T>>(motion, world, actuation, steps, sums);
  advance_recording<TableInMemory<T>>(motion, world, actuation, steps, sums);
}

const char* instruction_set() {
  switch (HWY_TARGET) {
    case HWY_AVX3:
      return "AVX-512";
    case HWY_SCALAR:
      return "no vectors";
    default:
      return hwy::TargetName(HWY_TARGET);
  }
}

template <class T>
const cpu::Kernels<T>* kernels_of() {
  static constexpr std::size_t lanes = hn::MaxLanes(hn::ScalableTag<T>());
  static const cpu::Kernels<T> kernels{instruction_set(), lanes, 16, actuate<T>, advance<T>, energies<T>};
  return &kernels;
}

const cpu::Kernels<float>* kernels_float32() { return kernels_of<float>(); }
const cpu::Kernels<double>* kernels_float64() { return kernels_of<double>(); }

}  // namespace evodevo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace evodevo {

HWY_EXPORT(kernels_float32);
HWY_EXPORT(kernels_float64);

template <>
const cpu::Kernels<float>& cpu::kernels<float>() {
  return *HWY_DYNAMIC_DISPATCH(kernels_float32)();
}
template <>
const cpu::Kernels<double>& cpu::kernels<double>() {
  return *HWY_DYNAMIC_DISPATCH(kernels_float64)();
}

}  // namespace evodevo
#endif
