#include "living_again.hpp"

#include <iostream>

namespace evodevo {

Experiment experiment_to_live_again(const Archive& archive, std::vector<std::filesystem::path> plugin_path) {
  Experiment experiment = recorded_experiment(archive, std::move(plugin_path));
  if (experiment.device == "cuda") experiment.device = "auto";
  return experiment;
}

Newborn born_again(const Archive& archive, const Individual& individual, const std::string& device) {
  Newborn newborn{individual.id, individual.born, &individual.genome, archive.life(individual.id)};
  if (const std::string device_of_run = archive.record("device"); !newborn.record && device != device_of_run)
    std::cerr << "warning: individual " << individual.id << " lived again on " << device << ", not on " << device_of_run
              << " as in the run, which has no record of its edits; it may have developed otherwise\n";
  return newborn;
}

}  // namespace evodevo
