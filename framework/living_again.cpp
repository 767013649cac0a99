#include "living_again.hpp"

#include <iostream>

namespace evodevo {

Experiment experiment_to_live_again(const Archive& archive, std::vector<std::filesystem::path> plugin_path) {
  Experiment experiment = recorded_experiment(archive, std::move(plugin_path));
  if (experiment.device == "cuda") experiment.device = "auto";
  return experiment;
}

void warn_where_unsure(const Archive& archive, std::uint32_t id, const std::string& device) {
  const std::string device_of_run = archive.record("device");
  if (device == device_of_run || archive.life(id)) return;
  std::cerr << "warning: individual " << id << " lived again on " << device << ", not on " << device_of_run
            << " as in the run, which has no record of its edits; it may have developed otherwise\n";
}

LifeAgain live_again(const Archive& archive, const Experiment& experiment, Simulator& simulator,
                     const ArchivedIndividual& individual) {
  const std::optional<LifeRecord> record = archive.life(individual.id);
  warn_where_unsure(archive, individual.id, simulator.device());
  const Evaluation evaluation(experiment, simulator);
  const Newborn newborn{individual.id, individual.born, &individual.genome, record ? &*record : nullptr};
  std::vector<Life> lives = evaluation.birth({&newborn, 1});
  Body born = lives.front().living.body;
  evaluation.develop(lives, [](double) {});
  lives.front().newborn.record = nullptr;  // it ends here
  return {std::move(born), std::move(lives.front())};
}

}  // namespace evodevo
