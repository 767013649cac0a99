// Forces as integers, so that a sum of forces does not depend on the order of its terms.
//
// A force in units of ForceRange::resolution is added to a magic number that is so large that its last bit is worth one
// unit. The bits of the sum, read as an integer, are then the magic number's bits plus the force in units. One fused
// multiply-add computes the force, rounds it and converts it. The opposite force gives exactly the opposite integer, so
// that the forces inside a body cancel exactly.
#pragma once

#include <cstdint>

namespace evodevo::cuda {

template <class T>
struct FixedPoint;

template <>
struct FixedPoint<float> {
  using Integer = std::uint32_t;  ///< unsigned, because sums may overflow before the magic numbers cancel
  using Signed = std::int32_t;
  static constexpr float magic = 12582912.0f;          ///< 1.5 * 2^23
  static constexpr Integer magic_bits = 0x4b400000u;   ///< its bits
  static constexpr double largest_term = 4194304.0;    ///< 2^22 units
  static constexpr double largest_sum = 2147483647.0;  ///< units
};

template <>
struct FixedPoint<double> {
  using Integer = unsigned long long;  ///< the 64-bit type of CUDA's atomicAdd
  using Signed = long long;
  static constexpr double magic = 6755399441055744.0;           ///< 1.5 * 2^52
  static constexpr Integer magic_bits = 0x4338000000000000ull;  ///< its bits
  static constexpr double largest_term = 2251799813685248.0;    ///< 2^51 units
  static constexpr double largest_sum = 9.2e18;                 ///< units
};

}  // namespace evodevo::cuda
