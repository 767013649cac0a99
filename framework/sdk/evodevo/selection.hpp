// Selection operators: they choose the parents of the next generation, and the individuals that survive. They may also
// make the children themselves, and remember what outlives a generation.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "evodevo/body.hpp"
#include "evodevo/fitness.hpp"
#include "evodevo/genome.hpp"
#include "evodevo/operator.hpp"
#include "evodevo/rng.hpp"

namespace evodevo {

/// One individual, as a row of the table that a selection operator works on.
struct Candidate {
  std::span<const double> scores;  ///< finite scores, one for each objective, greater is better; empty unless ok()
  std::uint32_t age = 0;           ///< number of generations since the individual's oldest genes were drawn or sampled
  std::optional<std::uint32_t> challenges = {};  ///< row of the parent that this individual may replace, if any
  /// How far the individual is from feasible: the sum of its constraints that are above 0, each in its unit; 0 if there
  /// are none, and infinity if the evaluation failed for another reason. Smaller is better.
  double violation = 0;
  std::span<const double> cases = {};        ///< finite scores, one for each of SelectionContext::cases, greater is
                                             ///< better; empty unless ok()
  std::span<const double> descriptors = {};  ///< finite, one for each of SelectionContext::descriptors, in their units;
                                             ///< empty unless ok()
  std::uint32_t id = 0;                      ///< number of the individual in the run, in the order of birth
  Status status = Status::ok;                ///< `invalid` if it violates a constraint; see Status
  bool is_newborn = false;                   ///< whether it was born in this generation
  std::span<const std::uint32_t> parents = {};  ///< ids of its parent and mate, as far as it has them
  const Genome* genome = nullptr;               ///< of SelectionContext::layout

  /// Returns whether the individual's evaluation ended `ok`.
  bool ok() const { return !scores.empty(); }
};

/// What one number of Candidate::cases is: an objective in one repeat of one scenario, combined over the lives of the
/// individual. An objective that is not scored in scenarios is one case.
struct Case {
  std::uint32_t objective = 0;     ///< index into SelectionContext::objectives
  std::string_view scenario = {};  ///< name of the scenario; empty: none
  std::uint32_t repeat = 0;        ///< from 0
};

/// What a selection operator sees.
struct SelectionContext {
  std::span<const Candidate> rows;
  std::span<const Objective> objectives;   ///< names and units of the scores, which are greater the better they are
  std::span<const Objective> descriptors;  ///< names, units and ranges; a value may lie outside of its range
  std::span<const Case> cases;
  const Layout& layout;          ///< of the rows' genomes
  std::uint32_t generation = 0;  ///< the generation to which the newborns belong, from 0
  /// What survive() returned as memory in the generation before; empty in the first generation, and for an operator
  /// that chooses parents alone.
  std::span<const std::byte> memory = {};
};

/// The name and unit of a number that a selection operator notes about individuals, such as their novelty.
struct NoteTitle {
  std::string name;
  std::string unit = "1";
  bool is_label = false;  ///< whether the number names a group, such as a cell or a species, and measures nothing
};

/// A number that a selection operator notes about an individual: at most one of each title in a generation. It holds
/// until the operator notes another one of that title about the individual. The archive keeps all of them.
struct Note {
  std::uint32_t row = 0;
  std::uint32_t title = 0;  ///< index into Selection::notes()
  double value = 0;         ///< finite
};

/// The choice of survivors.
struct Survival {
  std::vector<std::uint32_t> rows;  ///< of the survivors: at least one, and at most `population` different rows
  std::vector<std::byte> memory =
      {};  ///< given back in the next generation; helpers/selection/memory.hpp writes and reads it
  std::vector<Note> notes = {};  ///< of any rows
};

/// A child that a selection operator has made.
struct Child {
  Genome genome;
  /// Rows of its parents, at most two. The child may replace the first. The oldest genes of a child are those of its
  /// parents; if it has none, its age counts from the generation in which it was sampled.
  std::vector<std::uint32_t> parents = {};
};

/// An operator overrides parents() and survivors(), which see the rows alone, or instead of one of them its counterpart
/// that sees the whole context: couples() and survive(). Traits::chooses_parents and Traits::chooses_survivors tell if
/// it does only one of the two. An operator with Traits::makes_children overrides children() instead of parents().
///
/// Rows are in the order of birth. The result must not depend on that order, except to break exact ties. No two rows
/// are equal in all genes and in all scores: of such individuals, the host keeps only the youngest. But it keeps all
/// if one operator makes the children and also chooses the survivors.
class Selection : public Operator {
 public:
  static constexpr std::string_view kind = "selection";

  /// Returns `count` pairs of rows. In each pair, the first row is the parent, whose copy is varied, and the second row
  /// is its mate for crossover.
  virtual std::vector<std::pair<std::uint32_t, std::uint32_t>> parents([[maybe_unused]] std::span<const Candidate> rows,
                                                                       [[maybe_unused]] std::uint32_t count,
                                                                       [[maybe_unused]] Rng& rng) const {
    throw std::logic_error("chooses no parents; override parents() or couples(), or set Traits::chooses_parents");
  }
  /// Returns the rows of the individuals that survive: at least one and at most `population` different rows.
  virtual std::vector<std::uint32_t> survivors([[maybe_unused]] std::span<const Candidate> rows,
                                               [[maybe_unused]] std::uint32_t population,
                                               [[maybe_unused]] Rng& rng) const {
    throw std::logic_error("chooses no survivors; override survivors() or survive(), or set Traits::chooses_survivors");
  }

  /// Does what parents() does, and sees the whole context.
  virtual std::vector<std::pair<std::uint32_t, std::uint32_t>> couples(const SelectionContext& context,
                                                                       std::uint32_t count, Rng& rng) const {
    return parents(context.rows, count, rng);
  }
  /// Chooses the survivors, and says what is to be remembered and noted. The memory must depend on the arguments alone.
  virtual Survival survive(const SelectionContext& context, std::uint32_t population, Rng& rng) const {
    return {survivors(context.rows, population, rng)};
  }
  /// Makes `count` children whose genomes the layout allows, for an operator with Traits::makes_children. It also makes
  /// the first generation, when there are neither rows nor memory. The last generation of a run may be smaller than the
  /// others.
  virtual std::vector<Child> children([[maybe_unused]] const SelectionContext& context,
                                      [[maybe_unused]] std::uint32_t count, [[maybe_unused]] Rng& rng) const {
    throw std::logic_error("makes no children; override children(), or do not set Traits::makes_children");
  }
  /// Declares the numbers that survive() may note.
  virtual std::vector<NoteTitle> notes() const { return {}; }
};

}  // namespace evodevo
