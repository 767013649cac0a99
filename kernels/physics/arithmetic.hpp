// The arithmetic operations that physics.hpp uses, for plain numbers (float, double). vectors-inl.hpp has the same
// operations for SIMD vectors.
#pragma once

#include <cmath>
#include <cstdint>

#if defined(__CUDACC__)
#define EVODEVO_HD __host__ __device__ __forceinline__
#elif defined(__GNUC__)
#define EVODEVO_HD inline __attribute__((always_inline))
#else
#define EVODEVO_HD inline
#endif

namespace evodevo::physics {

template <class T>
EVODEVO_HD T constant(double value) {
  return static_cast<T>(value);
}

/// A squared distance (m^2) so small that it counts as zero. It is added to every squared distance, so that dividing by
/// a distance never gives infinity or NaN.
template <class T>
EVODEVO_HD T vanishing_square() {
  return sizeof(T) == sizeof(float) ? static_cast<T>(1e-30) : static_cast<T>(1e-48);
}

/// a b + c, rounded once (fused multiply-add).
template <class T>
EVODEVO_HD T multiply_add(T a, T b, T c) {
  return std::fma(a, b, c);
}

/// c - a b, rounded once.
template <class T>
EVODEVO_HD T negative_multiply_add(T a, T b, T c) {
  return std::fma(-a, b, c);
}

template <class T>
EVODEVO_HD T maximum(T a, T b) {
  return a > b ? a : b;
}

template <class T>
EVODEVO_HD T square_root(T a) {
  return std::sqrt(a);
}

/// 1/sqrt(a). On a GPU this is the hardware's approximation, which in float32 is accurate to 2 units in the last place.
template <class T>
EVODEVO_HD T inverse_square_root(T a) {
#ifdef __CUDA_ARCH__
  return rsqrt(a);
#else
  return T(1) / std::sqrt(a);
#endif
}

/// value where a > threshold, 0 elsewhere.
template <class T>
EVODEVO_HD T zero_unless_greater(T a, T threshold, T value) {
  return a > threshold ? value : T(0);
}

/// a/b where a > 0, 0 elsewhere; b > 0. A GPU divides only where a thread of a warp needs it, because a division of 0
/// takes its longest.
template <class T>
EVODEVO_HD T quotient_if_positive(T a, T b) {
  return a > 0 ? a / b : T(0);
}

/// `above` where a > threshold, `otherwise` elsewhere.
template <class T>
EVODEVO_HD T choose(T a, T threshold, T above, T otherwise) {
  return a > threshold ? above : otherwise;
}

/// The largest whole number that is not above a.
template <class T>
EVODEVO_HD T round_down(T a) {
  return std::floor(a);
}

/// A 32-bit hash: every bit of `n` influences every bit of the result (Wellons, Prospecting for hash functions, 2018).
EVODEVO_HD std::uint32_t mix_bits(std::uint32_t n) {
  n = (n ^ n >> 16) * 0x7feb352du;
  n = (n ^ n >> 15) * 0x846ca68bu;
  return n ^ n >> 16;
}

/// A pseudo-random number in [-1, 1) that depends only on the whole numbers i and j and the seed. It has 24 random
/// bits, so that float and double represent the same number.
template <class T>
EVODEVO_HD T random_of(T i, T j, std::uint32_t seed) {
  const std::uint32_t row = mix_bits(seed + static_cast<std::uint32_t>(static_cast<std::int32_t>(j)));
  const std::uint32_t bits = mix_bits(row + static_cast<std::uint32_t>(static_cast<std::int32_t>(i)));
  return static_cast<T>(bits >> 8) * static_cast<T>(0x1p-23) - T(1);
}

}  // namespace evodevo::physics
