// Genomes whose blocks come and go: adding, removing, moving and copying blocks, grafting those of another genome, and
// matching those of two genomes.
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

/// Calls visit(gene, target) for each reference gene of a block, one of layout.blocks(genome): with the index of the
/// gene in the block and that of the block to which it refers.
template <class Visit>
void for_each_reference(const Genome& genome, const Layout& layout, const Block& block, const Visit& visit) {
  const BlockType& type = layout.types[block.type];
  for (std::uint32_t gene = 0; gene < block.count; ++gene)
    if (type.gene(gene).is_reference()) visit(gene, target_of(genome, layout, block, gene));
}

/// Returns the indices of a block, of all blocks that refer to it, of all that refer to these, and so on, in ascending
/// order: of a tree whose branches refer to their parents, a branch with all that grow from it; of a network whose
/// links refer to nodes, a node with its links. They are the blocks that go together (remove_block()).
inline std::vector<std::uint32_t> referring_blocks(const Genome& genome, const Layout& layout, std::uint32_t block) {
  const std::vector<Block>& all = layout.blocks(genome);
  std::vector<std::vector<std::uint32_t>> referring(all.size());
  for (std::uint32_t i = 0; i < all.size(); ++i)
    if (layout.types[all[i].type].section == layout.types[all[block].type].section)
      for_each_reference(genome, layout, all[i], [&](auto, std::uint32_t target) { referring[target].push_back(i); });
  std::vector<std::uint32_t> found = {block};
  std::vector<bool> is_found(all.size());
  is_found[block] = true;
  for (std::size_t next = 0; next < found.size(); ++next)
    for (const std::uint32_t other : referring[found[next]]) {
      if (!is_found[other]) found.push_back(other);
      is_found[other] = true;
    }
  std::sort(found.begin(), found.end());
  return found;
}

/// Removes a block, then all blocks that referred to it, and so on. The layout must not be fixed. The genome may have
/// fewer blocks afterwards than the layout allows; see is_within_limits().
inline void remove_block(Genome& genome, const Layout& layout, std::uint32_t index) {
  const std::vector<std::uint32_t> gone = referring_blocks(genome, layout, index);
  const std::uint32_t section = layout.types[genome.blocks[index].type].section;
  Genome left;
  for (std::uint32_t i = 0; i < genome.blocks.size(); ++i) {
    if (std::binary_search(gone.begin(), gone.end(), i)) continue;
    Block block = genome.blocks[i];
    if (layout.types[block.type].section == section)
      for_each_reference(genome, layout, block, [&](std::uint32_t gene, std::uint32_t target) {
        genome[block.first + gene] -=
            static_cast<float>(std::lower_bound(gone.begin(), gone.end(), target) - gone.begin());
      });
    const auto first = genome.genes.begin() + block.first;
    block.first = static_cast<std::uint32_t>(left.size());
    left.genes.insert(left.genes.end(), first, first + block.count);
    left.blocks.push_back(block);
  }
  genome = std::move(left);
}

/// Moves a block to the index `place` of layout.blocks(genome); the others keep their order, and references follow the
/// blocks to which they refer. Returns whether it could: false, and the genome stays as it is, if `place` is not in the
/// section of the block, or if all genomes have the same blocks in this section (Layout::is_fixed()).
inline bool move_block(Genome& genome, const Layout& layout, std::uint32_t block, std::uint32_t place) {
  const std::uint32_t section = layout.types[layout.blocks(genome)[block].type].section;
  if (layout.is_fixed(section)) return false;
  std::vector<Block>& all = genome.blocks;
  if (place >= all.size() || layout.types[all[place].type].section != section) return false;
  const std::uint32_t begin = layout.section_begin(genome, section);
  const auto moved = [&](std::uint32_t index) {
    if (index == block) return place;
    if (block < index && index <= place) return index - 1;
    return place <= index && index < block ? index + 1 : index;
  };
  for (const Block& other : all)
    if (layout.types[other.type].section == section)
      for_each_reference(genome, layout, other, [&](std::uint32_t gene, std::uint32_t target) {
        genome[other.first + gene] = static_cast<float>(moved(target) - begin);
      });
  const auto rotate = [&](auto items, std::uint32_t low, std::uint32_t middle, std::uint32_t high) {
    std::rotate(items + low, items + middle, items + high);
  };
  const std::uint32_t low = std::min(block, place), high = std::max(block, place);
  const std::uint32_t first = all[low].first, last = all[high].first + all[high].count;
  rotate(genome.genes.begin(), first, block < place ? first + all[block].count : all[block].first, last);
  rotate(all.begin(), low, block < place ? low + 1 : high, high + 1);
  for (std::uint32_t i = low, next = first; i <= high; next += all[i++].count) all[i].first = next;
  return true;
}

