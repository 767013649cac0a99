// Packs lists of numbers into short text for the viewer's pages.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "report/filming.hpp"

namespace evodevo {

/// Packs integers: zigzag and LEB128 encode them as bytes, zlib compresses the bytes, and base64 turns them into text.
/// A page can undo all of this with the built-in functions of a browser and a few lines of code.
std::string packed(std::span<const std::int64_t> numbers);

/// Packs the differences between successive numbers. The text is short if the numbers mostly ascend.
std::string packed_differences(std::span<const std::uint32_t> numbers);

/// Packs the numbers that are in only one of two ascending lists, that is, those that were added or removed from
/// `before` to `after`. They are packed as differences.
std::string packed_changes(std::span<const std::uint32_t> before, std::span<const std::uint32_t> after);

/// Packs the values of masses or springs, shot by shot. Packs the difference of each value from the last value of the
/// same mass or spring.
class ValuePacking {
 public:
  /// `count` is the number of masses or springs. Before the first shot, all last values count as 0.
  explicit ValuePacking(std::size_t count) : last_(count) {}

  /// Packs the values of one shot; values[i] is that of the mass or spring with number numbers[i]. Packs nothing if
  /// there are no values.
  std::string next(std::span<const std::uint32_t> numbers, std::span<const std::int64_t> values);

 private:
  std::vector<std::int64_t> last_;
};

/// Returns the multiple of a step that is nearest to a finite value, in steps. What is farther than 2^29 steps away, as
/// after a divergence, is taken to be there, so that the page can add and subtract places in 32 bits.
std::int64_t whole_steps(double value, double step);

/// Packs the positions of masses, shot by shot. A shot is packed frame by frame; a frame is packed as all x, then all
/// y, then all z.
class PlacePacking {
 public:
  /// `count` is the number of masses, `step` the unit of positions (m).
  PlacePacking(std::size_t count, double step) : step_(step), last_(3 * count), known_(count) {}

  /// Packs the frames of one shot; numbers[i] is the number of mass i. Packs the difference of each coordinate from a
  /// prediction. In the first frame, the prediction is the last position of the mass or, for a new mass, the position
  /// of the mass before it in the frame. In the second frame, it is the position in the first frame. In later frames,
  /// it is the position in the previous frame plus half of the motion between the two previous frames.
  std::string next(std::span<const Frame* const> frames, std::span<const std::uint32_t> numbers);

 private:
  /// Returns the positions of a frame in units of `step`: all x, all y, all z.
  std::vector<std::int64_t> positions(const Frame& frame) const;
  /// Returns the predictions for the first frame of a shot. `now` are the actual positions in that frame.
  std::vector<std::int64_t> first_guess(std::span<const std::int64_t> now,
                                        std::span<const std::uint32_t> numbers) const;
  /// Remembers the positions in the last frame of a shot.
  void keep(std::span<const std::int64_t> last, std::span<const std::uint32_t> numbers);

  double step_;                     ///< m
  std::vector<std::int64_t> last_;  ///< last position of each mass: all x, all y, all z
  std::vector<bool> known_;         ///< for each mass, whether it has been in a shot
};

}  // namespace evodevo
