#include "life/measurement/combining.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>

namespace evodevo {
namespace {

/// The scores of some lives that are not objectives, and the number of these lives.
struct Measured {
  const std::vector<double>& measures;
  double lives;
};

/// Returns such scores of all lives; none if some have none.
std::vector<double> measures_of(const std::vector<Measured>& parts, const Experiment& experiment) {
  std::vector<double> all;
  for (std::size_t i = 0; i < experiment.measures.size(); ++i) {
    double sum = 0, lives = 0, worst = -std::numeric_limits<double>::infinity();
    for (const Measured& part : parts) {
      if (part.measures.size() != experiment.measures.size()) return {};
      sum += part.lives * part.measures[i];
      lives += part.lives;
      worst = std::max(worst, part.measures[i]);
    }
    all.push_back(experiment.measures[i].role == Role::constraint ? worst : sum / lives);
  }
  return all;
}

/// Fails a result whose scores are not all finite: those of lives are, but their sum need not be. Only a result that is
/// ok has objectives.
void complete(const Experiment& experiment, Result& result) {
  const auto check = [&](std::vector<double>& scores, const std::vector<Objective>& titles) {
    const auto wrong = std::ranges::find_if_not(scores, [](double score) { return std::isfinite(score); });
    if (wrong == scores.end()) return;
    if (result.status == Status::ok) {
      result.status = Status::invalid;
      result.reason = "mean of the lives not finite: " + titles[static_cast<std::size_t>(wrong - scores.begin())].name;
    }
    scores.clear();
  };
  check(result.objectives, experiment.objectives);
  check(result.measures, experiment.measures);
  if (result.status == Status::ok) return;
  result.objectives.clear();
  result.lives.clear();
}

}  // namespace

double combined(std::vector<double> scores, Over over, bool maximise) {
  std::sort(scores.begin(), scores.end());
  const std::size_t middle = scores.size() / 2;
  switch (over) {
    case Over::worst:
      return maximise ? scores.front() : scores.back();
    case Over::median:
      return scores.size() % 2 == 1 ? scores[middle] : std::midpoint(scores[middle - 1], scores[middle]);
    case Over::mean:
      break;
  }
  return std::accumulate(scores.begin(), scores.end(), 0.0) / static_cast<double>(scores.size());
}

std::vector<double> objectives_of(const std::vector<std::vector<double>>& lives, const Experiment& experiment) {
  std::vector<double> all;
  for (std::size_t i = 0; i < experiment.objectives.size(); ++i) {
    std::vector<double> scores;
    for (const std::vector<double>& life : lives) scores.push_back(life.at(i));
    all.push_back(combined(std::move(scores), experiment.over_lives.at(i), experiment.objectives[i].maximise));
  }
  return all;
}

Result of_all_lives(const Experiment& experiment, std::vector<Result> lives, std::uint32_t first) {
  Result all;
  std::vector<Measured> measured;
  for (std::size_t i = 0; i < lives.size(); ++i) {
    Result& life = lives[i];
    const std::uint32_t number = first + static_cast<std::uint32_t>(i);
    all.spring_evaluations += life.spring_evaluations;
    std::ranges::move(life.records, std::back_inserter(all.records));
    std::ranges::move(life.tests, std::back_inserter(all.tests));
    measured.push_back({life.measures, 1});  // a life that violates a constraint has measures, too
    if (life.status == Status::ok) all.lives.push_back(life.objectives);
    if (life.status == Status::ok || all.status != Status::ok) continue;
    all.status = life.status;
    all.reason = (number > 1 || lives.size() > 1 ? "life " + std::to_string(number) + ": " : "") + life.reason;
    all.ended_at = life.ended_at;
  }
  all.measures = measures_of(measured, experiment);
  if (all.status == Status::ok) all.objectives = objectives_of(all.lives, experiment);
  complete(experiment, all);
  return all;
}

void add_lives(const Experiment& experiment, std::uint32_t lives, std::uint32_t more, Result again, Result& result) {
  result.spring_evaluations += again.spring_evaluations;
  std::ranges::move(again.tests, std::back_inserter(result.tests));
  std::ranges::move(again.lives, std::back_inserter(result.lives));
  result.measures = measures_of(
      {{result.measures, static_cast<double>(lives)}, {again.measures, static_cast<double>(more)}}, experiment);
  if (again.status == Status::ok) {
    result.objectives = objectives_of(result.lives, experiment);
  } else {
    result.status = again.status;
    result.reason = std::move(again.reason);
    result.ended_at = again.ended_at;
  }
  complete(experiment, result);
}

}  // namespace evodevo
