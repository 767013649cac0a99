// For mutations: random choices among the blocks of a genome.
#pragma once

#include <optional>
#include <vector>

#include "evodevo/blocks.hpp"

namespace evodevo {

/// Returns the indices of all blocks whose type may have one more block.
inline std::vector<std::uint32_t> growable_blocks(const Genome& genome, const Layout& layout) {
  const std::vector<Block>& blocks = layout.blocks(genome);
  std::vector<std::uint32_t> count(layout.types.size());
  for (const Block& block : blocks) ++count[block.type];
  std::vector<std::uint32_t> found;
  for (std::uint32_t i = 0; i < blocks.size(); ++i)
    if (count[blocks[i].type] < layout.types[blocks[i].type].most) found.push_back(i);
  return found;
}

/// Returns a random item, or nothing if there is none.
inline std::optional<std::uint32_t> random_item(const std::vector<std::uint32_t>& items, Rng& rng) {
  if (items.empty()) return std::nullopt;
  return items[rng.below(static_cast<std::uint32_t>(items.size()))];
}

}  // namespace evodevo
