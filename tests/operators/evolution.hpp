// A small evolution in memory, for tests of selection operators: genomes, scores and descriptors, but no bodies.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "evodevo/selection.hpp"
#include "evodevo/variation.hpp"
#include "support.hpp"

namespace evodevo::test {

/// One individual, with everything to which a candidate refers.
struct Individual {
  std::vector<double> scores = {};  ///< empty if the individual has failed
  std::vector<double> descriptors = {}, cases = {};
  Genome genome = {};
  std::uint32_t id = 0, age = 0;
  bool is_newborn = false;
  double violation = 0;
  std::vector<std::uint32_t> parents = {};       ///< ids
  std::optional<std::uint32_t> challenges = {};  ///< row
  std::map<std::string, double> notes = {};
};

/// The table of a selection operator.
struct Table {
  std::vector<Individual> rows = {};
  std::vector<Objective> descriptors = {};
  Layout layout = {};
  SelectionMemory memory = {};

  /// Calls `use` with what the operator sees.
  template <class Use>
  auto see(const Use& use) const {
    std::vector<Candidate> candidates;
    for (const Individual& one : rows) {
      Candidate& row = candidates.emplace_back();
      row.scores = one.scores;
      row.age = one.age;
      row.challenges = one.challenges;
      row.violation = one.violation;
      row.cases = one.cases;
      row.descriptors = one.descriptors;
      row.id = one.id;
      row.is_newborn = one.is_newborn;
      row.parents = one.parents;
      row.genome = &one.genome;
    }
    const std::size_t scores = rows.empty() ? 1 : rows.front().scores.size();
    const std::size_t tests = rows.empty() ? 0 : rows.front().cases.size();
    const std::vector<Objective> objectives(scores, Objective{"score", "1"});
    const std::vector<Case> cases(tests);
    return use(SelectionContext{candidates, objectives, descriptors, cases, layout, 1, memory});
  }

  Survival survivors(const Selection& selection, std::uint32_t population, std::uint64_t seed = 1) const {
    Rng rng = stream(seed);
    return see([&](const SelectionContext& context) { return selection.survivors(context, population, rng); });
  }
  std::vector<Couple> parents(const Selection& selection, std::uint32_t count, std::uint64_t seed = 1) const {
    Rng rng = stream(seed);
    return see([&](const SelectionContext& context) { return selection.parents(context, count, rng); });
  }
  std::vector<Child> children(const Selection& selection, std::uint32_t count, std::uint64_t seed = 1) const {
    Rng rng = stream(seed);
    return see([&](const SelectionContext& context) { return selection.children(context, count, rng).children; });
  }

  /// Keeps the survivors, notes what is to be noted, and remembers.
  void keep(const Selection& selection, const Survival& survival) {
    const auto titles = selection.notes();
    for (const Note& note : survival.notes) rows.at(note.row).notes[titles.at(note.title).name] = note.value;
    std::vector<Individual> living;
    for (const std::uint32_t row : survival.rows) {
      living.push_back(rows.at(row));
      living.back().is_newborn = false;
      living.back().challenges.reset();
      ++living.back().age;
    }
    std::sort(living.begin(), living.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
    rows = std::move(living);
    if (survival.memory) memory = *survival.memory;
  }
};

/// A layout of `count` real genes.
inline Layout real_genes(std::uint32_t count, float low, float high) {
  Layout layout;
  layout.add_block(count, {low, high});
  return layout;
}

/// Evolves a table with a selection. Operators that make no children get those of simulated binary crossover, in which
/// on average one gene takes a normal step.
class Evolution {
 public:
  using Evaluate = std::function<void(Individual&)>;

  Evolution(const Selection& selection, const Layout& layout, Evaluate evaluate, std::uint64_t seed)
      : selection_(selection), evaluate_(std::move(evaluate)), seed_(seed) {
    table.layout = layout;
  }

  /// One generation.
  void step(std::uint32_t population, std::uint32_t children) {
    ++generation_;
    Rng rng = stream(seed_ * 100'000 + generation_);
    for (const Child& child : bred(children, rng)) {
      Individual newborn;
      newborn.genome = child.genome;
      newborn.id = next_id_++;
      newborn.is_newborn = true;
      for (const std::uint32_t parent : child.parents) newborn.parents.push_back(table.rows.at(parent).id);
      if (!child.parents.empty()) newborn.challenges = child.parents.front();
      evaluate_(newborn);
      newborns_.push_back(std::move(newborn));
    }
    for (Individual& newborn : newborns_) table.rows.push_back(std::move(newborn));
    newborns_.clear();
    table.keep(selection_, table.survivors(selection_, population, seed_ * 100'000 + generation_));
  }
  void run(int generations, std::uint32_t population, std::uint32_t children) {
    for (int i = 0; i < generations; ++i) step(population, children);
  }

  /// The best first score in the population.
  double best() const {
    double best = -std::numeric_limits<double>::infinity();
    for (const Individual& one : table.rows)
      if (!one.scores.empty()) best = std::max(best, one.scores[0]);
    return best;
  }

  Table table;

 private:
  std::vector<Child> bred(std::uint32_t count, Rng& rng) const {
    if (selection_.overrides.children)
      return table.see(
          [&](const SelectionContext& context) { return selection_.children(context, count, rng).children; });
    std::vector<Child> children;
    if (table.rows.empty()) {
      for (std::uint32_t i = 0; i < count; ++i) children.push_back({random_genome(table.layout, rng)});
      return children;
    }
    const auto couples =
        table.see([&](const SelectionContext& context) { return selection_.parents(context, count, rng); });
    for (const auto& [parent, mate] : couples) {
      Genome genome = crossover_->cross({table.rows[parent].genome, table.rows[mate].genome}, {table.layout}, rng);
      for (std::size_t gene = 0; gene < genome.size(); ++gene) {
        const GeneSpec& spec = table.layout.gene(genome, gene);
        if (!rng.chance(1.0 / static_cast<double>(genome.size()))) continue;
        const double step = 0.1 * (double{spec.high} - spec.low) * rng.normal();
        genome[gene] = std::clamp(genome[gene] + static_cast<float>(step), spec.low, spec.high);
      }
      children.push_back({std::move(genome), {parent, mate}});
    }
    return children;
  }

  const Selection& selection_;
  Evaluate evaluate_;
  std::uint64_t seed_;
  std::uint32_t generation_ = 0, next_id_ = 0;
  std::vector<Individual> newborns_;
  std::unique_ptr<Crossover> crossover_ = make<Crossover>("sbx", "index = 15");
};

}  // namespace evodevo::test
