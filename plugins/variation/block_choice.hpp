// Shared by the mutations that add, remove or duplicate a block of any type.
#pragma once

#include <optional>
#include <vector>

#include "evodevo/blocks.hpp"

/// Returns the indices of all blocks whose type may have one more block.
inline std::vector<std::uint32_t> growable_blocks(const evodevo::Genome& genome, const evodevo::Layout& layout) {
  std::vector<std::uint32_t> found;
  const std::vector<evodevo::Block>& blocks = layout.blocks(genome);
  for (std::uint32_t i = 0; i < blocks.size(); ++i)
    if (const std::uint32_t type = blocks[i].type; count_blocks(genome, layout, type) < layout.types[type].most)
      found.push_back(i);
  return found;
}

/// Returns a random item, or nothing if there is none.
inline std::optional<std::uint32_t> random_item(const std::vector<std::uint32_t>& items, evodevo::Rng& rng) {
  if (items.empty()) return std::nullopt;
  return items[rng.below(static_cast<std::uint32_t>(items.size()))];
}
