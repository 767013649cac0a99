// Genomes whose blocks come and go: adding, removing and copying blocks, and matching those of two genomes.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "evodevo/genome.hpp"

namespace evodevo {

/// Returns an id that no other block has, for a block that descends from none. It depends on the stream alone, and so
/// on the run's seed, the generation, the child, and how often numbers were drawn for it.
inline BlockId fresh_id(Rng& rng) {
  const BlockId high = rng();
  return high << 32 | rng();
}

/// Returns the id of a block that comes from another one in a certain role, such as the node that splits a link. The
/// same innovation in two genomes has the same id (historical markings: Stanley and Miikkulainen 2002), without a table
/// of all innovations.
constexpr BlockId derived_id(BlockId from, std::uint32_t role) { return mixed(from, role); }
/// The same for a block that comes from two others, such as the link that joins two nodes.
constexpr BlockId derived_id(BlockId one, BlockId other, std::uint32_t role) {
  return derived_id(derived_id(one, role) ^ other, role);
}

/// Returns the index of the block with an id in a section, or nothing if there is none.
inline std::optional<std::uint32_t> find_block(const Genome& genome, const Layout& layout, BlockId id,
                                               std::uint32_t section = 0) {
  const std::vector<Block>& all = layout.blocks(genome);
  for (std::uint32_t i = 0; i < all.size(); ++i)
    if (all[i].id == id && layout.types[all[i].type].section == section) return i;
  return std::nullopt;
}

/// Returns the number of blocks of a type.
inline std::uint32_t count_blocks(const Genome& genome, const Layout& layout, std::uint32_t type) {
  const std::vector<Block>& all = layout.blocks(genome);
  return static_cast<std::uint32_t>(
      std::count_if(all.begin(), all.end(), [&](const Block& block) { return block.type == type; }));
}

/// Returns whether a genome has no more and no fewer blocks of each type than the layout allows.
inline bool is_within_limits(const Genome& genome, const Layout& layout) {
  for (std::uint32_t type = 0; type < layout.types.size(); ++type) {
    const std::uint32_t count = count_blocks(genome, layout, type);
    if (count < layout.types[type].least || count > layout.types[type].most) return false;
  }
  return true;
}

/// Returns the index of the block to which a reference gene refers.
inline std::uint32_t target_of(const Genome& genome, const Layout& layout, const Block& block, std::uint32_t gene) {
  return layout.section_begin(genome, layout.types[block.type].section) +
         static_cast<std::uint32_t>(genome[block.first + gene]);
}

/// Adds a block at the end of its section, and returns its index. `values` are its genes. Existing references stay
/// valid. The layout must not be fixed, and `id` must be new in the section.
inline std::uint32_t add_block(Genome& genome, const Layout& layout, std::uint32_t type, std::span<const float> values,
                               BlockId id) {
  const std::vector<float> copy(values.begin(), values.end());  // `values` may be genes of this genome
  const std::uint32_t section = layout.types[type].section;
  const auto behind = std::find_if(genome.blocks.begin(), genome.blocks.end(),
                                   [&](const Block& block) { return layout.types[block.type].section > section; });
  const auto index = static_cast<std::uint32_t>(behind - genome.blocks.begin());
  const auto first = behind == genome.blocks.end() ? static_cast<std::uint32_t>(genome.size()) : behind->first;
  const auto count = static_cast<std::uint32_t>(copy.size());
  genome.genes.insert(genome.genes.begin() + first, copy.begin(), copy.end());
  for (auto later = behind; later != genome.blocks.end(); ++later) later->first += count;
  genome.blocks.insert(behind, {type, first, count, id});
  return index;
}

/// Removes a block, then all blocks that referred to it, and so on. The genome may have fewer blocks afterwards than
/// the layout allows; see is_within_limits().
inline void remove_block(Genome& genome, const Layout& layout, std::uint32_t index) {
  std::vector<std::uint32_t> left = {index};
  while (!left.empty()) {
    const std::uint32_t gone = left.back();
    left.pop_back();
    const Block block = genome.blocks[gone];
    const std::uint32_t section = layout.types[block.type].section, begin = layout.section_begin(genome, section);
    genome.genes.erase(genome.genes.begin() + block.first, genome.genes.begin() + block.first + block.count);
    genome.blocks.erase(genome.blocks.begin() + gone);
    for (std::uint32_t& other : left) other -= other > gone;
    for (std::uint32_t i = 0; i < genome.blocks.size(); ++i) {
      Block& other = genome.blocks[i];
      if (i >= gone) other.first -= block.count;
      if (layout.types[other.type].section != section) continue;
      for (std::uint32_t gene = 0; gene < other.count; ++gene) {
        if (!layout.types[other.type].gene(gene).is_reference()) continue;
        float& target = genome[other.first + gene];
        if (target == static_cast<float>(gone - begin) && std::find(left.begin(), left.end(), i) == left.end())
          left.push_back(i);
        if (target > static_cast<float>(gone - begin)) --target;
      }
    }
  }
}

/// Copies the genes of a block of `from` to the corresponding block of `to`, which has the same type and number of
/// genes. A reference is copied only if `to` has a block with the id of the block to which it refers.
/// If only some of the genes are to be copied, `first` and `last` are the index of the first of them, counted within
/// the block, and of the one after the last.
inline void copy_genes(Genome& to, std::uint32_t to_block, const Genome& from, std::uint32_t from_block,
                       const Layout& layout, std::uint32_t first = 0, std::uint32_t last = ~0u) {
  const Block &target = layout.blocks(to)[to_block], &source = layout.blocks(from)[from_block];
  const std::uint32_t section = layout.types[source.type].section;
  for (std::uint32_t gene = first; gene < std::min(last, source.count); ++gene) {
    float value = from[source.first + gene];
    if (layout.types[source.type].gene(gene).is_reference()) {
      const Block& referred = layout.blocks(from)[target_of(from, layout, source, gene)];
      const auto here = find_block(to, layout, referred.id, section);
      if (!here) continue;
      value = static_cast<float>(*here - layout.section_begin(to, section));
    }
    to[target.first + gene] = value;
  }
}

/// Returns, for each block of `one`, the index of the block of `other` with the same id, type and number of genes, or
/// nothing if there is none.
inline std::vector<std::optional<std::uint32_t>> homologous(const Genome& one, const Genome& other,
                                                            const Layout& layout) {
  struct Key {
    std::uint32_t section;
    BlockId id;
    std::uint32_t index;
    bool operator<(const Key& k) const { return std::pair(section, id) < std::pair(k.section, k.id); }
  };
  const std::vector<Block>&mine = layout.blocks(one), &theirs = layout.blocks(other);
  std::vector<std::optional<std::uint32_t>> partners(mine.size());
  if (layout.is_fixed()) {
    for (std::uint32_t i = 0; i < mine.size(); ++i) partners[i] = i;
    return partners;
  }
  std::vector<Key> keys;
  for (std::uint32_t i = 0; i < theirs.size(); ++i)
    keys.push_back({layout.types[theirs[i].type].section, theirs[i].id, i});
  std::sort(keys.begin(), keys.end());
  for (std::uint32_t i = 0; i < mine.size(); ++i) {
    const Key wanted{layout.types[mine[i].type].section, mine[i].id, 0};
    const auto found = std::lower_bound(keys.begin(), keys.end(), wanted);
    if (found == keys.end() || wanted < *found) continue;
    const Block& partner = theirs[found->index];
    if (partner.type == mine[i].type && partner.count == mine[i].count) partners[i] = found->index;
  }
  return partners;
}

}  // namespace evodevo
