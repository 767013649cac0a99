// The kernels of the CPU, compiled once for each instruction set; the best instruction set is chosen at run time.
#include "cpu/instruction_sets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cpu/step.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "cpu/actuation-inl.hpp"
#include "cpu/energies-inl.hpp"
#include "cpu/step.hpp"

HWY_BEFORE_NAMESPACE();
namespace evodevo::HWY_NAMESPACE {

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

// the methods, each in a file of cpu/methods/
struct PaperEuler;
struct SymplecticEuler;
struct VelocityVerlet;
struct Rk4;
struct Implicit;
struct Xpbd;
template <class M, class T>
cpu::Integrator<T> integrator();

template <class T>
const cpu::Kernels<T>* kernels_of() {
  static constexpr std::size_t lanes = hn::MaxLanes(hn::ScalableTag<T>());
  static const cpu::Kernels<T> kernels{
      .instruction_set = instruction_set(),
      .lanes = lanes,
      .table_size = 16,
      .actuate = actuate<T>,
      .integrator = {integrator<PaperEuler, T>(), integrator<SymplecticEuler, T>(), integrator<VelocityVerlet, T>(),
                     integrator<Rk4, T>(), integrator<Implicit, T>(), integrator<Xpbd, T>()},
      .energies = energies<T>};
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
