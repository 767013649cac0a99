// The sections of genomes: how the layouts and the genes of several owners are joined, and taken apart again.
//
//   layouts of the owners ── add_section() ──► layout of whole genomes ── some_sections() ──► layout for an operator
//   whole genome ── split() ──► a genome for each section ── join() ──► whole genome, or a part for an operator
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "evodevo/genome.hpp"

namespace evodevo {

using SectionIndices = std::vector<std::uint32_t>;  ///< indices into Layout::sections, ascending

/// Appends a section to the layout of whole genomes, and returns its index. `section` is the layout that the owner
/// declares. Throws std::runtime_error with what is wrong with it.
std::uint32_t add_section(Layout& whole, const std::string& owner, const Layout& section);

/// Returns the layout of some sections of whole genomes. `own` is the one among them that belongs to the operator that
/// gets the layout, if any.
Layout some_sections(const Layout& whole, const SectionIndices& which, std::optional<std::uint32_t> own = std::nullopt);

/// Returns one genome for each section of a genome.
std::vector<Genome> split(const Genome& genome, const Layout& layout);
/// Returns the genome that consists of the given sections, one for each section of the layout.
Genome join(const std::vector<Genome>& sections, const Layout& layout);

/// Returns some sections of a genome of the layout `whole`, as a genome of the layout `part`.
Genome part_of(const Genome& genome, const Layout& whole, const SectionIndices& which, const Layout& part);
/// Replaces some sections of a genome of the layout `whole` by those of `changed`, a genome of the layout `part`.
void put_back(Genome& genome, const Layout& whole, const SectionIndices& which, Genome changed, const Layout& part);

/// Returns what is wrong with a layout that an operator declares, or an empty text if nothing is.
std::string layout_fault(const Layout& layout);
/// Returns what a layout does not allow in a genome, or an empty text if it is a genome of the layout.
std::string genome_fault(const Genome& genome, const Layout& layout);

}  // namespace evodevo
