#include "report/lineage.hpp"

#include <algorithm>
#include <iterator>
#include <map>

#include "base/text.hpp"
#include "report/genes_json.hpp"

namespace evodevo {
namespace {

using Json = nlohmann::ordered_json;

/// Returns the ids of the blocks of one type.
std::vector<BlockId> ids_of(const Genome& genome, const Layout& layout, std::uint32_t type) {
  std::vector<BlockId> ids;
  for (const Block& block : layout.blocks(genome))
    if (block.type == type) ids.push_back(block.id);
  return ids;
}

/// Returns the ids in `these` that are not in `others`, in their order.
std::vector<BlockId> without(const std::vector<BlockId>& these, std::vector<BlockId> others) {
  std::sort(others.begin(), others.end());
  std::vector<BlockId> left;
  std::copy_if(these.begin(), these.end(), std::back_inserter(left),
               [&](BlockId id) { return !std::binary_search(others.begin(), others.end(), id); });
  return left;
}

Json ids_json(const std::vector<BlockId>& ids) {
  Json list = Json::array();
  for (const BlockId id : ids) list.push_back(id_text(id));
  return list;
}

}  // namespace

std::vector<ArchivedIndividual> ancestry(const Archive& archive, std::uint32_t id) {
  std::vector<ArchivedIndividual> line;
  for (std::optional<std::uint32_t> next = id; next;) {
    line.push_back(archive.known_individual(*next));
    next = line.back().parents.empty() ? std::nullopt : std::optional(line.back().parents.front());
  }
  return line;
}

Json lineage_json(const Archive& archive, const std::vector<std::uint32_t>& ids) {
  std::map<std::uint32_t, ArchivedIndividual> all;
  for (const std::uint32_t id : ids)
    for (std::optional<std::uint32_t> next = id; next && !all.contains(*next);) {
      const auto& [known, one] = *all.try_emplace(*next, archive.known_individual(*next)).first;
      next = one.parents.empty() ? std::nullopt : std::optional(one.parents.front());
    }
  Json list = Json::array();
  for (const auto& [id, one] : all)
    list.push_back({{"individual", id},
                    {"generation", one.born},
                    {"parents", one.parents},
                    {"made_by", one.made_by},
                    {"value", one.result.status == Status::ok ? Json(one.result.objectives.front()) : Json(nullptr)}});
  return list;
}

std::vector<BlockChange> block_changes(const Genome& parent, const Genome& child, const Layout& layout) {
  std::vector<BlockChange> changes;
  if (layout.is_fixed()) return changes;
  for (std::uint32_t type = 0; type < layout.types.size(); ++type) {
    const std::vector<BlockId> before = ids_of(parent, layout, type), after = ids_of(child, layout, type);
    const BlockChange change{type, without(after, before), without(before, after)};
    if (!change.came.empty() || !change.went.empty()) changes.push_back(change);
  }
  return changes;
}

std::string changes_text(const std::vector<BlockChange>& changes, const Layout& layout) {
  std::vector<std::string> parts;
  for (const BlockChange& change : changes) {
    std::string text;
    if (!change.came.empty()) text += "+" + std::to_string(change.came.size()) + " ";
    if (!change.went.empty()) text += "-" + std::to_string(change.went.size()) + " ";
    parts.push_back(text + printable(layout.types[change.type].name));
  }
  return parts.empty() ? "" : ": " + joined(parts);
}

Json line_changes_json(const std::vector<ArchivedIndividual>& line, const Layout& layout) {
  Json list = Json::array();
  for (std::size_t i = 0; i + 1 < line.size(); ++i)
    for (const BlockChange& change : block_changes(line[i + 1].genome, line[i].genome, layout)) {
      const BlockType& type = layout.types[change.type];
      list.push_back({{"individual", line[i].id},
                      {"section", printable(layout.sections[type.section])},
                      {"type", printable(type.name)},
                      {"came", ids_json(change.came)},
                      {"went", ids_json(change.went)}});
    }
  return list;
}

}  // namespace evodevo
