#include "evolution/evaluator.hpp"

#include <algorithm>
#include <utility>

namespace evodevo {

std::size_t lives_at_once(Simulator& simulator) {
  constexpr std::size_t of_a_gpu = 100;
  const std::optional<DeviceUse> gpus = simulator.device_use();
  if (!gpus) return simulator.workers().count();
  const std::size_t most = of_a_gpu * gpus->devices;
  return most - std::min(most - 1, gpus->bodies);
}

std::size_t verified_at_once(const Experiment& experiment, Simulator& simulator) {
  return std::max<std::size_t>(1, lives_at_once(simulator) / (2 * static_cast<std::size_t>(experiment.lives)));
}

std::vector<Evaluated> LocalEvaluator::evaluate(std::span<const Newborn> newborns, const Progress& progress) {
  return without_records(newborns, evaluation_.evaluate(newborns, progress));
}

std::vector<Evaluated> LocalEvaluator::evaluate_cohort(std::span<const Newborn> newborns, const Progress& progress) {
  return without_records(newborns, evaluation_.evaluate_in(1, newborns, progress));
}

std::vector<Evaluated> LocalEvaluator::without_records(std::span<const Newborn> newborns, std::vector<Result> results) {
  std::vector<Evaluated> evaluated;
  for (Result& result : results) evaluated.push_back({std::move(result)});
  const std::lock_guard lock(mutex_);
  for (std::size_t i = 0; i < newborns.size(); ++i)
    kept_[{newborns[i].id, newborns[i].life}] = std::exchange(evaluated[i].result.records, {});
  return evaluated;
}

std::vector<std::vector<LifeRecord>> LocalEvaluator::records(std::span<const Newborn> newborns,
                                                             std::span<const std::uint32_t>) {
  std::vector<std::vector<LifeRecord>> records(newborns.size());
  std::vector<Newborn> lost;
  std::vector<std::size_t> places;  // of each lost life, in `records`
  {
    const std::lock_guard lock(mutex_);
    for (std::size_t i = 0; i < newborns.size(); ++i) {
      const auto kept = kept_.find({newborns[i].id, newborns[i].life});
      if (kept != kept_.end() && kept->second.size() == newborns[i].lives) {
        records[i] = kept->second;
      } else {
        lost.push_back(newborns[i]);
        places.insert(places.end(), newborns[i].lives, i);
      }
    }
  }
  std::vector<Life> lives = evaluation_.birth.of(each_life(experiment_, lost));
  evaluation_.development.run(lives, [](double) {});
  for (std::size_t i = 0; i < lives.size(); ++i) records[places[i]].push_back(std::move(lives[i].record));
  return records;
}

void LocalEvaluator::forget_records() {
  const std::lock_guard lock(mutex_);
  kept_.clear();
}

std::vector<Verification> LocalEvaluator::verify(std::span<const Champion> champions, std::span<const std::uint32_t>) {
  return verify_marks(experiment_, simulator_, exact(), champions, verified_at_once());
}

const ExactSimulators& LocalEvaluator::exact() {
  const std::lock_guard lock(mutex_);
  if (!exact_.same_method) exact_ = exact_simulators(experiment_, simulator_);
  return exact_;
}

}  // namespace evodevo
