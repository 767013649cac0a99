// Reading and writing interleaved positions (x, y, z, padding, x, y, z, padding, ..): SIMD vectors of x, of y and of z
// are read for masses anywhere in the array, and written for consecutive masses. Included once per instruction set.
#if defined(EVODEVO_CPU_POSITIONS_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef EVODEVO_CPU_POSITIONS_INL_HPP
#undef EVODEVO_CPU_POSITIONS_INL_HPP
#else
#define EVODEVO_CPU_POSITIONS_INL_HPP
#endif

#include <cstdint>

#include "physics/physics.hpp"

HWY_BEFORE_NAMESPACE();
namespace evodevo::HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR

template <class D, class T = hn::TFromD<D>>
HWY_INLINE Triple<hn::Vec<D>> load_positions(D d, const T* positions, const std::uint32_t* offset) {
  const T* position = positions + *offset;
  return {hn::Set(d, position[0]), hn::Set(d, position[1]), hn::Set(d, position[2])};
}

template <class D, class T = hn::TFromD<D>>
HWY_INLINE void store_positions(D d, const Triple<hn::Vec<D>>& positions, T* to) {
  hn::Store(positions.x, d, to);
  hn::Store(positions.y, d, to + 1);
  hn::Store(positions.z, d, to + 2);
}

#else

/// Returns a vector whose 16-byte block b is loaded from positions + offset[b * stride]. Each load fills all blocks,
/// and blends keep the right one; this is faster than inserting the blocks one after the other.
template <class D, class T = hn::TFromD<D>>
HWY_INLINE hn::Vec<D> load_blocks(D d, const T* positions, const std::uint32_t* offset, std::size_t stride) {
  constexpr std::size_t blocks = hn::MaxLanes(D()) * sizeof(T) / 16;
  const auto block = [&](std::size_t b) HWY_ATTR {
    auto x = hn::LoadDup128(d, positions + offset[b * stride]);
#if !defined(__clang__)  // which knows this kind of operand only with AVX-512
    asm("" : "+v"(x.raw));
#endif
    return x;
  };
  if constexpr (blocks == 1) {
    return block(0);
  } else if constexpr (blocks == 2) {
    return hn::OddEvenBlocks(block(1), block(0));
  } else {
    static_assert(blocks == 4);
    // the other nesting is as fast but crashes GCC 12 with -fsanitize=address
    return hn::OddEvenBlocks(hn::ConcatUpperLower(d, block(3), block(1)), hn::ConcatUpperLower(d, block(2), block(0)));
  }
}

/// The positions (m) of the masses at positions + offset[lane]. Loading each position whole and transposing takes about
/// half the time of three gathers.
template <class D>
HWY_INLINE Triple<hn::Vec<D>> load_positions(D d, const float* positions, const std::uint32_t* offset) {
  const auto r0 = load_blocks(d, positions, offset + 0, 4);
  const auto r1 = load_blocks(d, positions, offset + 1, 4);
  const auto r2 = load_blocks(d, positions, offset + 2, 4);
  const auto r3 = load_blocks(d, positions, offset + 3, 4);
  const auto xy02 = hn::InterleaveLower(d, r0, r2);
  const auto xy13 = hn::InterleaveLower(d, r1, r3);
  const auto z02 = hn::InterleaveUpper(d, r0, r2);
  const auto z13 = hn::InterleaveUpper(d, r1, r3);
  return {hn::InterleaveLower(d, xy02, xy13), hn::InterleaveUpper(d, xy02, xy13), hn::InterleaveLower(d, z02, z13)};
}

template <class D>
HWY_INLINE Triple<hn::Vec<D>> load_positions(D d, const double* positions, const std::uint32_t* offset) {
  const auto xy0 = load_blocks(d, positions, offset + 0, 2);
  const auto xy1 = load_blocks(d, positions, offset + 1, 2);
  const auto z0 = load_blocks(d, positions + 2, offset + 0, 2);
  const auto z1 = load_blocks(d, positions + 2, offset + 1, 2);
  return {hn::InterleaveLower(d, xy0, xy1), hn::InterleaveUpper(d, xy0, xy1), hn::InterleaveLower(d, z0, z1)};
}

/// Writes the positions of consecutive masses.
template <class D, class T = hn::TFromD<D>>
HWY_INLINE void store_positions(D d, const Triple<hn::Vec<D>>& positions, T* to) {
  hn::StoreInterleaved4(positions.x, positions.y, positions.z, hn::Zero(d), d, to);
}

#endif

}  // namespace evodevo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
