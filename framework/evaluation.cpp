#include "evaluation.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numeric>

#include "body_building.hpp"
#include "parallel.hpp"
#include "philox.hpp"

namespace evodevo {
namespace {

// what is left of a batch for each of several cohorts should still be worth a device's while
constexpr std::size_t smallest_cohort = 64;

void end(Life& life, Status status, std::string reason, double ended_at = 0) {
  life.result.status = status;
  life.result.reason = std::move(reason);
  life.result.ended_at = ended_at;
}

/// First and last step of a fitness' window, counted from the start of the final evaluation.
std::pair<std::uint64_t, std::uint64_t> window_steps(const Request& request, double dt) {
  return {steps_in(request.settle, dt), steps_in(request.settle + request.window, dt)};
}

}  // namespace

Evaluation::Evaluation(const Experiment& experiment, Simulator& simulator)
    : experiment_(experiment), simulator_(simulator), marks_(marks()), workers_(static_cast<int>(experiment.threads)) {}

std::vector<Result> Evaluation::evaluate(std::span<const Newborn> newborns, const Progress& progress) const {
  const std::size_t cohorts =
      std::clamp<std::size_t>(newborns.size() / smallest_cohort, 1, static_cast<std::size_t>(simulator_.concurrency()));
  std::vector<Result> results(newborns.size());
  std::mutex progress_mutex;
  std::vector<double> done(cohorts, 0.0);
  on_own_threads(cohorts, [&](std::size_t i) {
    // the first cohort comes first all the way, so that its last, long simulation goes on while others develop
    const Turn turn(static_cast<int>(i));
    const std::size_t begin = i * newborns.size() / cohorts, end = (i + 1) * newborns.size() / cohorts;
    std::vector<Result> of_cohort = evaluate_cohort(newborns.subspan(begin, end - begin), [&](double part) {
      const std::lock_guard lock(progress_mutex);
      done[i] = part;
      progress(std::accumulate(done.begin(), done.end(), 0.0) / static_cast<double>(cohorts));
    });
    std::move(of_cohort.begin(), of_cohort.end(), results.begin() + static_cast<std::ptrdiff_t>(begin));
  });
  return results;
}

std::vector<Result> Evaluation::evaluate_cohort(std::span<const Newborn> newborns, const Progress& progress) const {
  const auto development = static_cast<double>(development_steps()), measurement = static_cast<double>(marks_.back());
  const double share = development / std::max(1.0, development + measurement);
  std::vector<Life> lives = birth(newborns);
  develop(lives, [&](double done) { progress(done * share); });
  measure(lives, [&](double done) { progress(share + done * (1 - share)); });
  std::vector<Result> results;
  for (Life& life : lives) {
    score(life);
    results.push_back(std::move(life.result));
  }
  return results;
}

std::vector<Life> Evaluation::birth(std::span<const Newborn> newborns) const {
  const BusyClock::Span span(decode_);
  std::vector<Blueprint> blueprints(newborns.size());
  workers_.for_each(newborns.size(), [&](std::size_t i) {
    blueprints[i] = call_operator([&] { return experiment_.title(Encoding::kind, 0) + ": "; },
                                  [&] { return experiment_.encoding->decode(*newborns[i].genome, experiment_.world); });
  });
  std::vector<BuiltBody> built = build_bodies(std::move(blueprints), simulator_.neighbours(), workers_);
  std::vector<Life> lives(newborns.size());
  workers_.for_each(lives.size(), [&](std::size_t i) {
    Life& life = lives[i];
    life.newborn = newborns[i];
    if (!built[i].failure.empty()) return end(life, Status::invalid, std::move(built[i].failure));
    life.living.body = std::move(built[i].body);
    life.living.state = state_at_birth(life.living.body, experiment_.scene);
    check_step(life);
  });
  return lives;
}

std::uint64_t Evaluation::development_steps() const {
  const Development& development = experiment_.development;
  return static_cast<std::uint64_t>(development.cycles) * steps_in(development.cycle_time, experiment_.stepping.dt);
}

void Evaluation::develop(std::span<Life> lives, const Progress& progress) const {
  const Development& development = experiment_.development;
  const std::uint64_t steps = steps_in(development.cycle_time, experiment_.stepping.dt);
  for (int cycle = 1; cycle <= development.cycles; ++cycle) {
    simulate(lives, steps, {.stress = !development.operators.empty()});
    const BusyClock::Span span(develop_);
    workers_.for_each(lives.size(), [&](std::size_t i) {
      if (!lives[i].alive()) return;
      apply_operators(lives[i], cycle);
      if (development.reset) return_to_rest(lives[i]);
      if (!development.operators.empty()) check_step(lives[i]);
    });
    progress(static_cast<double>(cycle) / static_cast<double>(development.cycles));
  }
}

Box Evaluation::bounds(const LivingBody& living) const {
  std::vector<Vec3> places = living.state.position;
  if (experiment_.development.reset)
    for (std::size_t i = 0; i < places.size(); ++i) places[i] = living.body.masses[i].rest;
  Box box = bounding_box(places);
  if (experiment_.scene.floor) box.low.z = std::max(box.low.z, 0.0);
  box.high.z = std::max(box.high.z, box.low.z);
  return box;
}

void Evaluation::apply_operators(Life& life, int cycle) const {
  const Development& development = experiment_.development;
  LivingBody& living = life.living;
  for (std::size_t i = 0; i < development.operators.size(); ++i) {
    const Moment now{.body = living.body,
                     .state = living.state,
                     .stress = living.stress,
                     .cycle = cycle,
                     .cycles = static_cast<int>(development.cycles),
                     .time = static_cast<double>(living.state.steps) * experiment_.stepping.dt,
                     .bounds = bounds(living),
                     .mass = experiment_.world.mass,
                     .resets = development.reset,
                     .genome = *life.newborn.genome,
                     .layout = experiment_.layout};
    Rng rng(philox, {static_cast<std::uint64_t>(experiment_.seed), life.newborn.generation, life.newborn.id,
                     place::devo(i, cycle)});
    const auto where = [&] {
      return experiment_.title(Devo::kind, i) + ", individual " + std::to_string(life.newborn.id) + ", cycle " +
             std::to_string(cycle) + ": ";
    };
    call_operator(where, [&] {
      Edits edits;
      development.operators[i]->develop(now, edits, rng);
      apply_edits(living, edits, now);
    });
  }
}

void Evaluation::check_step(Life& life) const {
  if (life.living.body.springs.empty()) return end(life, Status::invalid, "no springs");
  std::string failure =
      step_failure(life.living.body, life.living.state.position, experiment_.scene, experiment_.stepping);
  if (!failure.empty()) end(life, Status::invalid, std::move(failure));
}

void Evaluation::return_to_rest(Life& life) const {
  State& state = life.living.state;
  for (std::size_t i = 0; i < state.position.size(); ++i) {
    state.position[i] = life.living.body.masses[i].rest;
    state.velocity[i] = {};
  }
}

void Evaluation::simulate(std::span<Life> lives, std::uint64_t steps, Recording recording) const {
  const BusyClock::Span span(simulate_);
  std::vector<Task> tasks;
  std::vector<Life*> alive;
  for (Life& life : lives) {
    if (!life.alive()) continue;
    alive.push_back(&life);
    Task& task = tasks.emplace_back();
    task.body = &life.living.body;
    task.state = &life.living.state;
    task.preparation = std::move(life.living.preparation);
  }
  simulator_.run(tasks, steps, recording);
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    Life& life = *alive[i];
    life.result.spring_evaluations += tasks[i].spring_evaluations;
    life.living.stress = std::move(tasks[i].stress);
    life.living.preparation = std::move(tasks[i].preparation);
    if (recording.work) life.snapshots.back().work += tasks[i].work;
    if (tasks[i].status != Status::ok) end(life, tasks[i].status, std::move(tasks[i].reason), tasks[i].ended_at);
  }
}

