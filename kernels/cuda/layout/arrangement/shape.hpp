// The size of the blocks that simulate a body, and how many rows of springs each of their warps has.
//
// kernels/cuda/README.md explains the terms.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>

namespace evodevo::cuda {

/// a/b, rounded up.
constexpr unsigned divided(std::size_t a, std::size_t b) { return static_cast<unsigned>((a + b - 1) / b); }

/// What a body is arranged for.
struct Target {
  /// Twice the bodies for each multiprocessor up to which the numbers in shape.cpp were fitted.
  static constexpr unsigned many = 16;

  /// A number of warps alone stands for a target with many bodies.
  Target(unsigned largest_block_, unsigned at_once_ = many, std::size_t entries_ = 0)
      : largest_block(largest_block_), at_once(at_once_), entries(entries_) {}
  friend bool operator==(const Target&, const Target&) = default;

  unsigned largest_block;  ///< warps
  unsigned at_once;        ///< bodies for each multiprocessor; from `many` on, as many as it has room for
  std::size_t entries;     ///< of a row of the table of lengths; 0 if it is not filled again and again
};

/// What a block must have room for.
struct Needs {
  std::size_t rows = 0, cut_rows = 0;  ///< of springs inside, and of cut springs
  std::uint32_t groups = 0;
};

/// The sizes of a block for which a body is arranged.
struct Shape {
  unsigned block = 0;      ///< warps in the block
  unsigned warps = 0;      ///< warps with springs inside
  unsigned cut_warps = 0;  ///< the warps after them, with cut springs
  unsigned rows = 0;       ///< rows in a chunk of warps with springs inside
  unsigned cut_rows = 0;   ///< likewise, of warps with cut springs
  unsigned chunks = 0;     ///< chunks of rows for each warp
  unsigned masses_per_thread = 0;

  friend auto operator<=>(const Shape&, const Shape&) = default;
  std::size_t rows_inside() const { return std::size_t{chunks} * warps * rows; }
  std::size_t rows_of_cut() const { return std::size_t{chunks} * cut_warps * cut_rows; }
  std::size_t slots() const { return 32 * (rows_inside() + rows_of_cut()); }
};

/// The shape of all blocks that simulate a body, the fastest one.
Shape shape_for(const Needs& needs, const Target& target);

}  // namespace evodevo::cuda
