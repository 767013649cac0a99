#include "living_again.hpp"

#include <iostream>

namespace evodevo {
namespace {

/// Stands for an operator and makes the changes that it is recorded to have made.
class Recorded final : public Devo {
 public:
  Recorded(std::vector<Change> changes, std::uint32_t op, SpringRequest request)
      : changes_(std::move(changes)), op_(op), request_(request) {}

  /// What the operator asked for, so that the simulation is the same to the bit.
  SpringRequest observes() const override { return request_; }

  void develop(const Moment& now, Edits& edits, Rng&) const override {
    for (const Change& change : changes_)
      if (change.op == op_ && change.cycle == static_cast<std::uint32_t>(now.cycle)) edits = change.edits;
  }

 private:
  std::vector<Change> changes_;
  std::uint32_t op_;
  SpringRequest request_;
};

}  // namespace

Experiment experiment_to_live_again(const Archive& archive, std::vector<std::filesystem::path> plugin_path) {
  Experiment experiment = recorded_experiment(archive, std::move(plugin_path));
  if (experiment.device == "cuda") experiment.device = "auto";
  return experiment;
}

void follow(Experiment& experiment, const LifeRecord& record) {
  const std::vector<Change> changes = record.changes();
  std::vector<Scheduled>& operators = experiment.development.operators;
  for (std::uint32_t i = 0; i < operators.size(); ++i)
    operators[i].op = std::make_unique<Recorded>(changes, i, operators[i].op->observes());
  experiment.development.control = Control::off;  // the record has what came of it
}

void warn_where_unsure(const Archive& archive, std::uint32_t id, const std::string& device) {
  const std::string device_of_run = archive.record("device");
  if (device == device_of_run || archive.life(id)) return;
  std::cerr << "warning: individual " << id << " lived again on " << device << ", not on " << device_of_run
            << " as in the run, which has no record of its edits; it may have developed otherwise\n";
}

LifeAgain live_again(const Archive& archive, Experiment& experiment, Simulator& simulator,
                     const ArchivedIndividual& individual) {
  if (const std::optional<LifeRecord> record = archive.life(individual.id)) follow(experiment, *record);
  warn_where_unsure(archive, individual.id, simulator.device());
  const Evaluation evaluation(experiment, simulator);
  const Newborn newborn{individual.id, individual.born, &individual.genome};
  std::vector<Life> lives = evaluation.birth({&newborn, 1});
  Body born = lives.front().living.body;
  evaluation.develop(lives, [](double) {});
  return {std::move(born), std::move(lives.front())};
}

}  // namespace evodevo
