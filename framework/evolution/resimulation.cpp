#include "evolution/resimulation.hpp"

#include <algorithm>
#include <iostream>
#include <map>

#include "archive/record_check.hpp"
#include "archive/recorded_experiment.hpp"
#include "base/text.hpp"

namespace evodevo {
namespace {

std::string difference(const Provenance& then, const Provenance& now) {
  return now.device != then.device ? "on " + now.device + ", not on " + then.device + " as in the run"
                                   : "by another build of evodevo or of an operator than in the run";
}

void warn(std::vector<std::string> ids, const std::string& what) {
  constexpr std::size_t most_named = 5;
  const std::size_t count = ids.size(), others = count > most_named + 1 ? count - most_named : 0;
  ids.resize(count - others);
  std::cerr << "warning: " << (count == 1 ? "individual " : "individuals ") << joined(ids)
            << (others > 0 ? " and " + std::to_string(others) + " others" : "") << (count == 1 ? " was" : " were")
            << " simulated again " << what << "; the run has no record of "
            << (count == 1 ? "its edits, so it" : "their edits, so they") << " may have developed differently\n";
}

}  // namespace

Experiment experiment_for_resimulation(const Archive& archive, std::vector<std::filesystem::path> plugin_path) {
  Experiment experiment = recorded_experiment(archive, std::move(plugin_path));
  if (experiment.device == Device::cuda) experiment.device = Device::automatic;
  return experiment;
}

std::vector<Newborn> for_resimulation(const Archive& archive, const Experiment& experiment,
                                      const std::vector<const Individual*>& individuals, const std::string& device) {
  const Provenance now = this_provenance(experiment, device);
  const std::vector<Provenance> provenances = archive.provenances();
  std::vector<Newborn> newborns;
  std::map<std::string, std::vector<std::string>> elsewhere;  // ids by what differs
  for (const Individual* individual : individuals) {
    check_genes(archive, experiment, *individual);
    Newborn& newborn = newborns.emplace_back(newborn_of(*individual));
    newborn.records = archive.lives(individual->id);
    newborn.recorded_in = archive.folder().string() + ": individual " + std::to_string(individual->id);
    check_lives(archive, experiment, newborn);
    const Provenance& then = provenances.at(individual->provenance);
    if (experiment.development.cycles > 0 && newborn.records.size() < newborn.lives && !are_same(then, now))
      elsewhere[difference(then, now)].push_back(std::to_string(newborn.id));
  }
  for (const auto& [what, ids] : elsewhere) warn(ids, what);
  return newborns;
}

Newborn for_resimulation(const Archive& archive, const Experiment& experiment, const Individual& individual,
                         const std::string& device) {
  return std::move(for_resimulation(archive, experiment, std::vector{&individual}, device).front());
}

}  // namespace evodevo
