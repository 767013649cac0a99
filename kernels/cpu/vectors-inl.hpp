// The arithmetic that physics.hpp is written in, for the vectors of one instruction set; included once for each.
#if defined(EVODEVO_CPU_VECTORS_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef EVODEVO_CPU_VECTORS_INL_HPP
#undef EVODEVO_CPU_VECTORS_INL_HPP
#else
#define EVODEVO_CPU_VECTORS_INL_HPP
#endif

#include <hwy/highway.h>

#include <cstdint>

#define EVODEVO_HD HWY_INLINE

HWY_BEFORE_NAMESPACE();
namespace evodevo::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

template <class V>
HWY_INLINE V constant(double value) {
  return hn::Set(hn::DFromV<V>(), static_cast<hn::TFromV<V>>(value));
}

template <class V>
HWY_INLINE V vanishing_square() {
  return constant<V>(sizeof(hn::TFromV<V>) == sizeof(float) ? 1e-30 : 1e-48);
}

template <class V>
HWY_INLINE V multiply_add(V a, V b, V c) {
  return hn::MulAdd(a, b, c);
}

template <class V>
HWY_INLINE V negative_multiply_add(V a, V b, V c) {
  return hn::NegMulAdd(a, b, c);
}

template <class V>
HWY_INLINE V maximum(V a, V b) {
  return hn::Max(a, b);
}

template <class V>
HWY_INLINE V square_root(V a) {
  return hn::Sqrt(a);
}

/// value where a > threshold, 0 elsewhere.
template <class V>
HWY_INLINE V zero_unless_greater(V a, V threshold, V value) {
  return hn::IfThenElseZero(hn::Gt(a, threshold), value);
}

}  // namespace evodevo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
