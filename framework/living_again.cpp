#include "living_again.hpp"

#include <iostream>

namespace evodevo {

Experiment experiment_to_live_again(const Archive& archive, std::vector<std::filesystem::path> plugin_path) {
  Experiment experiment = recorded_experiment(archive, std::move(plugin_path));
  if (experiment.device == "cuda") experiment.device = "auto";
  return experiment;
}

void warn_where_unsure(const Archive& archive, const Experiment& experiment, const Newborn& newborn,
                       const std::string& device) {
  const Maker then = archive.maker(newborn.generation), now = this_maker(experiment, device);
  if (are_same(then, now) || archive.life(newborn.id)) return;
  const std::string difference = now.device != then.device
                                     ? "on " + now.device + ", not on " + then.device + " as in the run"
                                     : "by another build of evodevo or of an operator than in the run";
  std::cerr << "warning: individual " << newborn.id << " lived again " << difference
            << ", which has no record of its edits; it may have developed otherwise\n";
}

LifeAgain live_again(const Archive& archive, const Experiment& experiment, Simulator& simulator,
                     const ArchivedIndividual& individual) {
  const std::optional<LifeRecord> record = archive.life(individual.id);
  const Evaluation evaluation(experiment, simulator);
  const Newborn newborn{individual.id, individual.born, &individual.genome, record ? &*record : nullptr};
  warn_where_unsure(archive, experiment, newborn, simulator.device());
  std::vector<Life> lives = evaluation.birth({&newborn, 1});
  Body born = lives.front().living.body;
  evaluation.develop(lives, [](double) {});
  lives.front().newborn.record = nullptr;  // it ends here
  return {std::move(born), std::move(lives.front())};
}

}  // namespace evodevo
