// Breeding: makes random individuals, and children of a population.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "archive/population.hpp"

namespace evodevo {

/// Returns the genome of an individual without ancestors. `stream(section)` gives the random numbers of each section.
/// Throws std::runtime_error that names an operator whose genes its layout does not allow.
Genome first_genome(const Experiment& experiment, const std::function<Rng(std::uint32_t)>& stream,
                    CallSubject subject = {});

/// Makes the `count` newborns of a generation, with ids from `first_id`: first the immigrants, whose genomes are those
/// of the migrants, then children of the population, and as many random individuals as the experiment asks for.
/// `remembered` is what the selection operators remember; if one of them makes the children, it may replace its memory
/// there, and its notes about them are added. Null: they remember nothing, and notes are lost. Migrants with genes that
/// an individual of the population or an earlier immigrant has are left out.
///
/// Children come from the experiment's variation. If the population is empty, all newborns are random individuals. A
/// newborn that is genetically equal to a member of the population or to an earlier newborn is made again with other
/// random numbers, at most 16 times; if it is equal even then, it is a clone. If the selection operator makes the
/// children itself, they stay as they are, and it also makes those of an empty population.
///
/// The result does not depend on `workers`, the threads that make the newborns if they are many; null: this thread
/// makes them all.
std::vector<Individual> breed(const Experiment& experiment, const std::vector<Individual>& population,
                              std::uint32_t generation, std::uint32_t first_id, std::size_t count,
                              Remembered* remembered = nullptr, Workers* workers = nullptr,
                              std::span<const Migrant> migrants = {});

/// Makes a child of each couple, which are indices into the population, by the experiment's variation, as breed() does.
/// The experiment must have variation (Experiment::makes_children() is false).
std::vector<Individual> children_of(const Experiment& experiment, const std::vector<Individual>& population,
                                    std::span<const Couple> couples, std::uint32_t generation, std::uint32_t first_id,
                                    Workers* workers = nullptr);

}  // namespace evodevo
