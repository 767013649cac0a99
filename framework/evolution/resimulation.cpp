#include "evolution/resimulation.hpp"

#include <iostream>

#include "evolution/record_check.hpp"

namespace evodevo {

Experiment experiment_for_resimulation(const Archive& archive, std::vector<std::filesystem::path> plugin_path) {
  Experiment experiment = recorded_experiment(archive, std::move(plugin_path));
  if (experiment.device == Device::cuda) experiment.device = Device::automatic;
  return experiment;
}

Newborn for_resimulation(const Archive& archive, const Experiment& experiment, const Individual& individual,
                         const std::string& device) {
  check_genes(archive, experiment, individual);
  Newborn newborn{individual.id, individual.born, &individual.genome, archive.life(individual.id),
                  archive.folder().string() + ": individual " + std::to_string(individual.id)};
  if (newborn.record) check_life(archive, experiment, individual.id, *newborn.record);
  const Provenance then = archive.provenance(individual.born), now = this_provenance(experiment, device);
  if (newborn.record || are_same(then, now)) return newborn;
  const std::string difference = now.device != then.device
                                     ? "on " + now.device + ", not on " + then.device + " as in the run"
                                     : "by another build of evodevo or of an operator than in the run";
  std::cerr << "warning: individual " << individual.id << " was simulated again " << difference
            << "; the run has no record of its edits, so it may have developed differently\n";
  return newborn;
}

}  // namespace evodevo