std::vector<std::uint64_t> Evaluation::marks() const {
  std::vector<std::uint64_t> marks;
  for (const auto& fitness : experiment_.fitness) {
    const auto [from, to] = window_steps(fitness->observes(), experiment_.stepping.dt);
    marks.insert(marks.end(), {from, to});
  }
  std::sort(marks.begin(), marks.end());
  marks.erase(std::unique(marks.begin(), marks.end()), marks.end());
  return marks;
}

bool Evaluation::needs_work(std::uint64_t from, std::uint64_t to) const {
  return std::any_of(experiment_.fitness.begin(), experiment_.fitness.end(), [&](const auto& fitness) {
    const Request request = fitness->observes();
    const auto [opens, closes] = window_steps(request, experiment_.stepping.dt);
    return request.work && opens <= from && to <= closes;
  });
}

void Evaluation::measure(std::span<Life> lives, const Progress& progress) const {
  std::uint64_t now = 0;
  for (Life& life : lives) life.snapshots.assign(1, {});
  for (const std::uint64_t mark : marks_) {
    if (mark > now) simulate(lives, mark - now, {.work = needs_work(now, mark)});
    now = mark;
    // the snapshot in hand has gathered the work up to here; the next goes on from it
    for (Life& life : lives) {
      if (!life.alive()) continue;
      Snapshot& snapshot = life.snapshots.back();
      snapshot.box = bounding_box(life.living.state.position);
      snapshot.centre = centre_of_mass(life.living.body, life.living.state.position);
      life.snapshots.push_back(snapshot);
    }
    progress(static_cast<double>(mark) / std::max(1.0, static_cast<double>(marks_.back())));
  }
}

void Evaluation::score(Life& life) const {
  if (!life.alive()) return;
  const auto at = [&](std::uint64_t mark) -> const Snapshot& {
    const auto found = std::lower_bound(marks_.begin(), marks_.end(), mark);
    return life.snapshots[static_cast<std::size_t>(found - marks_.begin())];
  };
  std::vector<double>& objectives = life.result.objectives;
  for (std::size_t i = 0; i < experiment_.fitness.size(); ++i) {
    const auto& fitness = experiment_.fitness[i];
    const Request request = fitness->observes();
    const auto [from, to] = window_steps(request, experiment_.stepping.dt);
    const Snapshot &before = at(from), &after = at(to);
    const Observation observation{.box = before.box,
                                  .centre_before = before.centre,
                                  .centre_after = after.centre,
                                  .window = request.window,
                                  .work = request.work ? after.work - before.work : 0};
    const auto scores = call_operator([&] { return experiment_.title(Fitness::kind, i) + ": "; },
                                      [&] { return fitness->score(observation); });
    objectives.insert(objectives.end(), scores.begin(), scores.end());
  }
  if (objectives.size() != experiment_.objectives.size())
    throw std::runtime_error("the fitness operators gave " + std::to_string(objectives.size()) + " numbers for " +
                             std::to_string(experiment_.objectives.size()) + " objectives");
  for (std::size_t i = 0; i < objectives.size(); ++i) {
    if (std::isfinite(objectives[i])) continue;
    const std::string reason = "fitness not finite: " + experiment_.objectives[i].name;
    objectives.clear();
    return end(life, Status::invalid, reason);
  }
}

}  // namespace evodevo
