#include "life/measurement/measurement.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/text.hpp"
#include "life/body_building.hpp"

namespace evodevo {
namespace {

/// Returns one score for the scores of all tests.
double combined(std::vector<double> scores, Over over, bool maximise) {
  std::sort(scores.begin(), scores.end());
  const std::size_t middle = scores.size() / 2;
  switch (over) {
    case Over::worst:
      return maximise ? scores.front() : scores.back();
    case Over::median:
      return scores.size() % 2 == 1 ? scores[middle] : (scores[middle - 1] + scores[middle]) / 2;
    case Over::mean:
      break;
  }
  return std::accumulate(scores.begin(), scores.end(), 0.0) / static_cast<double>(scores.size());
}

/// Removes the samples of a life and what it has counted, so that the samples that follow do not depend on them.
void begin_counting_anew(Life& life) {
  life.samples = {};
  life.contact_time = life.work = 0;
  life.living.contact_times = {};
  life.living.version = nullptr;
}

/// Adds the name of a test to the reason for which a life ended in it.
void name_test(const Test& test, const Experiment& experiment, Life& life) {
  const Scenario& scenario = experiment.scenarios[test.scenario];
  std::string name = "scenario \"" + scenario.name + "\"";
  if (scenario.repeat > 1) name += ", repeat " + std::to_string(test.repeat + 1);
  life.result.reason = name + ": " + life.result.reason;
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

void Measurement::run(std::span<Life> lives, const Progress& progress) const {
  std::vector<Scores> within_life(lives.size());
  std::vector<std::vector<Scores>> tests(lives.size());
  for (std::size_t i = 0; i < lives.size(); ++i) {
    within_life[i] = scores_within_life(lives[i]);
    begin_counting_anew(lives[i]);
  }
  if (windows_.after_maturing().duration > 0) {
    if (experiment_.scenarios.empty())
      measure(lives, "", tests);
    else
      measure_in_scenarios(lives, tests, progress);
  }
  for (std::size_t i = 0; i < lives.size(); ++i) set_scores(within_life[i], tests[i], lives[i]);
  progress(1);
}

void Measurement::run_in(const Test& test, std::span<Life> lives) const {
  std::vector<Scores> within_life(lives.size());
  std::vector<std::vector<Scores>> scores(lives.size());
  for (std::size_t i = 0; i < lives.size(); ++i) {
    within_life[i] = scores_within_life(lives[i]);
    if (lives[i].alive()) start_scenario(test, experiment_, simulation_, lives[i]);
  }
  measure(lives, experiment_.scenarios[test.scenario].name, scores);
  for (std::size_t i = 0; i < lives.size(); ++i) set_scores(within_life[i], scores[i], lives[i]);
}

void Measurement::measure_in_scenarios(std::span<Life> lives, std::vector<std::vector<Scores>>& scores,
                                       const Progress& progress) const {
  const std::vector<Test> tests = tests_of(experiment_);
  for (std::size_t t = 0; t < tests.size(); ++t) {
    std::vector<Life> tested(lives.size());
    simulation_.simulator().workers().for_each(lives.size(), [&](std::size_t i) {
      if (lives[i].alive()) {
        tested[i] = lives[i];
        start_scenario(tests[t], experiment_, simulation_, tested[i]);
      } else {
        tested[i].end(lives[i].result.status, "");
      }
    });
    measure(tested, experiment_.scenarios[tests[t].scenario].name, scores);
    for (std::size_t i = 0; i < lives.size(); ++i) {
      if (!lives[i].alive()) continue;
      Life& life = tested[i];
      if (!life.alive()) name_test(tests[t], experiment_, life);
      lives[i].result = std::move(life.result);
      if (lives[i].alive()) add_test(tests[t], scores[i].back(), lives[i]);
    }
    progress(static_cast<double>(t + 1) / static_cast<double>(tests.size()));
  }
}

void Measurement::add_test(const Test& test, const Scores& scores, Life& life) const {
  for (std::size_t op = 0; op < scores.size(); ++op)
    for (std::size_t i = 0; i < scores[op].size(); ++i)
      if (const Place& place = places_[op][i]; place.role == Role::objective)
        life.result.tests.push_back({test.scenario, test.repeat, place.index, scores[op][i]});
}

void Measurement::measure(std::span<Life> lives, std::string_view scenario,
                          std::vector<std::vector<Scores>>& scores) const {
  const auto move = [&](std::span<Task> tasks, std::span<Life* const>) { simulation_.simulator().run(tasks, {}); };
  for (std::size_t first = 0, count = 0; first < lives.size(); first += count) {
    count = measured_at_once(lives.subspan(first));
    const std::span<Life> group = lives.subspan(first, count);
    for (Life& life : group) begin_counting_anew(life);
    simulation_.run(group, windows_.after_maturing(), move);
    simulation_.simulator().workers().for_each(count, [&](std::size_t i) {
      Scores of_life(windows_.all().size());
      for (std::size_t op = 0; op < of_life.size() && group[i].alive(); ++op)
        if (!windows_.all()[op].within_life()) of_life[op] = score(op, scenario, group[i]);
      if (group[i].alive()) scores[first + i].push_back(std::move(of_life));
      group[i].samples = {};
    });
  }
}

std::size_t Measurement::measured_at_once(std::span<const Life> lives) const {
  double bytes = 0;
  std::size_t count = 0;
  for (; count < lives.size(); ++count) {
    const Body& body = lives[count].living.body;
    bytes += windows_.bytes_after_maturing(body.masses.size(), body.springs.size());
    if (bytes > most_sample_bytes) break;
  }
  return std::max<std::size_t>(count, 1);
}

Measurement::Scores Measurement::scores_within_life(Life& life) const {
  Scores scores(windows_.all().size());
  for (std::size_t op = 0; op < scores.size() && life.alive(); ++op)
    if (windows_.all()[op].within_life()) scores[op] = score(op, "", life);
  return scores;
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
                                .scenario = scenario};
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
      if (!scenario || all[t].scenario == *scenario) scores.push_back(tests[t][op][i]);
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

void Measurement::set_scores(const Scores& within_life, const std::vector<Scores>& tests, Life& life) const {
  if (!life.alive()) return;
  Result& result = life.result;
  for (std::size_t op = 0; op < places_.size(); ++op)
    for (std::size_t i = 0; i < places_[op].size(); ++i) {
      const double score = windows_.all()[op].within_life() ? within_life[op][i] : over_tests(op, i, tests);
      (places_[op][i].role == Role::objective ? result.objectives : result.measures).push_back(score);
    }
  for (std::size_t i = 0; i < result.measures.size(); ++i) {
    const Objective& measure = experiment_.measures[i];
    if (measure.role != Role::constraint || !(result.measures[i] > 0)) continue;
    life.end(Status::invalid,
             "constraint " + measure.name + ": " + short_number(result.measures[i]) + " " + measure.unit + " above 0");
    result.objectives.clear();
    result.measures.clear();
    return;
  }
}

}  // namespace evodevo
