#include "conformance/tables.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

#include "base/text.hpp"

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
                         std::size_t rows, std::size_t failed)
    : lists_(rows), rows_(rows) {
  Rng rng = stream(seed, input), gene_rng = stream(seed, input, 3);
  set_titles(subject, op, input);
  const SampleGenomes genomes = genomes_for(subject, op, input);
  layout_ = genomes.layout;
  for (Lists& lists : lists_) lists.genome = genomes.draw(gene_rng);
  std::vector<std::uint8_t> fails(rows, 0);
  std::fill_n(fails.begin(), failed, 1);
  rng.shuffle(fails);
  set_rows(fails, rng);
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

void SampleTable::set_rows(const std::vector<std::uint8_t>& fails, Rng& rng) {
  const auto draw = [&](std::size_t count, double low, double high) {
    Numbers numbers;
    for (std::size_t i = 0; i < count; ++i) numbers.push_back(rng.uniform(low, high));
    return numbers;
  };
  constexpr std::array lost{Status::diverged, Status::artefact, Status::passive, Status::lucky};
  const auto half = static_cast<std::uint32_t>(rows_.size() / 2);
  for (std::uint32_t i = 0; i < rows_.size(); ++i) {
    Lists& lists = lists_[i];
    Candidate& row = rows_[i];
    row.id = 100 + i;
    row.age = rng.below(6);
    row.is_newborn = i >= half;
    if (row.is_newborn && half > 0 && rng.chance(0.8)) {
      row.challenges = rng.below(half);
      lists.parents = {100 + *row.challenges};
    }
    const Numbers scores = draw(objectives_.size(), -5, 5);
    if (fails[i] != 0) {
      const bool is_infeasible = rng.chance(0.5);
      row.status = is_infeasible ? Status::invalid : lost[i % lost.size()];
      row.violation = is_infeasible ? rng.uniform(0.1, 3) : std::numeric_limits<double>::infinity();
      continue;
    }
    lists.scores = scores;
    lists.descriptors = draw(descriptors_.size(), -1.2, 1.2);
    for (const evodevo::Case& one : cases_)
      lists.cases.push_back(one.scenario.empty() ? scores[one.objective] : rng.uniform(-5, 5));
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

SelectionContext SampleTable::context(std::span<const std::byte> memory) const {
  return {rows_, objectives_, descriptors_, cases_, layout_, 6, memory};
}

SelectionContext SampleTable::empty_context() const { return {{}, objectives_, descriptors_, cases_, layout_, 0, {}}; }

Numbers SampleTable::numbers() const {
  Numbers numbers;
  for (const Lists& lists : lists_) {
    for (const Numbers* list : {&lists.scores, &lists.cases, &lists.descriptors}) append(numbers, *list);
    append(numbers, conformance::numbers_of(lists.genome));
  }
  return numbers;
}

Numbers numbers_of(const Survival& survival) {
  Numbers numbers(survival.rows.begin(), survival.rows.end());
  for (const std::byte byte : survival.memory) numbers.push_back(std::to_integer<int>(byte));
  for (const Note& note : survival.notes) append(numbers, {double(note.row), double(note.title), note.value});
  return numbers;
}

Survival sound_survival(const Selection& op, const SelectionContext& context, std::uint32_t population, Rng& rng) {
  const std::size_t titles = op.notes().size();
  Survival survival = op.survive(context, population, rng);
  const std::set<std::uint32_t> different(survival.rows.begin(), survival.rows.end());
  if (survival.rows.empty() || survival.rows.size() > population || different.size() != survival.rows.size() ||
      *different.rbegin() >= context.rows.size())
    throw Violation("it chooses " + std::to_string(survival.rows.size()) + " survivors of " +
                    std::to_string(context.rows.size()) + " rows; expected 1 to " + std::to_string(population) +
                    " different ones");
  std::set<std::pair<std::uint32_t, std::uint32_t>> noted;
  for (const Note& note : survival.notes) {
    if (!noted.emplace(note.row, note.title).second)
      throw Violation("it notes number " + std::to_string(note.title) + " twice about row " + std::to_string(note.row) +
                      "; expected one note for each row and number");
    if (note.row >= context.rows.size() || note.title >= titles || !std::isfinite(note.value))
      throw Violation("it notes number " + std::to_string(note.title) + " = " + to_text(note.value) + " about row " +
                      std::to_string(note.row) + "; expected a finite number, one of the " + std::to_string(titles) +
                      " of notes(), about one of " + std::to_string(context.rows.size()) + " rows");
  }
  return survival;
}

std::vector<Child> sound_children(const Selection& op, const SelectionContext& context, std::uint32_t count, Rng& rng) {
  auto children = op.children(context, count, rng);
  if (children.size() != count)
    throw Violation("it makes " + std::to_string(children.size()) + " children; expected " + std::to_string(count));
  for (const Child& child : children) {
    require_within(child.genome, context.layout);
    if (child.parents.size() > 2)
      throw Violation("it makes a child of " + std::to_string(child.parents.size()) + " parents; expected 0 to 2");
    for (const std::uint32_t row : child.parents)
      if (row >= context.rows.size())
        throw Violation("it makes a child of row " + std::to_string(row) + "; the table has " +
                        std::to_string(context.rows.size()));
  }
  return children;
}

Numbers try_selection(const Subject& subject, const Selection& op, std::uint64_t seed, std::uint32_t input) {
  const Traits traits = op.traits();
  const std::uint32_t population = std::max(10u, traits.least_population), count = std::max(20u, traits.least_children);
  const SampleTable table(subject, op, seed, input, population + 14, 4);
  const Numbers before = table.numbers();
  Rng rng = stream(seed, input, 1);
  Numbers result;
  std::vector<std::byte> memory;
  if (traits.chooses_survivors) {
    const Survival survival = op.survive(table.context(), population, rng);
    memory = survival.memory;
    append(result, numbers_of(survival));
  }
  if (traits.makes_children)
    for (const Child& child : op.children(table.context(memory), count, rng))
      append(result, conformance::numbers_of(child.genome));
  else if (traits.chooses_parents)
    for (const auto& [parent, mate] : op.couples(table.context(memory), 20, rng))
      append(result, {double(parent), double(mate)});
  if (!same(before, table.numbers()))
    throw Violation("it changes the scores or the genes of individuals, which it may only read");
  return result;
}

}  // namespace evodevo::conformance
