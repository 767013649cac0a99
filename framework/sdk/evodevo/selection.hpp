// Selection operators: they choose the parents of the next generation, and the individuals that survive.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "evodevo/operator.hpp"
#include "evodevo/rng.hpp"

namespace evodevo {

/// One individual, as a row of the table that a selection operator works on.
struct Candidate {
  std::span<const double> scores;  ///< finite scores, one for each objective, greater is better; empty unless ok()
  std::uint32_t age = 0;           ///< number of generations since the individual's oldest genes were drawn
  std::optional<std::uint32_t> challenges;  ///< row of the parent that this individual may replace, if there is one

  /// Returns whether the individual's evaluation ended `ok`.
  bool ok() const { return !scores.empty(); }
};

/// Rows are in the order of birth. The result must not depend on that order, except to break exact ties. No two rows
/// are equal in all genes and in all scores: of such individuals, the host keeps only the youngest.
class Selection : public Operator {
 public:
  static constexpr std::string_view kind = "selection";

  /// Returns `count` pairs of rows. In each pair, the first row is the parent, whose copy is varied, and the second row
  /// is its mate for crossover.
  virtual std::vector<std::pair<std::uint32_t, std::uint32_t>> parents(std::span<const Candidate> rows,
                                                                       std::uint32_t count, Rng& rng) const = 0;
  /// Returns the rows of the individuals that survive: at least one and at most `population` different rows.
  virtual std::vector<std::uint32_t> survivors(std::span<const Candidate> rows, std::uint32_t population,
                                               Rng& rng) const = 0;
};

}  // namespace evodevo
