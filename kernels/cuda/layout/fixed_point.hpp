// Forces as integers, so that their sum does not depend on the order of its terms.
//
// A force in units of the resolution is added to a number so large that its last bit is worth one unit: the sum's bits,
// read as an integer, then count units. One fused multiply-add makes the product, its rounding and the conversion, and
// -force gives exactly the opposite count, so that the forces inside a body cancel to the last bit.
#pragma once

#include <cstdint>

namespace evodevo::cuda {

template <class T>
struct FixedPoint;

template <>
struct FixedPoint<float> {
  using Integer = std::uint32_t;  ///< unsigned, because sums pass through all values before the magic numbers cancel
  using Signed = std::int32_t;
  static constexpr float magic = 12582912.0f;          ///< 1.5 * 2^23
  static constexpr Integer magic_bits = 0x4b400000u;   ///< its bits
  static constexpr double largest_term = 4194304.0;    ///< 2^22 units
  static constexpr double largest_sum = 2147483647.0;  ///< units
};

template <>
struct FixedPoint<double> {
  using Integer = unsigned long long;  ///< the type of 64 bits that CUDA's atomicAdd knows
  using Signed = long long;
  static constexpr double magic = 6755399441055744.0;           ///< 1.5 * 2^52
  static constexpr Integer magic_bits = 0x4338000000000000ull;  ///< its bits
  static constexpr double largest_term = 2251799813685248.0;    ///< 2^51 units
  static constexpr double largest_sum = 9.2e18;                 ///< units
};

}  // namespace evodevo::cuda
