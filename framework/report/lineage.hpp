// Where individuals come from: their ancestors, and the blocks of their genomes that came and went on the way.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "archive/archive.hpp"

namespace evodevo {

/// Returns an individual, its parent, the parent's parent, and so on, back to a random individual. Mates are left out.
std::vector<ArchivedIndividual> ancestry(const Archive& archive, std::uint32_t id);

/// Returns the individuals with these ids and all their ancestors by first parents, in the order of birth, as a list of
/// {"individual", "generation", "parents", "made_by", "value"}; the value is the first objective, or null without a
/// fitness. By their first parents they form trees, the roots of which are random individuals.
nlohmann::ordered_json lineage_json(const Archive& archive, const std::vector<std::uint32_t>& ids);

/// The blocks of one type that only one of two genomes has.
struct BlockChange {
  std::uint32_t type = 0;
  std::vector<BlockId> came;  ///< ids that only the child has, in the order of its blocks
  std::vector<BlockId> went;  ///< ids that only the parent has, in the order of its blocks
};
/// Returns the types of blocks that came or went from a parent to its child; none if no blocks come and go.
std::vector<BlockChange> block_changes(const Genome& parent, const Genome& child, const Layout& layout);
/// Returns a text such as ": +1 node, +2 -1 link", or an empty text if there are no changes.
std::string changes_text(const std::vector<BlockChange>& changes, const Layout& layout);

/// Returns the changes from each ancestor of a line to the next, with the ids as in genes_json(); an empty list if no
/// blocks came or went.
nlohmann::ordered_json line_changes_json(const std::vector<ArchivedIndividual>& line, const Layout& layout);

}  // namespace evodevo
