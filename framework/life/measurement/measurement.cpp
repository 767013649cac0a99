#include "life/measurement/measurement.hpp"

#include <algorithm>
#include <cmath>

#include "base/text.hpp"
#include "life/body_building.hpp"
#include "life/measurement/combining.hpp"

namespace evodevo {
namespace {

/// Removes the samples of a life and what it has counted, so that the samples that follow do not depend on them.
void begin_counting_anew(Life& life) {
  life.samples = {};
  life.contact_time = life.work = 0;
  life.living.contact_times = {};
  life.living.version = nullptr;
}

std::string name_of(const Test& test, const Experiment& experiment) {
  const Scenario& scenario = experiment.scenarios[test.scenario];
  std::string name = "scenario \"" + scenario.name + "\"";
  if (scenario.repeat > 1) name += ", repeat " + std::to_string(test.repeat + 1);
  return name;
}

}  // namespace

Measurement::Measurement(const Experiment& experiment, const LifeSimulation& simulation, const Windows& windows)
    : experiment_(experiment), simulation_(simulation), windows_(windows) {
  std::size_t objectives = 0, measures = 0;
  for (std::size_t op = 0; op < experiment.fitness.size(); ++op) {
    std::vector<Place>& places = places_.emplace_back();
    for (const Objective& score :
         call_operator(experiment.call_of(Fitness::kind, op), [&] { return experiment.fitness[op].op->objectives(); }))
      places.push_back({score.role, score.role == Role::objective ? objectives++ : measures++});
  }
  if (objectives != experiment.objectives.size() || measures != experiment.measures.size())
    throw std::runtime_error("the fitness operators have " + std::to_string(objectives + measures) +
                             " scores, and the experiment expects " +
                             std::to_string(experiment.objectives.size() + experiment.measures.size()));
}

const Objective& Measurement::title_of(const Place& place) const {
  return (place.role == Role::objective ? experiment_.objectives : experiment_.measures)[place.index];
}

double Measurement::duration() const {
  return windows_.after_maturing().duration *
         static_cast<double>(std::max<std::size_t>(1, tests_of(experiment_).size()));
}

void Measurement::run(Cohort& matured, const Progress& progress) const {
  std::vector<std::vector<Scores>> tests(matured.lives.size());
  if (experiment_.scenarios.empty()) {
    std::vector<Scores> scores = scores_within(matured.lives, "");
    measure(matured.lives, "", scores);
    for (std::size_t i = 0; i < tests.size(); ++i) tests[i].push_back(std::move(scores[i]));
  } else {
    measure_in_scenarios(matured, tests, progress);
  }
  for (std::size_t i = 0; i < tests.size(); ++i) set_scores(tests[i], matured.lives[i]);
  progress(1);
}

void Measurement::run_in(const Test& test, std::span<Life> lives) const {
  const Scenario& scenario = experiment_.scenarios[test.scenario];
  std::vector<Scores> scores = scores_within(lives, scenario.develops ? scenario.name : "");
  for (Life& life : lives)
    if (life.alive()) start_scenario(test, experiment_, simulation_, life);
  measure(lives, scenario.name, scores);
  for (std::size_t i = 0; i < lives.size(); ++i) set_scores({scores[i]}, lives[i]);
}

void Measurement::measure_in_scenarios(Cohort& matured, std::vector<std::vector<Scores>>& tests,
                                       const Progress& progress) const {
  const std::span<Life> lives = matured.lives;
  const std::vector<Scores> within_life = scores_within(lives, "");
  std::map<std::size_t, std::vector<Scores>> within_scenario;
  for (auto& [scenario, others] : matured.in_scenarios)
    within_scenario[scenario] = scores_within(others, experiment_.scenarios[scenario].name);

  const std::vector<Test> all = tests_of(experiment_);
  for (std::size_t t = 0; t < all.size(); ++t) {
    const auto developed = matured.in_scenarios.find(all[t].scenario);
    const bool here = developed != matured.in_scenarios.end();
    std::vector<Life> tested = started(all[t], lives, here ? std::span<const Life>(developed->second) : lives);
    std::vector<Scores> scores =
        here ? within_scenario[all[t].scenario] : std::vector<Scores>(lives.size(), Scores(places_.size()));
    measure(tested, experiment_.scenarios[all[t].scenario].name, scores);
    for (std::size_t i = 0; i < lives.size(); ++i) {
      if (!lives[i].alive()) continue;
      add_test(all[t], scores[i], tested[i].result, lives[i]);
      tests[i].push_back(std::move(scores[i]));
    }
    progress(static_cast<double>(t + 1) / static_cast<double>(all.size()));
  }
  if (within_scenario.empty())  // after those of all tests, whose indices tell their scenarios
    for (std::size_t i = 0; i < lives.size(); ++i)
      if (lives[i].alive()) tests[i].push_back(within_life[i]);
}

std::vector<Life> Measurement::started(const Test& test, std::span<const Life> lives,
                                       std::span<const Life> matured) const {
  std::vector<Life> started(lives.size());
  simulation_.simulator().workers().for_each(lives.size(), [&](std::size_t i) {
    if (!lives[i].alive()) return started[i].end(lives[i].result.status, "");
    started[i] = matured[i];
    started[i].result.spring_evaluations = 0;
    if (started[i].alive()) start_scenario(test, experiment_, simulation_, started[i]);
  });
  return started;
}

void Measurement::add_test(const Test& test, const Scores& scores, const Result& tested, Life& life) const {
  life.result.spring_evaluations += tested.spring_evaluations;
  if (tested.status != Status::ok)
    return life.end(tested.status, name_of(test, experiment_) + ": " + tested.reason, tested.ended_at);
  for (std::size_t op = 0; op < scores.size(); ++op)
    for (std::size_t i = 0; i < scores[op].size(); ++i)
      if (const Place& place = places_[op][i]; place.role == Role::objective)
        life.result.tests.push_back({life.newborn.life, test.scenario, test.repeat, place.index, scores[op][i]});
}

std::vector<Measurement::Scores> Measurement::scores_within(std::span<Life> lives, std::string_view scenario) const {
  std::vector<Scores> scores(lives.size(), Scores(places_.size()));
  simulation_.simulator().workers().for_each(lives.size(), [&](std::size_t i) {
    for (std::size_t op = 0; op < places_.size() && lives[i].alive(); ++op)
      if (windows_.all()[op].within_life()) scores[i][op] = score(op, scenario, lives[i]);
    begin_counting_anew(lives[i]);
  });
  return scores;
}

void Measurement::measure(std::span<Life> lives, std::string_view scenario, std::span<Scores> scores) const {
  if (windows_.after_maturing().duration == 0) return;
  const auto move = [&](std::span<Task> tasks, std::span<Life* const>) { simulation_.simulator().run(tasks, {}); };
  for (std::size_t first = 0, count = 0; first < lives.size(); first += count) {
    count = windows_.fitting_after_maturing(lives.subspan(first));
    const std::span<Life> group = lives.subspan(first, count);
    simulation_.run(group, windows_.after_maturing(), move);
    simulation_.simulator().workers().for_each(count, [&](std::size_t i) {
      for (std::size_t op = 0; op < places_.size() && group[i].alive(); ++op)
        if (!windows_.all()[op].within_life()) scores[first + i][op] = score(op, scenario, group[i]);
      group[i].samples = {};
    });
  }
}

std::vector<double> Measurement::score(std::size_t op, std::string_view scenario, Life& life) const {
  const Fitness& fitness = *experiment_.fitness[op].op;
  const Window& window = windows_.all()[op];
  const StoredSample &before = life.samples[window.opens], &after = life.samples[window.closes];
  if (!has_extent(std::vector{before.box.low, before.box.high})) life.end(Status::invalid, "no extent");
  if (!(after.time > before.time)) life.end(Status::invalid, "window shorter than a time step");
  if (!life.alive()) return {};
  std::vector<const StoredSample*> samples;
  for (const std::size_t sample : window.samples) samples.push_back(&life.samples[sample]);
  const Observation observation{.box = before.box,
                                .centre_before = before.centre,
                                .centre_after = after.centre,
                                .window = after.time - before.time,
                                .work = window.request.work ? Requested(after.work - before.work) : Requested(),
                                .samples = Samples(std::move(samples), window.request.channels),
                                .body = window.within_life() ? nullptr : &life.living.body,
                                .scenario = scenario,
                                .life = life.newborn.life};
  const auto measured = [&] {
    auto scores = fitness.score(observation);
    if (const std::size_t expected = places_[op].size(); scores.size() != expected)
      throw std::runtime_error("gave " + std::to_string(scores.size()) + " scores, and objectives() has " +
                               std::to_string(expected));
    return scores;
  };
  const auto scores = call_operator(experiment_.call_of(Fitness::kind, op, {.individual = life.newborn.id}), measured);
  for (std::size_t i = 0; i < scores.size(); ++i)
    if (!std::isfinite(scores[i]) && life.alive())
      life.end(Status::invalid, "fitness not finite: " + title_of(places_[op][i]).name);
  return scores;
}

double Measurement::over_tests(std::size_t op, std::size_t i, const std::vector<Scores>& tests) const {
  if (tests.size() == 1) return tests.front()[op][i];
  const std::vector<Test> all = tests_of(experiment_);
  const auto scores_in = [&](std::optional<std::size_t> scenario) {
    std::vector<double> scores;
    for (std::size_t t = 0; t < tests.size(); ++t)
      if (!tests[t][op].empty() && (!scenario || all.at(t).scenario == *scenario)) scores.push_back(tests[t][op][i]);
    return scores;
  };
  const Scored& scored = experiment_.fitness[op];
  switch (const Place& place = places_[op][i]; place.role) {
    case Role::descriptor:
      return combined(scores_in({}), Over::mean, true);
    case Role::constraint:
      return combined(scores_in({}), Over::worst, false);
    default:
      return combined(scores_in(scored.scenario), scored.over, title_of(place).maximise);
  }
}

void Measurement::set_scores(const std::vector<Scores>& tests, Life& life) const {
  if (!life.alive()) return;
  Result& result = life.result;
  for (std::size_t op = 0; op < places_.size(); ++op)
    for (std::size_t i = 0; i < places_[op].size(); ++i) {
      const bool is_objective = places_[op][i].role == Role::objective;
      const double score = over_tests(op, i, tests);
      if (!std::isfinite(score)) {  // those of the tests are finite, but their sum need not be
        result.objectives.clear();
        result.measures.clear();
        return life.end(Status::invalid, "mean of the tests not finite: " + title_of(places_[op][i]).name);
      }
      (is_objective ? result.objectives : result.measures).push_back(score);
    }
  for (std::size_t i = 0; i < result.measures.size(); ++i) {
    const Objective& measure = experiment_.measures[i];
    if (measure.role != Role::constraint || !(result.measures[i] > 0)) continue;
    life.end(Status::invalid,
             "constraint " + measure.name + ": " + short_number(result.measures[i]) + " " + measure.unit + " above 0");
    result.objectives.clear();  // but not the measures, so that selection can tell how far it is from feasible
    return;
  }
}

}  // namespace evodevo
