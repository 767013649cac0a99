// Tables of individuals, made up at random, for selection operators to choose from.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "conformance/trials.hpp"
#include "evolution/selection_table.hpp"

namespace evodevo::conformance {

/// What a selection operator sees of a population and its newborns, with all that the rows refer to.
class SampleTable {
 public:
  /// A random table in which all scores differ, for an operator with its traits. The rows of the second half are
  /// newborns, most of which are children of rows of the first half. `failed` rows, chosen at random, have no scores;
  /// half of them violate a constraint. If `tied`, numbers have few different values; if the operator gets copies, too,
  /// some rows differ in nothing but their ids.
  SampleTable(const Subject& subject, const Selection& op, std::uint64_t seed, std::uint32_t input, std::size_t rows,
              std::size_t failed, bool tied = false);
  /// The same table in another order: its row i is row order[i] of the other table.
  SampleTable(const SampleTable& other, const std::vector<std::uint32_t>& order);
  SampleTable(const SampleTable&) = delete;  // because the rows refer to the lists
  SampleTable& operator=(const SampleTable&) = delete;

  /// What the operator sees if it remembers `memory`.
  SelectionContext context(const SelectionMemory& memory = no_memory) const;
  /// What the operator sees before the first generation.
  SelectionContext empty_context() const;

  const std::vector<Candidate>& rows() const { return rows_; }
  /// All numbers of the table.
  Numbers numbers() const;

 private:
  /// What one row refers to.
  struct Lists {
    Numbers scores, cases, descriptors;
    std::vector<std::uint32_t> parents;
    Genome genome;
  };
  void set_titles(const Subject& subject, const Selection& op, std::uint32_t input);
  void set_rows(const std::vector<std::uint8_t>& fails, bool tied, Rng& rng);
  void refer();

  std::vector<Objective> objectives_, descriptors_;
  std::vector<evodevo::Case> cases_;
  Layout layout_;
  std::vector<Lists> lists_;
  std::vector<Candidate> rows_;
};

/// Calls the functions that a selection operator overrides, and returns all results as numbers.
Numbers try_selection(const Subject& subject, const Selection& op, std::uint64_t seed, std::uint32_t input);

Numbers numbers_of(const SelectionMemory& memory);
Numbers numbers_of(const Survival& survival);
Numbers numbers_of(const Offspring& offspring);

/// Replaces what an operator remembers, if it returns something.
inline void remember(SelectionMemory& memory, const std::optional<SelectionMemory>& next) {
  if (next) memory = *next;
}

/// These functions return what the operator returns, and throw Violation if the host would not accept it.
Survival sound_survival(const Selection& op, const SelectionContext& context, std::uint32_t population, Rng& rng);
Offspring sound_offspring(const Selection& op, const SelectionContext& context, std::uint32_t count, Rng& rng);
std::vector<Couple> sound_couples(const Selection& op, const SelectionContext& context, std::uint32_t count, Rng& rng);

}  // namespace evodevo::conformance
