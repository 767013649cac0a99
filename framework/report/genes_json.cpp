#include "report/genes_json.hpp"

#include <fmt/format.h>

#include "base/text.hpp"
#include "evodevo/blocks.hpp"

namespace evodevo {
namespace {

using Json = nlohmann::ordered_json;

Json value_json(const Genome& genome, const Layout& layout, const Block& block, std::uint32_t gene) {
  const GeneSpec& spec = layout.types[block.type].gene(gene);
  const float value = genome[block.first + gene];
  if (spec.is_reference()) return id_text(layout.blocks(genome)[target_of(genome, layout, block, gene)].id);
  if (spec.is_choice()) {
    const auto option = static_cast<std::int64_t>(value);
    const std::span<const std::string> names = layout.types[block.type].options(gene);
    if (!names.empty()) return printable(names[static_cast<std::size_t>(option)]);
    return option;
  }
  return value;
}

}  // namespace

std::string id_text(BlockId id) { return fmt::format("{:016x}", id); }

std::string gene_name(const BlockType& type, const Block& block, std::uint32_t gene) {
  const auto listed = static_cast<std::uint32_t>(type.gene_names.size());
  const bool repeats = block.count > listed && gene + 1 >= listed;  // the last one that is listed stands for the rest
  const std::string name = printable(type.gene_names[std::min(gene, listed - 1)]);
  if (!repeats) return name.empty() ? std::to_string(gene) : name;
  return (name.empty() ? "" : name + " ") + std::to_string(gene + 1 - listed);
}

Json genes_json(const Genome& genome, const Layout& layout) {
  Json sections = Json::array();
  for (const std::string& owner : layout.sections)
    sections.push_back({{"owner", printable(owner)}, {"blocks", Json::array()}});
  for (const Block& block : layout.blocks(genome)) {
    const BlockType& type = layout.types[block.type];
    Json genes = Json::object();
    for (std::uint32_t gene = 0; gene < block.count; ++gene)
      genes[gene_name(type, block, gene)] = value_json(genome, layout, block, gene);
    sections[type.section]["blocks"].push_back(
        {{"type", printable(type.name)}, {"id", id_text(block.id)}, {"genes", std::move(genes)}});
  }
  return sections;
}

}  // namespace evodevo
