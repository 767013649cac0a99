// The arithmetic operations that physics.hpp uses, for SIMD vectors: the counterpart of arithmetic.hpp. This file is
// included once for each instruction set.
#if defined(EVODEVO_PHYSICS_VECTORS_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef EVODEVO_PHYSICS_VECTORS_INL_HPP
#undef EVODEVO_PHYSICS_VECTORS_INL_HPP
#else
#define EVODEVO_PHYSICS_VECTORS_INL_HPP
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

/// a/b where a > 0, 0 elsewhere; b > 0.
template <class V>
HWY_INLINE V quotient_if_positive(V a, V b) {
  return maximum(a, constant<V>(0)) / b;
}

/// value where a > threshold, 0 elsewhere.
template <class V>
HWY_INLINE V zero_unless_greater(V a, V threshold, V value) {
  return hn::IfThenElseZero(hn::Gt(a, threshold), value);
}

/// `above` where a > threshold, `otherwise` elsewhere.
template <class V>
HWY_INLINE V choose(V a, V threshold, V above, V otherwise) {
  return hn::IfThenElse(hn::Gt(a, threshold), above, otherwise);
}

template <class V>
HWY_INLINE V round_down(V a) {
  return hn::Floor(a);
}

template <class U>
HWY_INLINE U mix_bits(U n) {
  const hn::DFromV<U> d;
  n = hn::Xor(n, hn::ShiftRight<16>(n)) * hn::Set(d, 0x7feb352du);
  n = hn::Xor(n, hn::ShiftRight<15>(n)) * hn::Set(d, 0x846ca68bu);
  return hn::Xor(n, hn::ShiftRight<16>(n));
}

/// Converts lanes that hold whole numbers to 32-bit integers, and back.
template <class V>
HWY_INLINE auto as_bits(V whole) {
  const hn::Rebind<std::int32_t, hn::DFromV<V>> d;
  const hn::Rebind<std::uint32_t, hn::DFromV<V>> bits;
  if constexpr (sizeof(hn::TFromV<V>) == sizeof(float))
    return hn::BitCast(bits, hn::ConvertTo(d, whole));
  else
    return hn::BitCast(bits, hn::DemoteTo(d, whole));
}
template <class V, class U>
HWY_INLINE V as_number(U bits) {
  const hn::DFromV<V> d;
  const auto whole = hn::BitCast(hn::Rebind<std::int32_t, hn::DFromV<V>>(), bits);
  if constexpr (sizeof(hn::TFromV<V>) == sizeof(float))
    return hn::ConvertTo(d, whole);
  else
    return hn::PromoteTo(d, whole);
}

template <class V>
HWY_INLINE V random_of(V i, V j, std::uint32_t seed) {
  const auto row = mix_bits(as_bits(j) + hn::Set(hn::Rebind<std::uint32_t, hn::DFromV<V>>(), seed));
  const auto bits = mix_bits(row + as_bits(i));
  return multiply_add(as_number<V>(hn::ShiftRight<8>(bits)), constant<V>(0x1p-23), constant<V>(-1));
}

}  // namespace evodevo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
