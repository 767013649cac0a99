#include "life/measurement.hpp"

#include <algorithm>
#include <cmath>

#include "life/body_building.hpp"

namespace evodevo {
namespace {

/// Returns the index of the first mark at or after `time` (s), apart from rounding.
std::size_t mark_at(const std::vector<double>& marks, double time) {
  constexpr double rounding = 1e-9;
  return static_cast<std::size_t>(std::lower_bound(marks.begin(), marks.end(), time - rounding) - marks.begin());
}

}  // namespace

Measurement::Measurement(const Experiment& experiment, const LifeSimulation& simulation, const Conditions& conditions)
    : experiment_(experiment), simulation_(simulation) {
  set_windows(conditions.later);
}

void Measurement::set_windows(double later) {
  const auto add_mark = [&](double time) {
    const std::size_t at = mark_at(marks_, time);
    if (at == marks_.size() || mark_at({time}, marks_[at]) == 1)
      marks_.insert(marks_.begin() + static_cast<std::ptrdiff_t>(at), time);
  };
  std::vector<Request> requests;
  for (std::size_t i = 0; i < experiment_.fitness.size(); ++i) requests.push_back(fitness_request(experiment_, i));
  const auto opens = [&](const Request& request) { return request.settle + later; };
  const auto closes = [&](const Request& request) { return opens(request) + request.window; };
  for (const Request& request : requests) add_mark(opens(request)), add_mark(closes(request));
  for (const Request& request : requests)
    windows_.push_back({request, mark_at(marks_, opens(request)), mark_at(marks_, closes(request))});
}

bool Measurement::needs_work(std::size_t mark) const {
  for (std::size_t i = 0; i < windows_.size(); ++i)
    if (windows_[i].request.work && windows_[i].opens < mark && mark <= windows_[i].closes) return true;
  return false;
}

bool Measurement::opens_window(std::size_t mark) const {
  return std::any_of(windows_.begin(), windows_.end(), [&](const Window& window) { return window.opens == mark; });
}

void Measurement::run(std::span<Life> lives, const Progress& progress) const {
  std::vector<Snapshots> snapshots(lives.size());
  for (Life& life : lives) life.work = 0;
  double now = 0;
  for (std::size_t mark = 0; mark < marks_.size(); ++mark) {
    const Recording recording{.work = needs_work(mark)};
    const auto move = [&](std::span<Task> tasks, std::span<Life* const>) {
      simulation_.simulator().run(tasks, recording);
    };
    if (marks_[mark] > now) simulation_.run(lives, marks_[mark] - now, move);
    now = marks_[mark];
    for (std::size_t i = 0; i < lives.size(); ++i) {
      Life& life = lives[i];
      if (!life.alive()) continue;
      const std::vector<Vec3>& positions = life.living.state.position;
      snapshots[i].push_back({bounding_box(positions), centre_of_mass(life.living.body, positions), life.work});
      if (opens_window(mark) && !has_extent(positions)) life.end(Status::invalid, "no extent");
    }
    progress(marks_.back() > 0 ? now / marks_.back() : 1);
  }
  for (std::size_t i = 0; i < lives.size(); ++i) score(lives[i], snapshots[i]);
}

void Measurement::score(Life& life, const Snapshots& snapshots) const {
  if (!life.alive()) return;
  std::vector<double>& objectives = life.result.objectives;
  for (std::size_t i = 0; i < windows_.size(); ++i) {
    const Fitness& fitness = *experiment_.fitness[i];
    const auto& [request, opens, closes] = windows_[i];
    const Snapshot &before = snapshots[opens], &after = snapshots[closes];
    const Observation observation{.box = before.box,
                                  .centre_before = before.centre,
                                  .centre_after = after.centre,
                                  .window = request.window,
                                  .work = request.work ? after.work - before.work : 0};
    const auto measured = [&] {
      auto scores = fitness.score(observation);
      if (const std::size_t expected = fitness.objectives().size(); scores.size() != expected)
        throw std::runtime_error("gave " + std::to_string(scores.size()) + " scores for " + std::to_string(expected) +
                                 " objectives");
      return scores;
    };
    const auto scores = call_operator(experiment_.call_of(Fitness::kind, i, {.individual = life.newborn.id}), measured);
    objectives.insert(objectives.end(), scores.begin(), scores.end());
  }
  if (objectives.size() != experiment_.objectives.size())
    throw std::runtime_error("the fitness operators gave " + std::to_string(objectives.size()) + " numbers for " +
                             std::to_string(experiment_.objectives.size()) + " objectives");
  for (std::size_t i = 0; i < objectives.size(); ++i) {
    if (std::isfinite(objectives[i])) continue;
    const std::string reason = "fitness not finite: " + experiment_.objectives[i].name;
    objectives.clear();
    return life.end(Status::invalid, reason);
  }
}

}  // namespace evodevo
