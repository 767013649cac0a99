#include "base/genome_sections.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numeric>
#include <set>
#include <stdexcept>

#include "base/text.hpp"
#include "evodevo/blocks.hpp"

namespace evodevo {
namespace {

/// Largest number of blocks of a section, so that a gene, which is a float, can count them exactly.
constexpr std::uint32_t most_blocks = 1 << 24;

/// The types of one section of a layout, which follow each other.
struct Types {
  std::uint32_t first = 0, count = 0;
  bool are_fixed = true;
};

Types types_of(const Layout& layout, std::uint32_t section) {
  Types types;
  for (std::uint32_t i = 0; i < layout.types.size(); ++i) {
    if (layout.types[i].section != section) continue;
    if (types.count++ == 0) types.first = i;
    types.are_fixed &= layout.types[i].is_fixed();
  }
  return types;
}

/// Appends blocks, whose types and genes are counted from other indices, to those of a genome or a layout.
void append_blocks(std::vector<Block>& blocks, const std::vector<Block>& more, std::uint32_t first_type,
                   std::uint32_t first_gene) {
  for (Block block : more) {
    block.type += first_type;
    block.first += first_gene;
    blocks.push_back(block);
  }
}

/// Returns the blocks of one section, with types and genes counted from the section's first.
std::vector<Block> blocks_in(const std::vector<Block>& blocks, const Types& types) {
  std::vector<Block> found;
  for (const Block& block : blocks)
    if (block.type >= types.first && block.type - types.first < types.count) found.push_back(block);
  const std::uint32_t first_gene = found.empty() ? 0 : found.front().first;
  for (Block& block : found) {
    block.type -= types.first;
    block.first -= first_gene;
  }
  return found;
}

/// Appends a section whose types refer to types from `first_type` on.
void append(Layout& layout, const std::string& owner, const std::vector<BlockType>& types, std::uint32_t first_type,
            const std::vector<Block>& first_blocks) {
  const auto new_first = static_cast<std::uint32_t>(layout.types.size()),
             section = static_cast<std::uint32_t>(layout.sections.size()),
             first_gene = static_cast<std::uint32_t>(layout.first_size());
  layout.sections.push_back(owner);
  for (BlockType type : types) {
    type.section = section;
    for (GeneSpec& gene : type.genes)
      if (gene.refers_to) gene.refers_to = *gene.refers_to - first_type + new_first;
    const std::size_t genes = std::max(type.genes.size(), type.gene_names.size());
    type.option_names.resize(type.genes.size());
    type.option_names.resize(genes, type.option_names.back());  // the last gene describes all further ones
    type.genes.resize(genes, type.genes.back());
    type.gene_names.resize(genes);
    layout.types.push_back(std::move(type));
  }
  append_blocks(layout.first_blocks, first_blocks, new_first, first_gene);
}

std::string gene_spec_fault(const GeneSpec& gene, const Layout& layout) {
  if (gene.is_reference())
    return *gene.refers_to < layout.types.size() ? "" : fmt::format("refers to type {}", *gene.refers_to);
  const bool is_range =
      gene.is_choice() || (gene.low <= gene.high && std::isfinite(gene.low) && std::isfinite(gene.high));
  return is_range ? "" : fmt::format("has the range {} to {}", to_text(gene.low), to_text(gene.high));
}

/// What is wrong with the names of the options of a gene, the one at an index of `genes`.
std::string options_fault(const BlockType& type, std::size_t gene) {
  const std::vector<std::string>& names = type.option_names[gene];
  if (names.empty()) return "";
  if (const std::uint32_t choices = type.genes[gene].choices; names.size() != choices)
    return fmt::format("names {} options of a gene that has {}", names.size(), choices);
  std::set<std::string_view> seen;
  for (const std::string& name : names) {
    if (const std::string fault = text_fault(name); name.empty() || !fault.empty())
      return fault.empty() ? "has an option without a name" : "has an option whose name " + fault;
    if (!seen.insert(name).second) return fmt::format("has two options with the name \"{}\"", name);
  }
  return "";
}

std::string type_fault(const BlockType& type, const Layout& layout) {
  const std::string title = fmt::format("block type \"{}\"", printable(type.name));
  if (const std::string fault = text_fault(type.name); type.name.empty() || !fault.empty())
    return fault.empty() ? "a block type has no name" : "a block type's name " + fault;
  if (type.genes.empty()) return title + " has no genes";
  if (type.least > type.most || type.most > most_blocks)
    return fmt::format("{} has the limits {} to {}, expected at most {}", title, type.least, type.most, most_blocks);
  for (const GeneSpec& gene : type.genes)
    if (const std::string fault = gene_spec_fault(gene, layout); !fault.empty())
      return fmt::format("{} has a gene that {}", title, fault);
  if (type.option_names.size() > type.genes.size())
    return fmt::format("{} names the options of {} genes, but has {}", title, type.option_names.size(),
                       type.genes.size());
  for (std::size_t gene = 0; gene < type.option_names.size(); ++gene)
    if (const std::string fault = options_fault(type, gene); !fault.empty())
      return fmt::format("{}, gene {}: {}", title, gene, fault);
  return "";
}

/// What is wrong with the blocks of a genome or of a layout.
std::string blocks_fault(const std::vector<Block>& blocks, std::size_t genes, const Layout& layout) {
  std::vector<std::uint32_t> counts(layout.types.size(), 0);
  std::set<std::pair<std::uint32_t, BlockId>> ids;
  std::size_t next = 0;
  std::uint32_t section = 0;
  for (const Block& block : blocks) {
    if (block.type >= layout.types.size()) return fmt::format("a block of type {}", block.type);
    const BlockType& type = layout.types[block.type];
    if (block.first != next || block.count == 0)
      return fmt::format("a block of genes {} to {}", block.first, block.first + block.count);
    if (type.section < section) return "sections that are out of order";
    if (!ids.emplace(type.section, block.id).second) return fmt::format("two blocks with the id {}", block.id);
    next += block.count;
    section = type.section;
    ++counts[block.type];
  }
  if (next != genes) return fmt::format("{} genes, but its blocks have {}", genes, next);
  for (std::size_t t = 0; t < counts.size(); ++t)
    if (const BlockType& type = layout.types[t]; counts[t] < type.least || counts[t] > type.most)
      return fmt::format("{} blocks of type \"{}\", expected {} to {}", counts[t], printable(type.name), type.least,
                         type.most);
  return "";
}

/// Finds genes whose values their descriptions do not allow.
class GeneCheck {
 public:
  GeneCheck(const Genome& genome, const Layout& layout)
      : genome_(genome), layout_(layout), blocks_(layout.blocks(genome)), begins_(layout.sections.size()) {
    for (std::uint32_t section = 0; section < begins_.size(); ++section)
      begins_[section] = layout.section_begin(genome, section);
  }

