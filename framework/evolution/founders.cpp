#include "evolution/founders.hpp"

#include <algorithm>

#include "base/text.hpp"
#include "evolution/archive/archive.hpp"
#include "evolution/archive/error.hpp"
#include "evolution/breeding.hpp"
#include "experiment/config_errors.hpp"

namespace evodevo {
namespace {

[[noreturn]] void refuse(const Experiment& experiment, const std::string& what) {
  throw ConfigError("experiment.start = " + printable(experiment.start) + ": " + what);
}

Archive opened(const Experiment& experiment) {
  try {
    return Archive::read(experiment.start);
  } catch (const ArchiveError& error) {
    throw ConfigError(std::string("experiment.start: ") + error.what());
  }
}

/// Keeps the `count` best by the first objective of their run, in the order in which they are.
void keep_best(std::vector<Individual>& population, std::size_t count, bool maximise) {
  std::vector<const Individual*> line;
  for (const Individual& individual : population) line.push_back(&individual);
  std::stable_sort(line.begin(), line.end(), [&](const Individual* a, const Individual* b) {
    const bool a_is_ok = a->result.status == Status::ok, b_is_ok = b->result.status == Status::ok;
    if (!a_is_ok || !b_is_ok) return a_is_ok && !b_is_ok;
    const double of_a = a->result.objectives.front(), of_b = b->result.objectives.front();
    return maximise ? of_a > of_b : of_a < of_b;
  });
  line.resize(count);
  std::vector<std::uint32_t> kept;
  for (const Individual* individual : line) kept.push_back(individual->id);
  std::erase_if(population, [&](const Individual& one) { return std::ranges::find(kept, one.id) == kept.end(); });
}

}  // namespace

std::vector<Migrant> founders(const Experiment& experiment) {
  if (experiment.start.empty()) return {};
  if (experiment.makes_children() && !experiment.parent_selection)
    refuse(experiment, "the selection operator " + experiment.child_maker +
                           " makes all children itself, the first ones included; use another one, or remove the key");
  const Archive archive = opened(experiment);
  if (archive.layout() != experiment.layout)
    refuse(experiment,
           "the genomes of that run have other genes than those of this experiment; give both the same encoding, and "
           "the same operators with genes of their own");
  std::vector<Individual> population = archive.population();
  if (population.empty()) refuse(experiment, "no generation of that run is complete; continue it with `resume`");
  const auto places = static_cast<std::size_t>(std::min(experiment.newborns(), experiment.evaluations));
  if (population.size() > places) keep_best(population, places, archive.objectives().front().maximise);
  std::vector<Migrant> migrants;
  for (Individual& individual : population)
    migrants.push_back({.from = {.island = 0, .individual = individual.id}, .genome = std::move(individual.genome)});
  return migrants;
}

}  // namespace evodevo
