// Chooses the row of each spring of a group.
#pragma once

#include <cstdint>
#include <span>

#include "cuda/layout/arrangement/ownership.hpp"

namespace evodevo::cuda {

/// A spring of a group: the lane of its owner and the bank of its other mass.
struct Link {
  std::uint8_t lane, bank;
  std::uint32_t row = open;  ///< the chosen row; a row that is already set is kept if possible
};

/// Divides the springs of a group among `rows` rows, so that no row has two springs of the same lane and, as far as
/// possible, no two springs of the same bank. No lane may have more than `rows` springs.
void choose_rows(std::span<Link> links, std::size_t rows);

}  // namespace evodevo::cuda
