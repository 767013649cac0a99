// Checks of what selection operators return. All functions throw std::runtime_error, whose message begins with a verb,
// so that the host can name the operator before it.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "evodevo/selection.hpp"

namespace evodevo {

/// What an operator says that it notes and remembers.
struct Declared {
  std::vector<NoteTitle> notes;     ///< as Selection::notes()
  std::vector<std::string> memory;  ///< as Selection::memory()
};

/// Checks that a memory has the lists that an operator declares, or none, that their numbers are finite, and that they
/// are no more than an archive keeps: 128 MiB.
void check_memory(const SelectionMemory& memory, const std::vector<std::string>& declared);

/// Checks that `count` couples are rows of the table.
void check_couples(std::span<const Couple> couples, const SelectionContext& context, std::uint32_t count);

/// Checks that the survivors are 1 to `population` different rows of the table, and that notes and memory are those
/// that the operator declares.
void check_survival(const Survival& survival, const Declared& declared, const SelectionContext& context,
                    std::uint32_t population);

/// Checks that there are `count` children whose genomes the layout allows and whose parents are rows of the table, and
/// that notes and memory are those that the operator declares.
void check_offspring(const Offspring& offspring, const Declared& declared, const SelectionContext& context,
                     std::uint32_t count);

/// Checks that the layout allows the genome.
void check_genome(const Genome& genome, const Layout& layout);

}  // namespace evodevo
