// New individuals: random ones, and children of a population.
#pragma once

#include <string>
#include <vector>

#include "evolution/population.hpp"

namespace evodevo {

/// The table that selection works on, with the scores that its rows refer to. Rows are in the order of `individuals`,
/// ages are those in `generation`; a newborn of it challenges its first parent where that has a row.
class SelectionTable {
 public:
  SelectionTable(const std::vector<Individual>& individuals, const std::vector<Objective>& objectives,
                 std::uint32_t generation);
  SelectionTable(const SelectionTable&) = delete;  // rows refer to the scores
  SelectionTable& operator=(const SelectionTable&) = delete;
  std::span<const Candidate> rows() const { return rows_; }

 private:
  std::vector<std::vector<double>> scores_;  ///< greater is better
  std::vector<Candidate> rows_;
};

/// What the layout does not allow in a genome; empty where it is one of its.
std::string genome_fault(const Genome& genome, const Layout& layout);

/// The `count` newborns of a generation, ids from `first_id`: as many random_individuals as the experiment asks for,
/// all of them where there is no population, and children. A newborn that is genetically equal to a member of the
/// population or to an earlier newborn is made anew, at most 16 times; only where that does not help is it a clone.
/// Nothing but the arguments and the experiment's seed decides.
std::vector<Individual> breed(const Experiment& experiment, const std::vector<Individual>& population,
                              std::uint32_t generation, std::uint32_t first_id, std::size_t count);

}  // namespace evodevo
