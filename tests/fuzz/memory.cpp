// What a selection operator remembers, as the archive of a run holds it: after the operator, as a number, how many
// numbers each of its lists gets but the last, which gets the rest.
#include <cmath>
#include <cstring>
#include <set>

#include "base/philox.hpp"
#include "evolution/breeding.hpp"
#include "evolution/selection_table.hpp"
#include "fuzz/input.hpp"
#include "fuzz/target.hpp"

namespace evodevo {
namespace {

constexpr std::uint32_t survivors = 5;

Experiment experiment_with(const std::string& selection) {
  return read_experiment(R"(
[experiment]
evaluations = 30
population = 5
[encoding]
name = "neural"
points = 10
neighbours = 4
hidden = 1
[[fitness]]
name = "distance"
settle = 0.05
window = 0.1
[[fitness]]
name = "descriptor"
settle = 0.05
window = 0.1
[selection]
)" + selection,
                         {"memory.toml", {}});
}

/// An experiment, and a generation of its individuals that have fitness, but one.
struct Selecting {
  Experiment experiment;
  std::vector<Individual> individuals;

  explicit Selecting(const std::string& selection)
      : experiment(experiment_with(selection)), individuals(breed(experiment, {}, 0, 0, 2 * survivors)) {
    for (Individual& individual : individuals) {
      individual.result.objectives = {0.1 * individual.id};
      individual.result.measures.assign(experiment.measures.size(), 0.3 - 0.05 * individual.id);
    }
    Result& failed = individuals[3].result;
    failed = {};
    failed.status = Status::diverged;
  }
};

const std::vector<Selecting>& cases() {
  // never destroyed, since the program's end comes too late to call operators
  static const std::vector<Selecting>& cases = *[] {
    const std::string variation = "[[mutation]]\nname = \"reset-weight\"\n";
    auto& all = *new std::vector<Selecting>;
    all.emplace_back("name = \"novelty\"\n" + variation);
    all.emplace_back("name = \"species\"\n" + variation);
    all.emplace_back("name = \"map-elites\"\ncells = \"centroidal\"\ncount = 6\n" + variation);
    all.emplace_back("name = \"cma-es\"\n");
    return &all;
  }();
  return cases;
}

/// Lets the operator choose survivors, and returns what it remembers then.
SelectionMemory remembered(const Selecting& one, const SelectionMemory& memory) {
  const SelectionTable table(one.individuals, one.experiment, 1, memory);
  Rng rng(philox, {1, 1, 0, 0});
  Survival survival = one.experiment.selection->survivors(table.context(), survivors, rng);
  const std::set<std::uint32_t> rows(survival.rows.begin(), survival.rows.end());
  require(!rows.empty() && rows.size() == survival.rows.size() && rows.size() <= survivors &&
              *rows.rbegin() < one.individuals.size(),
          "a selection operator chooses survivors that there are not");
  return survival.memory.value_or(memory);
}

/// Returns a memory with these lists, whose numbers are finite.
SelectionMemory memory_in(Input& input, const std::vector<std::string>& names) {
  SelectionMemory memory;
  std::vector<std::size_t> sizes;
  for (std::size_t i = 1; i < names.size(); ++i) sizes.push_back(input.below(16));
  const std::string_view bytes = input.rest();
  std::vector<double> numbers(bytes.size() / sizeof(double));
  if (!numbers.empty()) std::memcpy(numbers.data(), bytes.data(), numbers.size() * sizeof(double));
  std::erase_if(numbers, [](double number) { return !std::isfinite(number); });
  auto next = numbers.begin();
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto left = static_cast<std::size_t>(numbers.end() - next);
    const auto end = next + static_cast<std::ptrdiff_t>(i < sizes.size() ? std::min(sizes[i], left) : left);
    memory.lists[names[i]].assign(next, end);
    next = end;
  }
  return memory;
}

}  // namespace

void fuzz(std::string_view bytes) {
  Input input(bytes);
  const Selecting& one = cases()[input.below(cases().size())];
  const SelectionMemory memory = memory_in(input, one.experiment.selection->memory());
  SelectionMemory next;
  try {
    Remembered given{.memory = {.survivors = memory, .parents = {}}, .notes = {}};
    breed(one.experiment, one.individuals, 1, 2 * survivors, survivors, &given);
    next = remembered(one, memory);
  } catch (const std::runtime_error&) {  // it is refused
    return;
  }
  remembered(one, next);
}

}  // namespace evodevo
