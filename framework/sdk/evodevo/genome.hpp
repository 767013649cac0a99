// Genomes, and the layout that describes them.
//
//   genome ── sections: one for each operator that owns genes, the encoding first
//     section ── blocks: genes that belong together, such as the bias and the weights of one neuron
//       block ── a type, an id, and genes: real numbers, choices, or references to other blocks
//
// The simplest layouts only call Layout::add_block(): every genome then has the same blocks, and is an array of genes.
// Genomes whose blocks come and go need types with limits (Layout::add_type()) and the functions of evodevo/blocks.hpp.
#pragma once

#include <algorithm>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "evodevo/rng.hpp"

namespace evodevo {

/// The values that one gene may have. The value of a real gene is a number from `low` to `high`; the value of a choice
/// gene is the index of one of `choices` options, a whole number from 0 to choices-1; the value of a reference gene is
/// the index of a block of type `refers_to`, counted among all blocks of its section.
struct GeneSpec {
  float low = -1, high = 1;
  std::uint32_t choices = 0;                 ///< number of options; 0: not a choice gene
  std::optional<std::uint32_t> refers_to{};  ///< a type of the same section; none: not a reference

  bool is_choice() const { return choices > 0; }
  bool is_reference() const { return refers_to.has_value(); }
  bool is_real() const { return !is_choice() && !is_reference(); }

  /// Returns a random value of a real or choice gene, uniformly distributed over all allowed values.
  float draw(Rng& rng) const {
    if (is_choice()) return static_cast<float>(rng.below(choices));
    return static_cast<float>(rng.uniform(low, high));
  }

  bool operator==(const GeneSpec&) const = default;
};

/// Says which blocks of different genomes descend from each other (homology): equal ids, equal descent. The blocks of
/// first genomes have equal ids in all of them; fresh_id() and derived_id() (evodevo/blocks.hpp) make the ids of
/// others.
using BlockId = std::uint64_t;

/// Consecutive genes of one genome that belong together.
struct Block {
  std::uint32_t type = 0;   ///< index into Layout::types
  std::uint32_t first = 0;  ///< index of its first gene
  std::uint32_t count = 0;  ///< number of its genes
  BlockId id = 0;           ///< unique within its section

  bool operator==(const Block&) const = default;
};

/// What blocks of one type have in common.
struct BlockType {
  std::string name;             ///< such as "neuron"; unique within its section
  std::vector<GeneSpec> genes;  ///< of a block, in their order; the last one describes all further genes of the block
  std::uint32_t least = 0, most = 0;         ///< smallest and largest number of such blocks in a genome
  std::vector<std::string> gene_names = {};  ///< names of the genes, for reports; those left out have numbers
  std::uint32_t section = 0;                 ///< index into Layout::sections; set by the host
  /// Names of the options of choice genes, for reports: an item for each of `genes`, which is empty if its options have
  /// numbers alone; those left out are empty. name_options() sets them.
  std::vector<std::vector<std::string>> option_names = {};

  /// Whether all genomes have the same number of such blocks.
  bool is_fixed() const { return least == most; }
  /// The description of a gene of a block, counted from 0.
  const GeneSpec& gene(std::size_t index) const { return genes[std::min(index, genes.size() - 1)]; }
  /// The names of the options of a gene of a block, counted from 0, in the order of their numbers; empty if they have
  /// none.
  std::span<const std::string> options(std::size_t index) const {
    index = std::min(index, genes.size() - 1);
    return index < option_names.size() ? std::span<const std::string>(option_names[index])
                                       : std::span<const std::string>{};
  }
  /// Names the options of the choice gene at index `gene` of `genes`: as many different names as it has options. The
  /// host refuses a layout in which they are others.
  void name_options(std::size_t gene, std::vector<std::string> names) {
    option_names.resize(std::max(option_names.size(), gene + 1));
    option_names[gene] = std::move(names);
  }

  bool operator==(const BlockType&) const = default;
};

/// The values of genes. It can be used like a std::vector<float> of all genes. Layout says what they mean.
struct Genome {
  std::vector<float> genes;
  std::vector<Block> blocks;  ///< in the order of their genes; empty if Layout::is_fixed()

  Genome() = default;
  Genome(std::initializer_list<float> values) : genes(values) {}
  explicit Genome(std::size_t count, float value = 0) : genes(count, value) {}

  std::size_t size() const { return genes.size(); }
  bool empty() const { return genes.empty(); }
  float* data() { return genes.data(); }
  const float* data() const { return genes.data(); }
  auto begin() { return genes.begin(); }
  auto begin() const { return genes.begin(); }
  auto end() { return genes.end(); }
  auto end() const { return genes.end(); }
  float& operator[](std::size_t gene) { return genes[gene]; }
  const float& operator[](std::size_t gene) const { return genes[gene]; }

  bool operator==(const Genome&) const = default;
};

/// The genome of operators that own no genes.
inline const Genome no_genes;

/// The description of genomes: their types of blocks, and the blocks of a first genome.
struct Layout {
  std::vector<BlockType> types;
  std::vector<Block> first_blocks;           ///< of a genome that has no ancestors, in the order of their genes
  std::vector<std::string> sections = {""};  ///< names of the sections' owners; set by the host
  std::optional<std::uint32_t> own{};  ///< the section that the operator owns which gets the layout; set by the host

