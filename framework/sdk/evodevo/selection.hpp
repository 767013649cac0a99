// Selection: who breeds, who stays.
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

/// One row of the table that selection works on. The scores are finite and oriented so that greater is better; they
/// exist only where the evaluation ended `ok`.
struct Candidate {
  std::span<const double> scores;           ///< one per objective; empty unless `ok`
  std::uint32_t age = 0;                    ///< of its oldest genes, generations
  std::optional<std::uint32_t> challenges;  ///< the row of the parent whose place it may take

  bool ok() const { return !scores.empty(); }
};

/// Rows are in the order of birth. The result must not depend on that order other than to break exact ties. No two
/// rows are copies of each other, equal in their genes and in all scores: the host keeps one of them, the youngest.
class Selection : public Operator {
 public:
  static constexpr std::string_view kind = "selection";

  /// `count` pairs of rows: the parent whose copy is varied, and its mate for crossover.
  virtual std::vector<std::pair<std::uint32_t, std::uint32_t>> parents(std::span<const Candidate> rows,
                                                                       std::uint32_t count, Rng& rng) const = 0;
  /// At most `population` different rows that live on.
  virtual std::vector<std::uint32_t> survivors(std::span<const Candidate> rows, std::uint32_t population,
                                               Rng& rng) const = 0;
};

}  // namespace evodevo
