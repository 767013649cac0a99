#include "conformance/tables.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "evolution/selection_checks.hpp"

namespace evodevo::conformance {
namespace {

constexpr std::uint32_t tests = 3;  ///< of each objective, in tables whose number is odd

Layout real_layout() {
  Layout layout;
  layout.add_block(7, {-1, 1});
  layout.add_block(3, {0, 0.25});
  return layout;
}

SampleGenomes genomes_for(const Subject& subject, const Selection& op, std::uint32_t input) {
  if (!op.traits().needs_real_genes || subject.use) return sample_genomes(subject, op, input);
  const Layout layout = real_layout();
  return {layout, [layout](Rng& rng) { return random_genome(layout, rng); }};
}

/// Returns what an operator returns. Throws Violation if the host's check of it throws.
template <class Result, class Check>
Result accepted(Result result, const Check& check) {
  try {
    check(result);
  } catch (const std::runtime_error& error) {
    throw Violation(std::string("it ") + error.what());
  }
  return result;
}

}  // namespace

void SampleTable::set_titles(const Subject& subject, const Selection& op, std::uint32_t input) {
  if (subject.use) {
    const Experiment& experiment = subject.use->experiment;
    objectives_ = experiment.objectives;
    cases_ = experiment.cases;
    for (const Objective& measure : experiment.measures)
      if (measure.role == Role::descriptor) descriptors_.push_back(measure);
    return;
  }
  const Traits traits = op.traits();
  for (std::uint32_t i = 0; i < std::max(traits.least_objectives, 1 + input % 2); ++i) {
    objectives_.push_back({"objective " + std::to_string(i), "m"});
    for (std::uint32_t test = 0; test < (input % 2 == 1 ? tests : 1); ++test)
      cases_.push_back({i, input % 2 == 1 ? "scenario" : "", test});
  }
  for (std::uint32_t i = 0; i < traits.least_descriptors; ++i)
    descriptors_.push_back({"descriptor " + std::to_string(i), "m", true, Role::descriptor, -1, 1});
}

SampleTable::SampleTable(const Subject& subject, const Selection& op, std::uint64_t seed, std::uint32_t input,
                         std::size_t rows, std::size_t failed, bool tied)
    : lists_(rows), rows_(rows) {
  Rng rng = stream(seed, input), gene_rng = stream(seed, input, 3);
  set_titles(subject, op, input);
  const SampleGenomes genomes = genomes_for(subject, op, input);
  layout_ = genomes.layout;
  const bool gets_copies = op.overrides.children && op.overrides.survivors;
  for (std::size_t i = 0; i < rows; ++i)
    lists_[i].genome = tied && gets_copies && i % 2 == 1 ? lists_[i - 1].genome : genomes.draw(gene_rng);
  std::vector<std::uint8_t> fails(rows, 0);
  std::fill_n(fails.begin(), failed, 1);
  rng.shuffle(fails);
  set_rows(fails, tied, rng);
  refer();
}

SampleTable::SampleTable(const SampleTable& other, const std::vector<std::uint32_t>& order)
    : objectives_(other.objectives_), descriptors_(other.descriptors_), cases_(other.cases_), layout_(other.layout_) {
  std::vector<std::uint32_t> position(order.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) position[order[i]] = i;
  for (const std::uint32_t row : order) {
    lists_.push_back(other.lists_[row]);
    rows_.push_back(other.rows_[row]);
    if (auto& challenged = rows_.back().challenges) challenged = position[*challenged];
  }
  refer();
}

void SampleTable::set_rows(const std::vector<std::uint8_t>& fails, bool tied, Rng& rng) {
  const auto draw = [&](std::size_t count, double low, double high) {
    Numbers numbers;
    for (std::size_t i = 0; i < count; ++i) {
      const double number = rng.uniform(low, high);
      numbers.push_back(tied ? std::round(number / high) * high : number);
    }
    return numbers;
  };
  constexpr std::array lost{Status::diverged, Status::artefact, Status::passive, Status::lucky};
  const auto half = static_cast<std::uint32_t>(rows_.size() / 2);
  for (std::uint32_t i = 0; i < rows_.size(); ++i) {
    Lists& lists = lists_[i];
    Candidate& row = rows_[i];
    row.id = 100 + i;
    row.age = rng.below(tied ? 2 : 6);
    row.is_newborn = i >= half;
    if (row.is_newborn && half > 0 && rng.chance(0.8)) {
      row.challenges = rng.below(half);
      lists.parents = {100 + *row.challenges};
    }
    const Numbers scores = draw(objectives_.size(), -5, 5);
    if (fails[i] != 0) {
      const bool is_infeasible = rng.chance(0.5);
      row.status = is_infeasible ? Status::invalid : lost[i % lost.size()];
      row.violation = is_infeasible ? draw(1, 0.1, 3).front() + 0.1 : std::numeric_limits<double>::infinity();
      continue;
    }
    lists.scores = scores;
    lists.descriptors = draw(descriptors_.size(), -1.2, 1.2);
    for (const evodevo::Case& one : cases_)
      lists.cases.push_back(one.scenario.empty() ? scores[one.objective] : draw(1, -5, 5).front());
  }
}

void SampleTable::refer() {
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    rows_[i].scores = lists_[i].scores;
    rows_[i].cases = lists_[i].cases;
    rows_[i].descriptors = lists_[i].descriptors;
    rows_[i].parents = lists_[i].parents;
    rows_[i].genome = &lists_[i].genome;
  }
}