  std::string fault() const {
    for (const Block& block : blocks_)
      for (std::uint32_t gene = 0; gene < block.count; ++gene)
        if (!is_allowed(block, gene))
          return "gene " + std::to_string(block.first + gene) + " = " + to_text(genome_[block.first + gene]) +
                 ", which is not allowed";
    return "";
  }

 private:
  // written so that NaN fails
  static bool is_index(float value, std::size_t count) {
    return value >= 0 && value < static_cast<float>(count) && value == std::floor(value);
  }

  bool is_allowed(const Block& block, std::uint32_t gene) const {
    const float value = genome_[block.first + gene];
    const BlockType& type = layout_.types[block.type];
    const GeneSpec& spec = type.gene(gene);
    if (spec.is_choice()) return is_index(value, spec.choices);
    if (!spec.is_reference()) return value >= spec.low && value <= spec.high;
    const std::uint32_t begin = begins_[type.section];
    return is_index(value, blocks_.size() - begin) &&
           blocks_[begin + static_cast<std::size_t>(value)].type == *spec.refers_to;
  }

  const Genome& genome_;
  const Layout& layout_;
  const std::vector<Block>& blocks_;
  std::vector<std::uint32_t> begins_;
};

}  // namespace

std::string layout_fault(const Layout& layout) {
  std::set<std::string> names;
  for (const BlockType& type : layout.types) {
    if (std::string fault = type_fault(type, layout); !fault.empty()) return fault;
    if (!type.is_fixed() && !names.insert(type.name).second) return "two block types are called \"" + type.name + "\"";
  }
  if (const std::string fault = blocks_fault(layout.first_blocks, layout.first_size(), layout); !fault.empty())
    return "first genomes have " + fault;
  return "";
}

std::string genome_fault(const Genome& genome, const Layout& layout) {
  if (layout.is_fixed()) {
    if (genome.size() != layout.first_size())
      return std::to_string(genome.size()) + " genes, expected " + std::to_string(layout.first_size());
    if (!genome.blocks.empty()) return "blocks of its own, where all genomes have the same";
  } else if (std::string fault = blocks_fault(genome.blocks, genome.size(), layout); !fault.empty()) {
    return fault;
  }
  return GeneCheck(genome, layout).fault();
}

std::uint32_t add_section(Layout& whole, const std::string& owner, const Layout& section) {
  if (const std::string fault = layout_fault(section); !fault.empty())
    throw std::runtime_error("its layout is not usable: " + fault);
  append(whole, owner, section.types, 0, section.first_blocks);
  return static_cast<std::uint32_t>(whole.sections.size() - 1);
}

Layout some_sections(const Layout& whole, const SectionIndices& which, std::optional<std::uint32_t> own) {
  Layout layout{.sections = {}};
  for (const std::uint32_t section : which) {
    if (section == own) layout.own = static_cast<std::uint32_t>(layout.sections.size());
    const Types types = types_of(whole, section);
    const auto begin = whole.types.begin() + types.first;
    append(layout, whole.sections.at(section), {begin, begin + types.count}, types.first,
           blocks_in(whole.first_blocks, types));
  }
  return layout;
}

std::vector<Genome> split(const Genome& genome, const Layout& layout) {
  std::vector<Genome> sections(layout.sections.size());
  auto gene = genome.begin();
  for (std::uint32_t section = 0; section < sections.size(); ++section) {
    const Types types = types_of(layout, section);
    std::vector<Block> blocks = blocks_in(layout.blocks(genome), types);
    const std::uint32_t genes = blocks.empty() ? 0 : blocks.back().first + blocks.back().count;
    sections[section].genes.assign(gene, gene + genes);
    if (!types.are_fixed) sections[section].blocks = std::move(blocks);
    gene += genes;
  }
  return sections;
}

Genome join(const std::vector<Genome>& sections, const Layout& layout) {
  Genome genome;
  const bool is_fixed = layout.is_fixed();
  for (std::uint32_t section = 0; section < sections.size(); ++section) {
    const Types types = types_of(layout, section);
    const std::vector<Block> blocks =
        types.are_fixed ? blocks_in(layout.first_blocks, types) : sections[section].blocks;
    if (!is_fixed) append_blocks(genome.blocks, blocks, types.first, static_cast<std::uint32_t>(genome.size()));
    genome.genes.insert(genome.genes.end(), sections[section].begin(), sections[section].end());
  }
  return genome;
}

Genome part_of(const Genome& genome, const Layout& whole, const SectionIndices& which, const Layout& part) {
  if (which.size() == whole.sections.size()) return genome;
  std::vector<Genome> all = split(genome, whole), some;
  for (const std::uint32_t section : which) some.push_back(std::move(all.at(section)));
  return join(some, part);
}

void put_back(Genome& genome, const Layout& whole, const SectionIndices& which, Genome changed, const Layout& part) {
  if (which.size() == whole.sections.size()) {
    genome = std::move(changed);
    return;
  }
  std::vector<Genome> all = split(genome, whole), some = split(changed, part);
  for (std::size_t i = 0; i < which.size(); ++i) all.at(which[i]) = std::move(some[i]);
  genome = join(all, whole);
}

}  // namespace evodevo
