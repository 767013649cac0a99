#include "archive/genes.hpp"

#include <bit>
#include <cstring>
#include <numeric>

#include "base/genome_sections.hpp"
#include "base/text.hpp"

namespace evodevo {
namespace {

constexpr std::uint32_t most = std::numeric_limits<std::uint32_t>::max();

/// One block as it is stored.
struct StoredBlock {
  std::uint32_t type, count;
  BlockId id;
};
static_assert(sizeof(StoredBlock) == 16 && std::endian::native == std::endian::little);

template <class Item>
std::vector<Item> items_in(const Statement& row, int column, const char* expected) {
  const std::string_view bytes = row.bytes(column);
  if (bytes.size() % sizeof(Item) != 0) row.refuse(column, expected);
  std::vector<Item> items(bytes.size() / sizeof(Item));
  if (!bytes.empty()) std::memcpy(items.data(), bytes.data(), bytes.size());
  return items;
}

void insert_types(const RunDatabase& run, const Layout& layout) {
  Statement insert(run, "block_types", "INSERT INTO block_types VALUES(?, ?, ?, ?, ?)");
  Statement insert_gene(run, "gene_types", "INSERT INTO gene_types VALUES(?, ?, ?, ?, ?, ?, ?)");
  Statement insert_option(run, "gene_options", "INSERT INTO gene_options VALUES(?, ?, ?, ?)");
  for (std::uint32_t t = 0; t < layout.types.size(); ++t) {
    const BlockType& type = layout.types[t];
    insert.execute(t, type.section, type.name, type.least, type.most);
    for (std::uint32_t g = 0; g < type.genes.size(); ++g) {
      const GeneSpec& gene = type.genes[g];
      insert_gene.execute(t, g, type.gene_names[g], double{gene.low}, double{gene.high}, gene.choices, gene.refers_to);
      const std::span<const std::string> options = type.options(g);
      for (std::uint32_t option = 0; option < options.size(); ++option)
        insert_option.execute(t, g, option, options[option]);
    }
  }
}

void read_types(const RunDatabase& run, Layout& layout) {
  Statement row(run, "block_types", "SELECT type, section, name, least, most FROM block_types ORDER BY type");
  Statement gene(
      run, "gene_types",
      "SELECT position, name, low, high, choices, refers_to FROM gene_types WHERE type = ? ORDER BY position");
  Statement option(run, "gene_options",
                   "SELECT option, name FROM gene_options WHERE type = ? AND position = ? ORDER BY option");
  const auto options_of = [&](std::uint32_t type, std::int64_t position) {
    std::vector<std::string> names;
    option.bind(type, position);
    while (option.step()) {
      const auto number = static_cast<std::int64_t>(names.size());
      option.integer(0, number, number);
      names.push_back(option.text(1));
    }
    return names;
  };
  for (std::uint32_t t = 0; row.step(); ++t) {
    row.integer(0, t, t);
    BlockType& type = layout.types.emplace_back();
    type.section = row.index(1, static_cast<std::uint32_t>(layout.sections.size() - 1));
    type.name = row.text(2);
    type.least = row.index(3);
    type.most = row.index(4);
    gene.bind(t);
    while (gene.step()) {
      const auto position = static_cast<std::int64_t>(type.genes.size());
      gene.integer(0, position, position);
      type.gene_names.push_back(gene.text(1));
      type.genes.push_back({static_cast<float>(gene.number(2)), static_cast<float>(gene.number(3)), gene.index(4),
                            gene.is_null(5) ? std::nullopt : std::optional(gene.index(5))});
      type.option_names.push_back(options_of(t, position));
    }
  }
}

}  // namespace

void insert_layout(const RunDatabase& run, const Layout& layout) {
  Statement insert(run, "sections", "INSERT INTO sections VALUES(?, ?)");
  for (std::uint32_t s = 0; s < layout.sections.size(); ++s) insert.execute(s, layout.sections[s]);
  insert_types(run, layout);
  Statement insert_block(run, "first_blocks", "INSERT INTO first_blocks VALUES(?, ?, ?, ?)");
  for (std::uint32_t b = 0; b < layout.first_blocks.size(); ++b) {
    const Block& block = layout.first_blocks[b];
    insert_block.execute(b, block.type, block.count, std::bit_cast<std::int64_t>(block.id));
  }
}

Layout read_layout(const RunDatabase& run) {
  Layout layout{.sections = {}};
  Statement section(run, "sections", "SELECT section, owner FROM sections ORDER BY section");
  while (section.step()) {
    const auto position = static_cast<std::int64_t>(layout.sections.size());
    section.integer(0, position, position);
    layout.sections.push_back(section.text(1));
  }
  if (layout.sections.empty()) run.refuse("there are no sections of genomes");
  read_types(run, layout);
  Statement block(run, "first_blocks", "SELECT block, type, genes, id FROM first_blocks ORDER BY block");
  std::uint32_t first = 0;
  while (block.step()) {
    const auto position = static_cast<std::int64_t>(layout.first_blocks.size());
    block.integer(0, position, position);
    const std::uint32_t count = block.index(2, most - first);
    const std::int64_t id =
        block.integer(3, std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::max());
    layout.first_blocks.push_back({block.index(1), first, count, std::bit_cast<BlockId>(id)});
    first += count;
  }
  if (const std::string fault = layout_fault(layout); !fault.empty()) run.refuse("the layout of genomes: " + fault);
  return layout;
}

std::string block_bytes(const Genome& genome, const Layout& layout) {
  std::string bytes;
  for (const Block& block : genome.blocks) {
    if (layout.is_fixed(layout.types[block.type].section)) continue;
    const StoredBlock stored{block.type, block.count, block.id};
    bytes.append(reinterpret_cast<const char*>(&stored), sizeof stored);
  }
  return bytes;
}

Genome read_genome(const Statement& row, int genes, int blocks, const Layout& layout) {
  Genome genome;
  genome.genes = items_in<float>(row, genes, "four bytes for each gene");
  if (layout.is_fixed()) {
    if (!row.is_null(blocks)) row.refuse(blocks, "no blocks, since those of all genomes are the same");
    return genome;
  }
  const auto stored = items_in<StoredBlock>(row, blocks, "16 bytes for each block");
  auto next = stored.begin();
  std::uint64_t first = 0;
  const auto add = [&](std::uint32_t type, std::uint32_t count, BlockId id) {
    genome.blocks.push_back({type, static_cast<std::uint32_t>(first), count, id});
    first += count;
    if (first > genome.size()) row.refuse(blocks, "blocks of no more genes than there are");
  };
  for (std::uint32_t section = 0; section < layout.sections.size(); ++section) {
    const auto is_here = [&](std::uint32_t type) { return layout.types[type].section == section; };
    if (layout.is_fixed(section)) {
      for (const Block& block : layout.first_blocks)
        if (is_here(block.type)) add(block.type, block.count, block.id);
      continue;
    }
    for (; next != stored.end() && next->type < layout.types.size() && is_here(next->type); ++next)
      add(next->type, next->count, next->id);
  }
  if (next != stored.end()) row.refuse(blocks, "blocks of known types, section by section");
  return genome;
}

}  // namespace evodevo
