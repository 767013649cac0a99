#include "evolution/founders.hpp"

#include <algorithm>

#include "archive/archive.hpp"
#include "archive/error.hpp"
#include "base/genome_sections.hpp"
#include "base/text.hpp"
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

/// Returns the places of those who come: of all, or of the `count` best by the first objective of their run. Those
/// without a fitness come last. In ascending order.
std::vector<std::size_t> chosen(const std::vector<Individual>& population, std::size_t count, bool maximise) {
  std::vector<std::size_t> places = fittest_first(population, maximise);
  for (std::size_t i = 0; i < population.size(); ++i)
    if (population[i].result.status != Status::ok) places.push_back(i);
  places.resize(std::min(count, places.size()));
  std::ranges::sort(places);
  return places;
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
  const auto most = static_cast<std::size_t>(std::min(experiment.births(0), experiment.evaluations));
  std::vector<Migrant> migrants;
  for (const std::size_t place : chosen(population, most, archive.objectives().front().maximise)) {
    Individual& one = population[place];
    if (const std::string fault = genome_fault(one.genome, experiment.layout); !fault.empty())
      refuse(experiment, "individual " + std::to_string(one.id) + " has " + fault +
                             "; put back an undamaged copy of that run, or name another one");
    migrants.push_back({.from = {.island = 0, .individual = one.id}, .genome = std::move(one.genome)});
  }
  return migrants;
}

std::optional<std::int64_t> development_seed_of_start(const Experiment& experiment) {
  if (experiment.start.empty()) return std::nullopt;
  return read_settings(opened(experiment).record("experiment"), experiment.start).development.seed;
}

}  // namespace evodevo
