// Breeding: makes random individuals, and children of a population.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "evolution/population.hpp"

namespace evodevo {

/// The table that a selection operator works on, with the scores that its rows refer to. Row i belongs to
/// `individuals[i]`. Ages are those that the individuals have in `generation`. An individual that was born in
/// `generation` challenges its parent, if the parent is in the table.
class SelectionTable {
 public:
  SelectionTable(const std::vector<Individual>& individuals, const std::vector<Objective>& objectives,
                 std::uint32_t generation);
  SelectionTable(const SelectionTable&) = delete;  // because the rows refer to scores_
  SelectionTable& operator=(const SelectionTable&) = delete;
  std::span<const Candidate> rows() const { return rows_; }

 private:
  std::vector<std::vector<double>> scores_;  ///< greater is better
  std::vector<Candidate> rows_;
};

/// Returns the genome of an individual without ancestors. `stream(section)` gives the random numbers of each section.
/// Throws std::runtime_error that names an operator whose genes its layout does not allow.
Genome first_genome(const Experiment& experiment, const std::function<Rng(std::uint32_t)>& stream,
                    CallSubject subject = {});

/// Makes the `count` newborns of a generation, with ids from `first_id`: children of the population, and as many random
/// individuals as the experiment asks for. If the population is empty, all newborns are random individuals. A newborn
/// that is genetically equal to a member of the population or to an earlier newborn is made again with other random
/// numbers, at most 16 times; if it is equal even then, it is a clone. The result depends only on the arguments.
std::vector<Individual> breed(const Experiment& experiment, const std::vector<Individual>& population,
                              std::uint32_t generation, std::uint32_t first_id, std::size_t count);

}  // namespace evodevo
