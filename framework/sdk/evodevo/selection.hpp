// Selection operators: they choose the parents of the next generation, or make the children themselves, and choose the
// individuals that survive. They may remember what outlives a generation.
#pragma once

#include <cstdint>
#include <map>
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

/// What a selection operator remembers from one generation to the next: lists of finite numbers, by name.
struct SelectionMemory {
  std::uint32_t version = 1;  ///< of what the operator writes; raised when the lists change their meaning
  std::map<std::string, std::vector<double>> lists = {};  ///< exactly those that Selection::memory() declares, or none

  bool empty() const { return lists.empty(); }
  /// Returns a list of a memory of this version. Throws std::runtime_error if the memory has another version, which an
  /// operator that knows it may translate instead, or no such list.
  const std::vector<double>& list(const std::string& name, std::uint32_t of_version = 1) const {
    if (version != of_version)
      fail("has version " + std::to_string(version) + ", expected " + std::to_string(of_version));
    const auto found = lists.find(name);
    if (found == lists.end()) fail("has no list \"" + name + "\"");
    return found->second;
  }
  /// Throws std::runtime_error: the memory is not what the operator writes. `what` says why, after "memory ".
  [[noreturn]] static void fail(const std::string& what) {
    throw std::runtime_error("memory " + what + "; it was written by another version of this operator");
  }

  bool operator==(const SelectionMemory&) const = default;
};

/// What a selection operator sees.
struct SelectionContext {
  std::span<const Candidate> rows;
  std::span<const Objective> objectives;   ///< names and units of the scores, which are greater the better they are
  std::span<const Objective> descriptors;  ///< names, units and ranges; a value may lie outside of its range
  std::span<const Case> cases;
  const Layout& layout;           ///< of the rows' genomes
  std::uint32_t generation = 0;   ///< the generation to which the newborns belong, from 0
  const SelectionMemory& memory;  ///< what this operator returned last; empty if it has returned none
};

/// The name and unit of a number that a selection operator notes about individuals, such as their novelty.
struct NoteTitle {
  std::string name;
  std::string unit = "1";
  bool is_label = false;  ///< whether the number names a group, such as a cell or a species, and measures nothing
};

/// A number that a selection operator notes about an individual: at most one of each title in a call. It holds until
/// the operator notes another one of that title about the individual. The archive keeps the last one of each
/// generation.
struct Note {
  std::uint32_t row = 0;
  std::uint32_t title = 0;  ///< index into Selection::notes()
  double value = 0;         ///< finite
};

/// A number that a selection operator notes about a child that it has made; see Note.
struct ChildNote {
  std::uint32_t title = 0;  ///< index into Selection::notes()
  double value = 0;         ///< finite
};

/// A parent, whose copy is varied, and its mate for crossover: rows of the table.
struct Couple {
  std::uint32_t parent = 0, mate = 0;
};

/// The choice of survivors. A list of rows is one, without memory and notes.
struct Survival {
  Survival(std::vector<std::uint32_t> chosen = {}) : rows(std::move(chosen)) {}  // implicit, for `return rows;`

  std::vector<std::uint32_t> rows;  ///< of the survivors: at least one, and at most `population` different rows
  std::optional<SelectionMemory> memory = {};  ///< replaces what the operator remembers; nothing: it keeps that
  std::vector<Note> notes = {};                ///< of any rows
};

/// A child that a selection operator has made.
struct Child {
  Genome genome;
  /// Rows of its parents, at most two. The child may replace the first. The oldest genes of a child are those of its
  /// parents; if it has none, its age counts from the generation in which it was sampled.
  std::vector<std::uint32_t> parents = {};
  std::vector<ChildNote> notes = {};
};

/// The children that a selection operator has made. A list of children is one, without memory.
struct Offspring {
  Offspring(std::vector<Child> made = {}) : children(std::move(made)) {}  // implicit, for `return children;`

  std::vector<Child> children;
  std::optional<SelectionMemory> memory = {};  ///< replaces what the operator remembers; nothing: it keeps that
};

/// Which functions of Selection an operator overrides.
struct Overrides {
  bool parents = false, survivors = false, children = false;
};

/// An operator overrides those of the first three functions that it is for: either parents() or children(), or
/// survivors(), or one of the first two and survivors(). operator_entry() finds out which. What one operator leaves
/// out, another operator of the experiment does; without children(), the experiment's variation makes the children of
/// the couples.
///
/// The result must not depend on the order of the rows: ties are broken by Candidate::id. No two rows are equal in all
/// genes and in all scores: of such individuals, the host keeps only the youngest. But it keeps all if one operator
/// makes the children and also chooses the survivors.
class Selection : public Operator {
 public:
  static constexpr std::string_view kind = "selection";

  /// Returns `count` couples.
  virtual std::vector<Couple> parents([[maybe_unused]] const SelectionContext& context,
                                      [[maybe_unused]] std::uint32_t count, [[maybe_unused]] Rng& rng) const {
    throw std::logic_error("chooses no parents; override parents() or children()");
  }
  /// Chooses the individuals that survive: at least one and at most `population` different rows. The memory must depend
  /// on the arguments alone.
  virtual Survival survivors([[maybe_unused]] const SelectionContext& context,
                             [[maybe_unused]] std::uint32_t population, [[maybe_unused]] Rng& rng) const {
    throw std::logic_error("chooses no survivors; override survivors()");
  }
  /// Makes `count` children whose genomes the layout allows; the experiment then has neither mutation nor crossover. It
  /// also makes the first generation, when there are neither rows nor memory. The last generation of a run may be
  /// smaller than the others. The memory must depend on the arguments alone; survivors() sees it in the same
  /// generation.
  virtual Offspring children([[maybe_unused]] const SelectionContext& context, [[maybe_unused]] std::uint32_t count,
                             [[maybe_unused]] Rng& rng) const {
    throw std::logic_error("makes no children; override children()");
  }
  /// Declares the numbers that survivors() and children() may note.
  virtual std::vector<NoteTitle> notes() const { return {}; }
  /// Declares the names of the lists of numbers that the operator remembers. An operator that remembers something and
  /// overrides survivors() cannot choose parents where another one chooses the survivors.
  virtual std::vector<std::string> memory() const { return {}; }

  Overrides overrides = {};  ///< set by operator_entry()
};

}  // namespace evodevo