/// Adds copies of some blocks of `from`, a genome of the same layout or `to` itself, at the end of their sections of
/// `to`, in the order of `blocks` (indices into layout.blocks(from), all different). Each copy has the id of its
/// original or, if `ids` are given, the one at the same place of `ids`. A reference between the originals becomes one
/// between the copies; any other goes to the block of `to` with the id of the block to which the original refers.
/// Returns the indices of the copies in `to`, in the order of `blocks`. Returns nothing, and `to` stays as it is, if
/// that is impossible: `to` has no such block of the same type to refer to, or has one of the ids already in this
/// section, or would have more blocks of a type than the layout allows, as always where the layout is fixed.
inline std::optional<std::vector<std::uint32_t>> insert_blocks(Genome& to, const Genome& from,
                                                               std::span<const std::uint32_t> blocks,
                                                               const Layout& layout,
                                                               std::span<const BlockId> ids = {}) {
  const std::vector<Block>& originals = layout.blocks(from);
  const auto id_of = [&](std::size_t i) { return ids.empty() ? originals[blocks[i]].id : ids[i]; };
  const auto section_of = [&](std::size_t i) { return layout.types[originals[blocks[i]].type].section; };
  Genome made = to;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const Block& original = originals[blocks[i]];
    if (count_blocks(made, layout, original.type) >= layout.types[original.type].most ||
        find_block(made, layout, id_of(i), section_of(i)))
      return std::nullopt;
    add_block(made, layout, original.type, std::span(from.genes).subspan(original.first, original.count), id_of(i));
  }
  std::vector<std::uint32_t> copies;
  for (std::size_t i = 0; i < blocks.size(); ++i) copies.push_back(*find_block(made, layout, id_of(i), section_of(i)));
  bool is_whole = true;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const std::uint32_t begin = layout.section_begin(made, section_of(i)), first = made.blocks[copies[i]].first;
    for_each_reference(from, layout, originals[blocks[i]], [&](std::uint32_t gene, std::uint32_t target) {
      const auto copied = static_cast<std::size_t>(std::find(blocks.begin(), blocks.end(), target) - blocks.begin());
      const auto here =
          copied < blocks.size() ? copies[copied] : find_block(made, layout, originals[target].id, section_of(i));
      is_whole = is_whole && here && made.blocks[*here].type == originals[target].type;
      if (is_whole) made[first + gene] = static_cast<float>(*here - begin);
    });
  }
  if (!is_whole) return std::nullopt;
  to = std::move(made);
  return copies;
}

/// The same for one block, whose copy has another id if `id` is given. Returns the index of the copy.
inline std::optional<std::uint32_t> insert_block(Genome& to, const Genome& from, std::uint32_t block,
                                                 const Layout& layout, std::optional<BlockId> id = {}) {
  const std::uint32_t blocks[] = {block};
  const BlockId ids[] = {id.value_or(layout.blocks(from)[block].id)};
  const auto copies = insert_blocks(to, from, blocks, layout, ids);
  return copies ? std::optional(copies->front()) : std::nullopt;
}

/// Grafts a block of `from`, a genome of the same layout, on `to`, with all that refers to it (referring_blocks()), and
/// with those of the blocks to which all these refer that `to` lacks, in turn. Of a tree, this is a branch with all
/// that grows from it, and with its parents up to the first that `to` has; of a network, a node with its links and,
/// without other links, the nodes that these join it to. Blocks whose ids `to` has stay as they are in `to`. Returns
/// the indices of the new blocks in `to`, which have the ids of their originals; none if `to` has them all, as where
/// the layout is fixed. Returns nothing, and `to` stays as it is, if that is impossible: `to` would have more blocks of
/// a type than the layout allows, or has a block of another type under the id of one that is referred to.
inline std::optional<std::vector<std::uint32_t>> graft_block(Genome& to, const Genome& from, std::uint32_t block,
                                                             const Layout& layout) {
  const std::vector<Block>& originals = layout.blocks(from);
  const std::uint32_t section = layout.types[originals[block].type].section;
  std::vector<std::uint32_t> wanted = referring_blocks(from, layout, block), missing;
  std::vector<bool> is_wanted(originals.size());
  for (const std::uint32_t one : wanted) is_wanted[one] = true;
  for (std::size_t next = 0; next < wanted.size(); ++next) {
    const std::uint32_t one = wanted[next];
    if (find_block(to, layout, originals[one].id, section)) continue;
    missing.push_back(one);
    for_each_reference(from, layout, originals[one], [&](auto, std::uint32_t target) {
      if (!is_wanted[target]) wanted.push_back(target);
      is_wanted[target] = true;
    });
  }
  std::sort(missing.begin(), missing.end());
  return insert_blocks(to, from, missing, layout);
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
