// The table that selection operators see.
#pragma once

#include <vector>

#include "archive/population.hpp"

namespace evodevo {

inline const SelectionMemory no_memory;

/// What a selection operator sees of individuals, with the numbers that its rows refer to. Row i belongs to
/// `individuals[i]`. Ages are those that the individuals have in `generation`. An individual that was born in
/// `generation` challenges its parent, if the parent is in the table. Individuals, experiment and memory must outlive
/// this object.
class SelectionTable {
 public:
  SelectionTable(const std::vector<Individual>& individuals, const Experiment& experiment, std::uint32_t generation,
                 const SelectionMemory& memory = no_memory);
  SelectionTable(const SelectionTable&) = delete;  // because the rows refer to values_
  SelectionTable& operator=(const SelectionTable&) = delete;

  const SelectionContext& context() const { return context_; }
  std::span<const Candidate> rows() const { return rows_; }

  /// The numbers of one row.
  struct Values {
    std::vector<double> scores, cases, descriptors;
  };

 private:
  std::vector<Objective> descriptors_;
  std::vector<Values> values_;
  std::vector<Candidate> rows_;
  SelectionContext context_;
};

/// Returns the Pareto layer of each individual in the objectives and in youth, in the order of `individuals`. The front
/// consists of the individuals in layer 0 whose status is `ok`.
std::vector<std::uint32_t> layers(const std::vector<Individual>& individuals, const Experiment& experiment,
                                  std::uint32_t generation);

/// Returns the sum of the constraints of an individual that are above 0; 0 if its status is `ok`, and infinity if the
/// evaluation failed before the constraints were known.
double violation(const Result& result, const Experiment& experiment);

}  // namespace evodevo
