// In which row each of a group's springs lies.
#pragma once

#include <cstdint>
#include <span>

#include "cuda/layout/ownership.hpp"

namespace evodevo::cuda {

/// A spring of a group: the lane of its owner, the bank of the other mass.
struct Link {
  std::uint8_t lane, bank;
  std::uint32_t row = open;  ///< the answer; one that is given stays if it can
};

/// Deals out the springs of a group to `rows` rows, so that no row has two springs of one lane and, as far as possible,
/// none has two of one bank. No lane may have more than `rows` springs.
void choose_rows(std::span<Link> links, std::size_t rows);

}  // namespace evodevo::cuda
