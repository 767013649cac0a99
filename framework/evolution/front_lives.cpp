#include "evolution/front_lives.hpp"

#include <utility>

#include "evolution/selection_table.hpp"

namespace evodevo {
namespace {

/// Returns the Pareto front of `everyone` in the objectives and in youth.
std::vector<const Individual*> front(const std::vector<Individual>& everyone, const Experiment& experiment,
                                     std::uint32_t generation) {
  const std::vector<std::uint32_t> layer = layers(everyone, experiment, generation);
  std::vector<const Individual*> front;
  for (std::size_t i = 0; i < everyone.size(); ++i)
    if (everyone[i].result.status == Status::ok && layer[i] == 0) front.push_back(&everyone[i]);
  return front;
}

}  // namespace

FrontLives::FrontLives(const Experiment& experiment, Evaluator& evaluator, const RecordedProvenances& provenances,
                       const Archive& archive)
    : experiment_(experiment), evaluator_(evaluator), provenances_(provenances) {
  for (const Individual& individual : archive.population())
    kept_[individual.id] = static_cast<std::uint32_t>(archive.lives(individual.id).size());
}

void FrontLives::keep_front(const std::vector<Individual>& everyone, std::uint32_t generation) {
  std::vector<Newborn> arrivals;
  std::vector<std::uint32_t> provenances;
  for (const Individual* individual : front(everyone, experiment_, generation)) {
    std::uint32_t& kept = kept_[individual->id];
    const std::optional<std::uint32_t> provenance = provenances_.own(individual->provenance);
    if (kept == individual->lives || !provenance) continue;
    Newborn& arrival = arrivals.emplace_back(newborn_of(*individual));
    arrival.life += kept;
    arrival.lives -= std::exchange(kept, individual->lives);
    provenances.push_back(*provenance);
  }
  if (arrivals.empty()) return;
  std::vector<std::vector<LifeRecord>> records = evaluator_.records(arrivals, provenances);
  for (std::size_t i = 0; i < arrivals.size(); ++i)
    to_commit_[arrivals[i].id] = {arrivals[i].life, std::move(records[i])};
}

LivesById FrontLives::committed() {
  evaluator_.forget_records();
  return std::exchange(to_commit_, {});
}

}  // namespace evodevo
