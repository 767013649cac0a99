#include "life/evaluation.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numeric>

#include "analysis/energy.hpp"
#include "analysis/ground.hpp"
#include "base/philox.hpp"
#include "core/skip_shift.hpp"
#include "evolution/archive_error.hpp"
#include "threads/parallel.hpp"

namespace evodevo {
namespace {

// what is left of a batch for each of several cohorts should still be worth a device's while
constexpr std::size_t smallest_cohort = 64;

/// The index of the first mark that is not before `time` (s), but for rounding.
std::size_t mark_at(const std::vector<double>& marks, double time) {
  constexpr double rounding = 1e-9;
  return static_cast<std::size_t>(std::lower_bound(marks.begin(), marks.end(), time - rounding) - marks.begin());
}

/// Whether a change may strain or lift a body. Turnover by springs without force does neither by much.
bool adds_energy(const Change& change) {
  const Edits& edits = change.edits;
  return edits.growth || !edits.changed_springs.empty() || edits.new_masses.size() > edits.removed_masses.size() ||
         change.lengths_given;
}

}  // namespace

Evaluation::Evaluation(const Experiment& experiment, Simulator& simulator)
    : Evaluation(experiment, simulator, Conditions(experiment)) {}

Evaluation::Evaluation(const Experiment& experiment, Simulator& simulator, const Conditions& conditions)
    : experiment_(experiment), simulator_(simulator), conditions_(conditions) {
  set_windows();
}

void Evaluation::set_windows() {
  const auto add_mark = [&](double time) {
    const std::size_t at = mark_at(marks_, time);
    if (at == marks_.size() || mark_at({time}, marks_[at]) == 1)
      marks_.insert(marks_.begin() + static_cast<std::ptrdiff_t>(at), time);
  };
  std::vector<Request> requests;
  for (std::size_t i = 0; i < experiment_.fitness.size(); ++i) requests.push_back(fitness_request(experiment_, i));
  const auto opens = [&](const Request& request) { return request.settle + conditions_.later; };
  const auto closes = [&](const Request& request) { return opens(request) + request.window; };
  for (const Request& request : requests) add_mark(opens(request)), add_mark(closes(request));
  for (const Request& request : requests)
    windows_.push_back({request, mark_at(marks_, opens(request)), mark_at(marks_, closes(request))});
}

std::vector<Result> Evaluation::evaluate(std::span<const Newborn> newborns, const Progress& progress) const {
  const std::size_t cohorts =
      std::clamp<std::size_t>(newborns.size() / smallest_cohort, 1, static_cast<std::size_t>(simulator_.concurrency()));
  std::vector<Result> results(newborns.size());
  std::mutex progress_mutex;
  std::vector<double> done(cohorts, 0.0);
  on_own_threads(cohorts, [&](std::size_t i) {
    // the first cohort comes first all the way, so that its last, long simulation goes on while others develop
    const Priority priority(static_cast<int>(i));
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
  const double whole = development_time() + marks_.back(), share = whole > 0 ? development_time() / whole : 0;
  std::vector<Life> lives = birth(newborns);
  develop(lives, [&](double done) { progress(done * share); });
  measure(lives, [&](double done) { progress(share + done * (1 - share)); });
  std::vector<Result> results;
  for (Life& life : lives) results.push_back(std::move(life.result));
  return results;
}

double Evaluation::development_time() const {
  const Development& development = experiment_.development;
  const int times_lived = development.control == Control::random_places ? 2 : 1;
  return times_lived * static_cast<double>(development.cycles) * development.cycle_time;
}

void Evaluation::develop(std::span<Life> lives, const Progress& progress) const {
  std::vector<std::vector<Change>> recorded(lives.size());
  for (std::size_t i = 0; i < lives.size(); ++i)
    if (const auto& record = lives[i].newborn.record) recorded[i] = record->changes();
  const bool yoked = experiment_.development.control == Control::random_places;
  std::vector<std::optional<Yoke>> yokes(lives.size());
  if (yoked) yokes = yokes_of(lives);
  const auto change = [&](std::size_t i, int cycle) {
    if (lives[i].newborn.record)
      make_again(recorded[i], lives[i], cycle);
    else if (yoked)
      change_as_in(*yokes[i], lives[i], cycle);
    else
      apply_operators(lives[i], cycle);
  };
  // what was observed then is again, so that a life with a record is the same to the bit
  live_cycles(lives, !yoked, change, progress);
}

std::vector<std::optional<Yoke>> Evaluation::yokes_of(std::span<const Life> lives) const {
  std::vector<std::size_t> yoked;
  std::vector<Life> before;
  for (std::size_t i = 0; i < lives.size(); ++i) {
    if (lives[i].newborn.record) continue;
    yoked.push_back(i);
    before.push_back(lives[i]);
  }
  const auto change = [&](std::size_t i, int cycle) { apply_operators(before[i], cycle); };
  live_cycles(before, true, change, [](double) {});
  std::vector<std::optional<Yoke>> yokes(lives.size());
  for (std::size_t i = 0; i < before.size(); ++i)
    yokes[yoked[i]].emplace(lives[yoked[i]].living.body, before[i].result.record);
  return yokes;
}

template <class Action>
void Evaluation::live_cycles(std::span<Life> lives, bool observed, const Action& change,
                             const Progress& progress) const {
  const Development& development = experiment_.development;
  for (int cycle = 1; cycle <= development.cycles; ++cycle) {
    simulate_cycle(lives, cycle, observed ? recording(experiment_, cycle) : Recording{});
    const BusyClock::Span span(develop_);
    simulator_.workers().for_each(lives.size(), [&](std::size_t i) {
      if (!lives[i].alive()) return;
      change(i, cycle);
      if (development.reset) allow_energy(lives[i], [&] { return_to_rest(lives[i]); });
      if (lives[i].living.body.springs.empty())
        lives[i].end(Status::invalid, "no springs");
      else
        choose_step(lives[i]);
    });
    progress(static_cast<double>(cycle) / static_cast<double>(development.cycles));
  }
}

void Evaluation::simulate_cycle(std::span<Life> lives, int cycle, Recording recording) const {
  const Development& development = experiment_.development;
  const auto tally = [&](std::span<Task> tasks, std::span<Life* const> alive) {
    std::vector<Rng> random;
    for (const Life* life : alive) random.push_back(stream(*life, place::stress_tallies(cycle)));
    run_with_tallies(simulator_, tasks, static_cast<std::uint64_t>(development.skip), random);
  };
  const auto record = [&](std::span<Task> tasks, std::span<Life* const>) { simulator_.run(tasks, recording); };
  if (recording.stress && development.probe == Probe::skip_shift)
    simulate(lives, development.cycle_time, tally);
  else
    simulate(lives, development.cycle_time, record);
}

template <class Action>
void Evaluation::allow_energy(Life& life, const Action& action) const {
  const auto energy = [&] { return total_energy(life.living.body, life.living.state, experiment_.scene); };
  const double before = energy();
  action();
  life.living.state.start_energy += std::max(0.0, energy() - before);
}

Box Evaluation::bounds(const LivingBody& living) const {
  Box box =
      experiment_.development.reset ? bounding_box(rest_places(living.body)) : bounding_box(living.state.position);
  if (const auto& floor = experiment_.scene.floor) box.low.z = std::max(box.low.z, floor->roughness);
  box.high.z = std::max(box.high.z, box.low.z);
  return box;
}

void Evaluation::apply_operators(Life& life, int cycle) const {
  const Development& development = experiment_.development;
  if (development.control == Control::no_change) return;
  if (development.control == Control::shuffled_stress) shuffle_records(life, cycle);
  for (std::size_t i = 0; i < development.operators.size(); ++i)
    if (development.operators[i].schedule.contains(cycle)) apply_operator(life, cycle, i);
  shed_loose_pieces(life, cycle);
}

void Evaluation::shuffle_records(Life& life, int cycle) const {
  std::vector<std::size_t> order(life.living.body.springs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  stream(life, place::stress_shuffle(cycle)).shuffle(order);
  for (const auto list : SpringRecords::lists) {
    std::vector<double>& record = life.living.*list;
    if (record.empty()) continue;
    std::vector<double> shuffled;
    for (const std::size_t i : order) shuffled.push_back(record[i]);
    record = std::move(shuffled);
  }
}

void Evaluation::apply_operator(Life& life, int cycle, std::size_t index) const {
  const auto& [op, schedule] = experiment_.development.operators[index];
  const Moment now = moment(life, cycle, schedule, devo_request(experiment_, index));
  Rng rng = stream(life, place::devo(index, cycle));
  const auto develop = [&] {
    Edits edits;
    op->develop(now, edits, rng);
    make_change(life, change_by(edits, static_cast<std::uint32_t>(index), now), now);
  };
  call_operator(experiment_, Devo::kind, index, {.individual = life.newborn.id, .cycle = cycle}, develop);
}

void Evaluation::change_as_in(Yoke& yoke, Life& life, int cycle) const {
  Rng rng = stream(life, place::random_places(cycle));
  for (const Amount& amount : yoke.amounts_after(cycle)) {
    const Moment now = moment(life, cycle, {}, {});
    make_change(life, change_by(at_random_places(amount, now, yoke.surplus, rng), amount.op, now), now);
  }
  shed_loose_pieces(life, cycle);
}

Rng Evaluation::stream(const Life& life, std::uint32_t place) const {
  return Rng(philox, {static_cast<std::uint64_t>(experiment_.seed), life.newborn.generation, life.newborn.id, place});
}

Moment Evaluation::moment(const Life& life, int cycle, const Schedule& schedule, const SpringRequest& request) const {
  const Development& development = experiment_.development;
  const LivingBody& living = life.living;
  Moment now{.body = living.body,
             .state = living.state,
             .stress = {},
             .cycle = cycle,
             .cycles = static_cast<int>(development.cycles),
             .turn = static_cast<int>(schedule.turns(cycle)),
             .turns = static_cast<int>(schedule.turns(development.cycles)),
             .time = living.state.time,
             .bounds = bounds(living),
             .mass = experiment_.world.mass,
             .resets = development.reset,
             .genome = *life.newborn.genome,
             .layout = experiment_.layout};
  show_records(living, request, now);
  return now;
}

void Evaluation::make_change(Life& life, Change change, const Moment& now) const {
  if (change.edits.empty()) return;
  const auto apply = [&] { apply_edits(life.living, change.edits, now); };
  if (adds_energy(change))
    allow_energy(life, apply);
  else
    apply();
  set_rest_lengths(change, life.living.body);
  life.result.record.add(change);
}

void Evaluation::make_again(const std::vector<Change>& changes, Life& life, int cycle) const {
  for (const Change& change : changes) {
    if (change.cycle != static_cast<std::uint32_t>(cycle)) continue;
    try {
      make_change(life, change, moment(life, cycle, {}, {}));
    } catch (const std::invalid_argument& error) {
      throw ArchiveError(life.newborn.recorded_in + ": the record of its life does not fit its body: after cycle " +
                         std::to_string(cycle) + " it " + error.what() + "; put back an undamaged copy of it");
    }
  }
}

void Evaluation::shed_loose_pieces(Life& life, int cycle) const {
  const Edits edits{.removed_masses = loose_masses(life.living.body)};
  if (edits.empty()) return;
  const Moment now = moment(life, cycle, {}, {});
  make_change(life, change_by(edits, std::nullopt, now), now);
}

void Evaluation::return_to_rest(Life& life) const {
  State& state = life.living.state;
  for (std::size_t i = 0; i < state.position.size(); ++i) {
    state.position[i] = life.living.body.masses[i].rest;
    state.velocity[i] = {};
  }
  // rest places are those on level ground
  if (const auto& floor = experiment_.scene.floor; floor && floor->rough())
    put_on_ground(state.position, experiment_.scene);
}

void Evaluation::simulate(std::span<Life> lives, double duration, const Move& move) const {
  const BusyClock::Span span(simulate_);
  std::vector<Task> tasks;
  std::vector<Life*> alive;
  for (Life& life : lives) {
    if (!life.alive()) continue;
    alive.push_back(&life);
    Task& task = tasks.emplace_back();
    task.body = &life.living.body;
    task.state = &life.living.state;
    const Pace pace = pace_over(duration, conditions_.step, life.living.longest_dt);
    task.dt = pace.dt;
    task.steps = pace.steps;
    task.preparation = std::move(life.living.preparation);
  }
  move(std::span(tasks), std::span<Life* const>(alive));
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    Life& life = *alive[i];
    life.result.spring_evaluations += tasks[i].spring_evaluations;
    static_cast<SpringRecords&>(life.living) = std::move(static_cast<SpringRecords&>(tasks[i]));
    life.living.preparation = std::move(tasks[i].preparation);
    if (!life.snapshots.empty()) life.snapshots.back().work += tasks[i].work;
    if (tasks[i].status != Status::ok) life.end(tasks[i].status, std::move(tasks[i].reason), tasks[i].ended_at);
  }
}

bool Evaluation::needs_work(std::size_t mark) const {
  for (std::size_t i = 0; i < windows_.size(); ++i)
    if (windows_[i].request.work && windows_[i].opens < mark && mark <= windows_[i].closes) return true;
  return false;
}

bool Evaluation::opens_window(std::size_t mark) const {
  return std::any_of(windows_.begin(), windows_.end(), [&](const Window& window) { return window.opens == mark; });
}

void Evaluation::measure(std::span<Life> lives, const Progress& progress) const {
  double now = 0;
  for (Life& life : lives) life.snapshots.assign(1, {});
  for (std::size_t mark = 0; mark < marks_.size(); ++mark) {
    const Recording recording{.work = needs_work(mark)};
    const auto move = [&](std::span<Task> tasks, std::span<Life* const>) { simulator_.run(tasks, recording); };
    if (marks_[mark] > now) simulate(lives, marks_[mark] - now, move);
    now = marks_[mark];
    // the snapshot in hand has gathered the work up to here; the next goes on from it
    for (Life& life : lives) {
      if (!life.alive()) continue;
      Snapshot& snapshot = life.snapshots.back();
      snapshot.box = bounding_box(life.living.state.position);
      snapshot.centre = centre_of_mass(life.living.body, life.living.state.position);
      life.snapshots.push_back(snapshot);
      if (opens_window(mark) && !has_extent(life.living.state.position)) life.end(Status::invalid, "no extent");
    }
    progress(marks_.back() > 0 ? now / marks_.back() : 1);
  }
  for (Life& life : lives) score(life);
}

void Evaluation::score(Life& life) const {
  if (!life.alive()) return;
  std::vector<double>& objectives = life.result.objectives;
  for (std::size_t i = 0; i < windows_.size(); ++i) {
    const Fitness& fitness = *experiment_.fitness[i];
    const auto& [request, opens, closes] = windows_[i];
    const Snapshot &before = life.snapshots[opens], &after = life.snapshots[closes];
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
    const auto scores = call_operator(experiment_, Fitness::kind, i, {.individual = life.newborn.id}, measured);
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
