// Test cases for selection operators.
#include <algorithm>
#include <numeric>

#include "conformance/conformance.hpp"
#include "conformance/tables.hpp"
#include "evodevo/helpers/rows.hpp"

namespace evodevo::conformance {
namespace {

/// Returns what the operator makes or chooses for 20 children: ids of parents, genes, notes and memory.
Numbers bred(const Selection& op, const SelectionContext& context, Rng& rng) {
  Numbers numbers;
  if (op.overrides.parents)
    for (const auto& [parent, mate] : sound_couples(op, context, 20, rng))
      append(numbers, {double(context.rows[parent].id), double(context.rows[mate].id)});
  if (!op.overrides.children) return numbers;
  Offspring offspring = sound_offspring(op, context, 20, rng);
  for (Child& child : offspring.children)
    for (std::uint32_t& parent : child.parents) parent = context.rows[parent].id;
  append(numbers, numbers_of(offspring));
  return numbers;
}

/// Returns the survivors and the notes, with ids in place of rows, in their order.
Survival survived(const Selection& op, const SelectionContext& context, Rng& rng) {
  if (!op.overrides.survivors) return {};
  Survival survival = sound_survival(op, context, 10, rng);
  for (std::uint32_t& row : survival.rows) row = context.rows[row].id;
  for (Note& note : survival.notes) note.row = context.rows[note.row].id;
  std::ranges::sort(survival.rows);
  std::ranges::sort(survival.notes, {}, [](const Note& note) { return std::pair(note.row, note.title); });
  return survival;
}

/// Half of the tables have ties.
void order_does_not_matter(const Subject& subject, std::uint64_t seed) {
  const auto op = create<Selection>(subject);
  std::vector<std::uint32_t> order(24);
  for (std::uint32_t input = 0; input < 40; ++input) {
    const SampleTable table(subject, *op, seed, input, order.size(), 4, input % 4 >= 2);
    std::iota(order.begin(), order.end(), 0u);
    stream(seed, input, 2).shuffle(order);
    const SampleTable other(table, order);
    Rng rng = stream(seed, input, 1), same_rng = rng;
    const Survival one = survived(*op, table.context(), rng), another = survived(*op, other.context(), same_rng);
    const SelectionMemory memory = one.memory.value_or(no_memory), other_memory = another.memory.value_or(no_memory);
    if (memory != other_memory) throw Violation("what it remembers depends on the order of the rows; break ties by id");
    if (!same(numbers_of(one), numbers_of(another)))
      throw Violation("the choice of survivors, or its notes, depend on the order of the rows; break ties by id");
    if (!same(bred(*op, table.context(memory), rng), bred(*op, other.context(other_memory), same_rng)))
      throw Violation(
          "the choice of parents, or the children that it makes, depend on the order of the rows; break ties by id");
  }
}

void keeps_its_elite(const Subject& subject, std::uint64_t seed) {
  const auto op = create<Selection>(subject);
  if (!op->traits().is_elitist) throw Skipped("its traits say that it is not elitist");
  if (!op->overrides.survivors) throw Skipped("it overrides no survivors()");
  for (std::uint32_t input = 0; input < 40; ++input) {
    const SampleTable table(subject, *op, seed, input, 24, 4);
    const auto best = best_first(table.rows()).front();
    Rng rng = stream(seed, input, 1);
    const auto living = sound_survival(*op, table.context(), 10, rng).rows;
    if (std::find(living.begin(), living.end(), best) == living.end())
      throw Violation("the row with the best first score does not survive");
  }
}

/// Throws Violation if a row that failed breeds, though there are others.
void require_sound_parents(const Selection& op, const SampleTable& table, Rng& rng) {
  if (!op.overrides.parents) return;
  for (const auto& [parent, mate] : sound_couples(op, table.context(), 20, rng))
    if (!table.rows()[parent].ok() || !table.rows()[mate].ok())
      throw Violation("a failed row is a parent in place of a sound one");
}

/// Checks that no failed row survives or breeds. Twelve of the twenty rows did not fail and only ten survive, so no
/// failed row is needed. If all rows failed, there must be survivors and parents nevertheless.
void failed_rows_lose(const Subject& subject, std::uint64_t seed) {
  const auto op = create<Selection>(subject);
  const bool survivors = op->overrides.survivors;
  for (std::uint32_t input = 0; input < 20; ++input) {
    const SampleTable table(subject, *op, seed, input, 20, 8);
    Rng rng = stream(seed, input, 1);
    if (survivors)
      for (const std::uint32_t row : sound_survival(*op, table.context(), 10, rng).rows)
        if (!table.rows()[row].ok()) throw Violation("a failed row survives in place of a sound one");
    require_sound_parents(*op, table, rng);
  }
  const SampleTable hopeless(subject, *op, seed, 0, 20, 20);
  Rng rng = stream(seed, 0, 1);
  if (survivors) sound_survival(*op, hopeless.context(), 10, rng);
  bred(*op, hopeless.context(), rng);
}

/// Throws Violation unless two results of a function are equal.
template <class Result>
void require_same(const char* function, const Result& one, const Result& other) {
  if (!same(numbers_of(one), numbers_of(other)))
    throw Violation(std::string("two calls of ") + function +
                    " with equal arguments give different results; keep nothing between calls");
}

/// Checks that what an operator remembers depends on the arguments alone, and that it works in generations of any size,
/// the first one and smaller ones included, with what it remembers from others.
void fits_generations_of_any_size(const Subject& subject, std::uint64_t seed) {
  const auto op = create<Selection>(subject);
  for (std::uint32_t input = 0; input < 10; ++input) {
    SelectionMemory memory;
    for (const std::uint32_t rows : {24, 24, 5, 60}) {
      const SampleTable table(subject, *op, seed + rows, input, rows, rows / 6);
      Rng rng = stream(seed, input, rows);
      if (op->overrides.children) {
        Rng same_rng = rng;
        const auto context = memory.empty() ? table.empty_context() : table.context(memory);
        const Offspring offspring = sound_offspring(*op, context, rows, rng);
        require_same("children()", offspring, op->children(context, rows, same_rng));
        remember(memory, offspring.memory);
      }
      if (!op->overrides.survivors) continue;
      Rng same_rng = rng;
      const std::uint32_t population = std::max(rows / 2, op->traits().least_population);
      const Survival survival = sound_survival(*op, table.context(memory), population, rng);
      require_same("survivors()", survival, op->survivors(table.context(memory), population, same_rng));
      remember(memory, survival.memory);
      bred(*op, table.context(memory), rng);
    }
  }
}

}  // namespace

std::vector<Case> selection_laws() {
  return {{"order", order_does_not_matter},
          {"elite", keeps_its_elite},
          {"failed", failed_rows_lose},
          {"generations", fits_generations_of_any_size}};
}

}  // namespace evodevo::conformance
