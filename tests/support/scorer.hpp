// Fitness operators that score as a test says, and the lives that they measure.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "cpu/simulator.hpp"
#include "life/evaluation.hpp"

namespace evodevo::testing {

/// A fitness operator that observes, names and scores what a test says.
struct Scorer final : Fitness {
  using Scoring = std::function<std::vector<double>(const Observation&)>;
  Scorer(Request wanted, std::vector<Objective> named, Scoring by)
      : request(std::move(wanted)), all(std::move(named)), scoring(std::move(by)) {}
  Request observes() const override { return request; }
  std::vector<Objective> objectives() const override { return all; }
  std::vector<double> score(const Observation& seen) const override { return scoring(seen); }

  Request request;
  std::vector<Objective> all;
  Scoring scoring;
};

/// Lets these operators alone score.
inline void score_by(Experiment& experiment, const std::vector<Scorer>& scorers, Over over = Over::mean,
                     std::optional<std::size_t> scenario = std::nullopt) {
  experiment.fitness.clear();
  experiment.objectives.clear();
  experiment.over_lives.clear();
  experiment.measures.clear();
  for (const Scorer& scorer : scorers) {
    experiment.fitness.push_back({std::make_unique<Scorer>(scorer), over, scenario});
    for (const Objective& score : scorer.all)
      (score.role == Role::objective ? experiment.objectives : experiment.measures).push_back(score);
  }
  experiment.over_lives.resize(experiment.objectives.size());
}

/// Returns a life, which is to be alive.
inline Life alive(Life life) {
  EXPECT_TRUE(life.alive()) << life.result.reason;
  return life;
}

/// The life of a newborn, with its scores.
inline Life lived(const Experiment& experiment, const Genome& genome, std::uint32_t id = 0) {
  const auto simulator = make_cpu_simulator(experiment.scene, experiment.stepping, 1);
  const Evaluation evaluation(experiment, *simulator);
  Cohort matured =
      evaluation.matured(evaluation.birth.in_all_scenes(std::vector<Newborn>{{id, 0, &genome}}), [](double) {});
  evaluation.measurement.run(matured, [](double) {});
  return std::move(matured.lives.front());
}

}  // namespace evodevo::testing