SelectionContext SampleTable::context(const SelectionMemory& memory) const {
  return {rows_, objectives_, descriptors_, cases_, layout_, 6, memory};
}

SelectionContext SampleTable::empty_context() const {
  return {{}, objectives_, descriptors_, cases_, layout_, 0, no_memory};
}

Numbers SampleTable::numbers() const {
  Numbers numbers;
  for (const Lists& lists : lists_) {
    for (const Numbers* list : {&lists.scores, &lists.cases, &lists.descriptors}) append(numbers, *list);
    append(numbers, conformance::numbers_of(lists.genome));
  }
  return numbers;
}

Numbers numbers_of(const SelectionMemory& memory) {
  Numbers numbers{double(memory.version)};
  for (const auto& [name, list] : memory.lists) {
    numbers.push_back(static_cast<double>(list.size()));
    append(numbers, list);
  }
  return numbers;
}

Numbers numbers_of(const Survival& survival) {
  Numbers numbers(survival.rows.begin(), survival.rows.end());
  if (survival.memory) append(numbers, numbers_of(*survival.memory));
  for (const Note& note : survival.notes) append(numbers, {double(note.row), double(note.title), note.value});
  return numbers;
}

Numbers numbers_of(const Offspring& offspring) {
  Numbers numbers;
  for (const Child& child : offspring.children) {
    append(numbers, conformance::numbers_of(child.genome));
    numbers.insert(numbers.end(), child.parents.begin(), child.parents.end());
    for (const ChildNote& note : child.notes) append(numbers, {double(note.title), note.value});
  }
  if (offspring.memory) append(numbers, numbers_of(*offspring.memory));
  return numbers;
}

Survival sound_survival(const Selection& op, const SelectionContext& context, std::uint32_t population, Rng& rng) {
  return accepted(op.survivors(context, population, rng), [&](const Survival& survival) {
    check_survival(survival, {op.notes(), op.memory()}, context, population);
  });
}

Offspring sound_offspring(const Selection& op, const SelectionContext& context, std::uint32_t count, Rng& rng) {
  return accepted(op.children(context, count, rng), [&](const Offspring& offspring) {
    check_offspring(offspring, {op.notes(), op.memory()}, context, count);
  });
}

std::vector<Couple> sound_couples(const Selection& op, const SelectionContext& context, std::uint32_t count, Rng& rng) {
  return accepted(op.parents(context, count, rng),
                  [&](const std::vector<Couple>& couples) { check_couples(couples, context, count); });
}

Numbers try_selection(const Subject& subject, const Selection& op, std::uint64_t seed, std::uint32_t input) {
  const Traits traits = op.traits();
  const std::uint32_t population = std::max(10u, traits.least_population), count = std::max(20u, traits.least_children);
  const SampleTable table(subject, op, seed, input, population + 14, 4);
  const Numbers before = table.numbers();
  Rng rng = stream(seed, input, 1);
  Numbers result;
  SelectionMemory memory;
  if (op.overrides.survivors) {
    const Survival survival = op.survivors(table.context(), population, rng);
    remember(memory, survival.memory);
    append(result, numbers_of(survival));
  }
  if (op.overrides.children) append(result, numbers_of(op.children(table.context(memory), count, rng)));
  if (op.overrides.parents)
    for (const auto& [parent, mate] : op.parents(table.context(memory), 20, rng))
      append(result, {double(parent), double(mate)});
  if (!same(before, table.numbers()))
    throw Violation("it changes the scores or the genes of individuals, which it may only read");
  return result;
}

}  // namespace evodevo::conformance
