#include "evolution/front_verification.hpp"

#include <algorithm>
#include <chrono>

#include "base/text.hpp"
#include "evolution/clones.hpp"
#include "evolution/selection_table.hpp"
#include "life/measurement/combining.hpp"

namespace evodevo {
namespace {

/// Returns an individual with those of its lives that were measured last, and its fitness in them.
Champion champion_of(const Individual& individual, const Experiment& experiment) {
  const std::vector<std::vector<double>>& lives = individual.result.lives;
  const std::ptrdiff_t last = std::min<std::ptrdiff_t>(experiment.lives, std::ssize(lives));
  Newborn newborn = newborn_of(individual);
  newborn.lives = static_cast<std::uint32_t>(last);
  newborn.life = individual.lives - newborn.lives + 1;
  return {std::move(newborn), objectives_of({lives.end() - last, lives.end()}, experiment).front()};
}

void take_fitness(Individual& individual, const Refusal& refusal) {
  Result& result = individual.result;
  result.status = refusal.status;
  result.reason = refusal.reason;
  result.objectives.clear();
  result.measures.clear();
  result.tests.clear();
  result.lives.clear();
}

}  // namespace

std::vector<Refusal> FrontVerification::refuse(std::vector<Individual>& everyone, std::uint32_t generation) {
  std::vector<Refusal> refusals;
  if (experiment_.verify_front == VerifyFront::off) return refusals;
  const auto start = std::chrono::steady_clock::now();
  for (bool all_hold = false; !all_hold;) {
    const std::vector<Ranked> line = ranked(everyone, generation);
    verify_front(line);
    all_hold = true;
    for (const auto& [individual, layer] : line) {
      if (layer > 0) break;
      const std::optional<Refusal>& refusal = verified_.at(individual->id);
      if (!refusal) continue;
      take_fitness(*individual, *refusal);
      refusals.push_back(*refusal);
      all_hold = false;
    }
  }
  seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return refusals;
}

void FrontVerification::forget(std::span<const Individual> individuals) {
  for (const Individual& one : individuals) verified_.erase(one.id);
}

/// Returns the individuals with a fitness, without copies, in the order of their layers.
std::vector<FrontVerification::Ranked> FrontVerification::ranked(std::vector<Individual>& everyone,
                                                                 std::uint32_t generation) const {
  const std::vector<std::uint32_t> layer = layers(everyone, experiment_, generation), copies = copies_in(everyone);
  std::vector<Ranked> line;
  for (std::size_t i = 0; i < everyone.size(); ++i)
    if (everyone[i].result.status == Status::ok && !std::ranges::binary_search(copies, everyone[i].id))
      line.push_back({&everyone[i], layer[i]});
  std::ranges::stable_sort(line, {}, &Ranked::layer);
  return line;
}

/// Verifies the individuals on the front that have not been verified yet. Where these leave threads or GPUs idle, some
/// of the next layers, which come to the front after refusals, are verified too. What is found of them counts only if
/// they do.
void FrontVerification::verify_front(const std::vector<Ranked>& line) {
  std::vector<Champion> champions;
  std::vector<std::uint32_t> provenances;
  for (const auto& [individual, layer] : line) {
    if (layer > 0 && (champions.empty() || champions.size() >= evaluator_.verified_at_once())) break;
    if (verified_.contains(individual->id)) continue;
    const std::optional<std::uint32_t> provenance = provenances_.own(individual->provenance);
    if (!provenance) {
      verified_[individual->id] = std::nullopt;
      continue;
    }
    champions.push_back(champion_of(*individual, experiment_));
    provenances.push_back(*provenance);
  }
  if (champions.empty()) return;
  for (const Verification& verification : evaluator_.verify(champions, provenances))
    verified_[verification.individual] = refusal(verification);
}

std::optional<Refusal> FrontVerification::refusal(const Verification& verification) const {
  const Objective& objective = experiment_.objectives.front();
  const std::optional<Mark> mark = first_mark(verification, objective.maximise);
  if (!mark) return std::nullopt;
  const Trial& trial = mark->trial;
  const std::string in_trial = trial.value ? " gives " + short_quantity(*trial.value, objective.unit)
                                           : std::string(" ends as ") + name(trial.status) + " (" + trial.reason + ")";
  return Refusal{verification.individual, mark->status,
                 trial.name + in_trial + "; the run gave " + short_quantity(verification.fitness, objective.unit)};
}

}  // namespace evodevo
