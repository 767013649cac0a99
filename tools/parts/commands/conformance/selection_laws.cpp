// Test cases for selection operators.
#include <algorithm>
#include <numeric>

#include "conformance/conformance.hpp"
#include "conformance/tables.hpp"
#include "evodevo/helpers/rows.hpp"

namespace evodevo::conformance {
namespace {

std::vector<std::uint32_t> first_to_last(std::uint32_t count) {
  std::vector<std::uint32_t> rows(count);
  std::iota(rows.begin(), rows.end(), 0u);
  return rows;
}

/// Returns what the operator makes or chooses for 20 children: rows of parents as rows of the first table, and genes.
Numbers bred(const Selection& op, const SelectionContext& context, const std::vector<std::uint32_t>& order, Rng& rng) {
  const Traits traits = op.traits();
  Numbers numbers;
  if (traits.makes_children) {
    for (const Child& child : sound_children(op, context, 20, rng)) {
      const Numbers genes = numbers_of(child.genome);
      numbers.insert(numbers.end(), genes.begin(), genes.end());
      for (const std::uint32_t row : child.parents) numbers.push_back(order.at(row));
    }
  } else if (traits.chooses_parents) {
    for (const auto& [parent, mate] : op.couples(context, 20, rng))
      for (const std::uint32_t row : {parent, mate}) numbers.push_back(order.at(row));
  }
  return numbers;
}

/// Returns the survivors and the notes, as rows of the first table, in ascending order, and sets the memory.
Numbers survived(const Selection& op, const SelectionContext& context, const std::vector<std::uint32_t>& order,
                 Rng& rng, std::vector<std::byte>& memory) {
  if (!op.traits().chooses_survivors) return {};
  Survival survival = sound_survival(op, context, 10, rng);
  memory = survival.memory;
  for (std::uint32_t& row : survival.rows) row = order.at(row);
  for (Note& note : survival.notes) note.row = order.at(note.row);
  std::sort(survival.rows.begin(), survival.rows.end());
  const auto place = [](const Note& note) { return std::pair(note.row, note.title); };
  std::sort(survival.notes.begin(), survival.notes.end(), [&](auto& a, auto& b) { return place(a) < place(b); });
  survival.memory.clear();  // it may list the rows in their order
  return numbers_of(survival);
}

void order_does_not_matter(const Subject& subject, std::uint64_t seed) {
  const auto op = create<Selection>(subject);
  const std::vector<std::uint32_t> straight = first_to_last(24);
  for (std::uint32_t input = 0; input < 40; ++input) {
    // rows that failed may be equally bad; if there is only one, also what is learned must not depend on the order
    const bool learns = input % 4 < 2;
    const SampleTable table(subject, *op, seed, input, 24, learns ? 1 : 4);
    std::vector<std::uint32_t> order = straight;
    Rng shuffler = stream(seed, input, 2);
    shuffler.shuffle(order);
    const SampleTable other(table, order);
    Rng rng = stream(seed, input, 1), same_rng = rng;
    std::vector<std::byte> memory, other_memory;
    if (survived(*op, table.context(), straight, rng, memory) !=
        survived(*op, other.context(), order, same_rng, other_memory))
      throw Violation("the choice of survivors depends on the order of birth");
    if (!learns) memory.clear(), other_memory.clear();
    if (bred(*op, table.context(memory), straight, rng) != bred(*op, other.context(other_memory), order, same_rng))
      throw Violation("the choice of parents, or the children that it makes, depend on the order of birth");
  }
}

void keeps_its_elite(const Subject& subject, std::uint64_t seed) {
  const auto op = create<Selection>(subject);
  if (!op->traits().is_elitist) throw Skipped("its traits say that it is not elitist");
  if (!op->traits().chooses_survivors) throw Skipped("its traits say that it chooses no survivors");
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
  const Traits traits = op.traits();
  if (!traits.chooses_parents || traits.makes_children) return;
  for (const auto& [parent, mate] : op.couples(table.context(), 20, rng))
    if (!table.rows().at(parent).ok() || !table.rows().at(mate).ok())
      throw Violation("a failed row is a parent in place of a sound one");
}

/// Checks that no failed row survives or breeds. Twelve of the twenty rows did not fail and only ten survive, so no
/// failed row is needed. If all rows failed, there must be survivors and parents nevertheless.
void failed_rows_lose(const Subject& subject, std::uint64_t seed) {
  const auto op = create<Selection>(subject);
  const bool survivors = op->traits().chooses_survivors;
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
  if (op->traits().makes_children)
    sound_children(*op, hopeless.context(), 5, rng);
  else if (op->traits().chooses_parents && op->couples(hopeless.context(), 5, rng).size() != 5)
    throw Violation("if all rows have failed, it does not choose as many parents as asked for");
}

/// Breeds from a table with a memory. Throws Violation if the result depends on the memory, and the operator does not
/// claim to need one.
void breed_with(const std::vector<std::byte>& memory, const Selection& op, const SampleTable& table, Rng& rng) {
  const auto order = first_to_last(static_cast<std::uint32_t>(table.rows().size()));
  Rng same_rng = rng;
  const Numbers numbers = bred(op, table.context(memory), order, rng);
  if (!op.traits().needs_memory && numbers != bred(op, table.context(), order, same_rng))
    throw Violation(
        "the choice of parents, or the children that it makes, depend on the memory; set "
        "Traits::needs_memory");
}

/// Checks that what an operator remembers depends on the arguments alone, and that it works in generations of any size,
/// the first one and smaller ones included, with what it remembers from others.
void fits_generations_of_any_size(const Subject& subject, std::uint64_t seed) {
  const auto op = create<Selection>(subject);
  const Traits traits = op->traits();
  for (std::uint32_t input = 0; input < 10; ++input) {
    std::vector<std::byte> memory;
    for (const std::uint32_t rows : {24, 24, 5, 60}) {
      const SampleTable table(subject, *op, seed + rows, input, rows, rows / 6);
      Rng rng = stream(seed, input, rows);
      if (traits.makes_children)
        sound_children(*op, memory.empty() ? table.empty_context() : table.context(memory), rows, rng);
      if (!traits.chooses_survivors) continue;
      Rng same_rng = rng;
      const std::uint32_t population = std::max(rows / 2, traits.least_population);
      const Survival survival = sound_survival(*op, table.context(memory), population, rng);
      if (!same(numbers_of(survival), numbers_of(op->survive(table.context(memory), population, same_rng))))
        throw Violation(
            "two calls of survive() with equal arguments give different results; keep nothing between calls");
      memory = survival.memory;
      breed_with(memory, *op, table, rng);
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