  /// Declares a type whose blocks may come and go, and returns its index. `type.least` and `type.most` are its limits.
  std::uint32_t add_type(BlockType type) {
    types.push_back(std::move(type));
    return static_cast<std::uint32_t>(types.size() - 1);
  }
  /// Appends a block of a declared type to first genomes. `count` is its number of genes; 0: those that the type lists.
  void add_block_of(std::uint32_t type, std::uint32_t count = 0) {
    const auto place = static_cast<std::uint32_t>(
        std::count_if(first_blocks.begin(), first_blocks.end(), [&](const Block& b) { return b.type == type; }));
    append(type, count > 0 ? count : static_cast<std::uint32_t>(types[type].genes.size()), place);
  }
  /// Appends a block with the given genes that every genome has.
  void add_block(std::vector<GeneSpec> genes, std::uint32_t count, std::string name = "block") {
    auto type = std::find_if(types.begin(), types.end(), [&](const BlockType& one) {
      return one.is_fixed() && one.name == name && one.genes == genes;
    });
    if (type == types.end()) type = types.insert(type, {std::move(name), std::move(genes)});
    append(static_cast<std::uint32_t>(type - types.begin()), count, type->least);
    type->most = ++type->least;
  }
  void add_block(std::vector<GeneSpec> genes, std::string name = "block") {
    const auto count = static_cast<std::uint32_t>(genes.size());
    add_block(std::move(genes), count, std::move(name));
  }
  /// Appends a block of `count` genes with the same description that every genome has.
  void add_block(std::uint32_t count, GeneSpec gene, std::string name = "block") {
    add_block(std::vector<GeneSpec>{gene}, count, std::move(name));
  }

  /// Whether all genomes have the same blocks, those of `first_blocks`.
  bool is_fixed() const {
    return std::all_of(types.begin(), types.end(), [](const BlockType& type) { return type.is_fixed(); });
  }
  /// Whether all genomes have the same blocks in a section, those of `first_blocks`, in the same order.
  bool is_fixed(std::uint32_t section) const {
    return std::all_of(types.begin(), types.end(),
                       [&](const BlockType& type) { return type.section != section || type.is_fixed(); });
  }
  /// The number of genes of a first genome.
  std::size_t first_size() const {
    return first_blocks.empty() ? 0 : first_blocks.back().first + first_blocks.back().count;
  }
  const std::vector<Block>& blocks(const Genome& genome) const { return is_fixed() ? first_blocks : genome.blocks; }
  /// The index of the block that contains a gene.
  std::uint32_t block_of(const Genome& genome, std::size_t gene) const {
    const std::vector<Block>& all = blocks(genome);
    const auto next = std::upper_bound(all.begin(), all.end(), gene,
                                       [](std::size_t g, const Block& block) { return g < block.first + block.count; });
    return static_cast<std::uint32_t>(next - all.begin());
  }
  /// The description of a gene of a genome.
  const GeneSpec& gene(const Genome& genome, std::size_t gene) const {
    const Block& block = blocks(genome)[block_of(genome, gene)];
    return types[block.type].gene(gene - block.first);
  }
  /// The index of the first block of a section, from which references to its blocks count.
  std::uint32_t section_begin(const Genome& genome, std::uint32_t section) const {
    const std::vector<Block>& all = blocks(genome);
    const auto in_section = [&](const Block& block) { return types[block.type].section == section; };
    return static_cast<std::uint32_t>(std::find_if(all.begin(), all.end(), in_section) - all.begin());
  }
  /// The genes of the section that the operator owns (`own`); empty if it owns none.
  std::span<float> own_genes(Genome& genome) const {
    if (!own) return {};
    std::size_t first = genome.size(), last = 0;
    for (const Block& block : blocks(genome)) {
      if (types[block.type].section != *own) continue;
      first = std::min<std::size_t>(first, block.first);
      last = block.first + block.count;
    }
    return std::span(genome.genes).subspan(std::min(first, last), last - std::min(first, last));
  }
  /// Returns a random allowed value for a gene of a genome, uniformly distributed. A reference goes to any block of its
  /// type; if there is none, it keeps its value.
  float draw(const Genome& genome, std::size_t gene, Rng& rng) const {
    const Block& block = blocks(genome)[block_of(genome, gene)];
    return draw(genome, block, gene, rng);
  }

  bool operator==(const Layout&) const = default;

 private:
  friend Genome random_genome(const Layout& layout, Rng& rng);

  float draw(const Genome& genome, const Block& block, std::size_t gene, Rng& rng) const {
    const GeneSpec& spec = types[block.type].gene(gene - block.first);
    if (!spec.is_reference()) return spec.draw(rng);
    const std::vector<Block>& all = blocks(genome);
    const auto is_target = [&](const Block& other) { return other.type == *spec.refers_to; };
    const auto targets = static_cast<std::uint32_t>(std::count_if(all.begin(), all.end(), is_target));
    if (targets == 0) return genome[gene];
    auto target = std::find_if(all.begin(), all.end(), is_target);
    for (std::uint32_t left = rng.below(targets); left > 0; --left)
      target = std::find_if(target + 1, all.end(), is_target);
    const std::uint32_t begin = section_begin(genome, types[block.type].section);
    return static_cast<float>(target - all.begin() - begin);
  }

  void append(std::uint32_t type, std::uint32_t count, std::uint32_t place) {
    // by type and place, so that they are equal in all first genomes
    const BlockId id = (BlockId{type} + 1) << 32 | place;
    first_blocks.push_back({type, static_cast<std::uint32_t>(first_size()), count, id});
  }
};

/// Returns a first genome whose genes are independent and uniformly distributed over their allowed values.
inline Genome random_genome(const Layout& layout, Rng& rng) {
  Genome genome(layout.first_size());
  if (!layout.is_fixed()) genome.blocks = layout.first_blocks;
  for (const Block& block : layout.first_blocks)
    for (std::uint32_t gene = block.first; gene < block.first + block.count; ++gene)
      genome[gene] = layout.draw(genome, block, gene, rng);
  return genome;
}

}  // namespace evodevo
