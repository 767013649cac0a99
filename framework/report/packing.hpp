// Numbers as short text: what a page holds in place of long lists.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "report/filming.hpp"

namespace evodevo {

/// Integers as text: zigzag and LEB128 to bytes, then zlib, then base64. A page unpacks it with what browsers bring.
std::string packed(std::span<const std::int64_t> numbers);

/// The differences between numbers that mostly ascend, packed.
std::string packed_differences(std::span<const std::uint32_t> numbers);

/// Places in units of `step` (m), packed axis by axis and frame by frame. The first frame holds differences between
/// masses; the second those from the first; every other what is left of a straight line through the two before it.
std::string packed_places(std::span<const Frame* const> frames, double step);

}  // namespace evodevo
