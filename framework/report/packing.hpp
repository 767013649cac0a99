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

/// The numbers that are in only one of two ascending lists, packed as differences: what came or went from `before` to
/// `after`.
std::string packed_changes(std::span<const std::uint32_t> before, std::span<const std::uint32_t> after);

/// Packs values that masses or springs have shot by shot, as differences from what each had when it was last there.
class ValuePacking {
 public:
  /// For things with numbers up to `count`, all of which have 0 at first.
  explicit ValuePacking(std::size_t count) : last_(count) {}

  /// The values of the things of these numbers, as many as there are values.
  std::string next(std::span<const std::uint32_t> numbers, std::span<const std::int64_t> values);

 private:
  std::vector<std::int64_t> last_;
};

/// Packs where masses are shot by shot, axis by axis and frame by frame.
class PlacePacking {
 public:
  /// For masses with numbers up to `count`, in units of `step` (m).
  PlacePacking(std::size_t count, double step) : step_(step), last_(3 * count), known_(count) {}

  /// The frames of a shot with masses of these numbers. The first holds differences from where each mass was last, and
  /// of new masses from the one before; the second those from the first; every other what is left after half of the
  /// motion between the two before it.
  std::string next(std::span<const Frame* const> frames, std::span<const std::uint32_t> numbers);

 private:
  /// Where masses are at a moment, in steps: all x, all y, all z.
  std::vector<std::int64_t> positions(const Frame& frame) const;
  /// Where they are thought to be, before the first frame of a shot is known, given where they are.
  std::vector<std::int64_t> first_guess(std::span<const std::int64_t> now,
                                        std::span<const std::uint32_t> numbers) const;
  void keep(std::span<const std::int64_t> last, std::span<const std::uint32_t> numbers);

  double step_;
  std::vector<std::int64_t> last_;  ///< all x, all y, all z
  std::vector<bool> known_;         ///< has been in a shot
};

}  // namespace evodevo
