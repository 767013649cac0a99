// The arithmetic that physics.hpp is written in, for plain numbers.
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

/// A square (m^2) beyond which no distance is told from zero.
template <class T>
EVODEVO_HD T vanishing_square() {
  return sizeof(T) == sizeof(float) ? static_cast<T>(1e-30) : static_cast<T>(1e-48);
}

/// a b + c, rounded once.
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

/// 1/sqrt(a); on a GPU its approximation, in float32 good to 2 units in the last place.
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

/// The largest whole number that is not above a.
template <class T>
EVODEVO_HD T whole_below(T a) {
  return std::floor(a);
}

/// Mixes the bits of a number (Wellons, Prospecting for hash functions, 2018).
EVODEVO_HD std::uint32_t mixed(std::uint32_t n) {
  n = (n ^ n >> 16) * 0x7feb352du;
  n = (n ^ n >> 15) * 0x846ca68bu;
  return n ^ n >> 16;
}

/// A random number in [-1, 1) for two whole numbers and a seed, of 24 bits, so the same in any arithmetic.
template <class T>
EVODEVO_HD T random_of(T i, T j, std::uint32_t seed) {
  const std::uint32_t row = mixed(seed + static_cast<std::uint32_t>(static_cast<std::int32_t>(j)));
  const std::uint32_t bits = mixed(row + static_cast<std::uint32_t>(static_cast<std::int32_t>(i)));
  return static_cast<T>(bits >> 8) * static_cast<T>(0x1p-23) - T(1);
}

}  // namespace evodevo::physics
