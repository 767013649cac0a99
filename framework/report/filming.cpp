#include "report/filming.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/piecewise.hpp"

namespace evodevo {
namespace {

bool is_finite(const SeenPlace& p) { return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]); }

/// Adds the present positions as a frame, unless they are not finite, as after a divergence. If the previous frame is
/// less than half a frame's duration after the one before it, the new frame replaces the previous one; this happens if
/// the runs of the simulator are shorter than frames, as between the tallies of skip-shift.
void add_frame(std::vector<Frame>& frames, const State& state, double rate) {
  Frame frame{state.time, {}};
  for (const Vec3& position : state.position) frame.positions.push_back(seen(position));
  if (!std::all_of(frame.positions.begin(), frame.positions.end(), is_finite)) return;
  const std::size_t count = frames.size();
  if (count > 1 && frames[count - 1].time - frames[count - 2].time < 0.5 / rate) frames.pop_back();
  frames.push_back(std::move(frame));
}

/// A filmed task. It is simulated in parts, each of which ends at the next frame.
class Take {
 public:
  Take(Task& task, Reel& reel, double rate, std::span<const double> cuts)
      : whole_(task), reel_(reel), rate_(rate), cuts_(cuts), seen_until_(task.state->time) {
    const double frames = std::ceil(static_cast<double>(task.steps) * task.dt * rate - 1e-9);
    parts_ = std::clamp<std::uint64_t>(static_cast<std::uint64_t>(frames), 1, std::max<std::uint64_t>(1, task.steps));
    if (reel_.steps == 0) begin_shot();
  }

  /// Returns the number of steps of the next part; the lengths of the parts differ by at most one step.
  std::uint64_t next_steps() {
    ++begun_;
    return whole_.steps * begun_ / parts_ - done_;
  }

  /// Adds the result of a part, in which stress was recorded, to the film.
  void look(const Task& part) {
    if (whole_.status == Status::ok)
      add(part);
    else
      shot().stress.clear();
    add_frame(shot().frames, *whole_.state, rate_);
    if (whole_.status == Status::ok && done_ < whole_.steps && is_cut()) begin_shot();
  }

 private:
  Shot& shot() { return reel_.film.back(); }

  void begin_shot() {
    reel_.steps = 0;
    reel_.film.push_back({*whole_.body, {}, std::vector<double>(whole_.body->springs.size(), 0.0)});
    add_frame(shot().frames, *whole_.state, rate_);
  }

  /// Whether there is a cut between the middles of the intervals before and after the present frame.
  bool is_cut() {
    const double half = static_cast<double>(whole_.steps) * whole_.dt / static_cast<double>(parts_) / 2;
    const double from = std::exchange(seen_until_, whole_.state->time + half);
    return std::any_of(cuts_.begin(), cuts_.end(), [&](double cut) { return cut > from && cut <= seen_until_; });
  }

  void add(const Task& part) {
    const auto steps = static_cast<double>(part.steps);
    done_ += part.steps;
    reel_.steps += part.steps;
    std::vector<double>& mean = shot().stress;
    for (std::size_t s = 0; s < mean.size(); ++s)
      mean[s] += (part.stress[s] - mean[s]) * (steps / static_cast<double>(reel_.steps));
  }

  Task& whole_;
  Reel& reel_;
  double rate_;                          ///< frames per simulated second
  std::span<const double> cuts_;         ///< s since birth
  double seen_until_;                    ///< time up to which cuts have been made, s since birth
  std::uint64_t parts_ = 1, begun_ = 0;  ///< number of parts, and number of parts begun so far
  std::uint64_t done_ = 0;               ///< number of steps done
};

/// Whether a run sums anything over its steps.
bool has_sums(std::span<const Task> tasks, const Recording& recording) {
  const auto sums_work = [](const SamplePoint& point) { return point.channels.work; };
  return recording.of_springs() || recording.work || std::any_of(tasks.begin(), tasks.end(), [&](const Task& task) {
           return std::any_of(task.sampled_at.begin(), task.sampled_at.end(), sums_work);
         });
}

/// The times at which windows after maturing open and close, s since birth.
std::vector<double> ends_of_windows(const Experiment& experiment) {
  const DevelopmentSettings& development = experiment.development;
  const double matured = static_cast<double>(development.cycles) * development.cycle_time;
  std::vector<double> times;
  for (std::size_t i = 0; i < experiment.fitness.size(); ++i) {
    const Request request = fitness_request(experiment, i);
    if (request.cycle) continue;
    const double opens = matured + request.settle;
    if (request.settle > 0) times.push_back(opens);
    times.push_back(opens + request.window);
  }
  return times;
}

}  // namespace

void FilmingSimulator::run(std::span<Task> tasks, Recording recording) {
  if (!has_sums(tasks, recording)) return film(tasks);
  std::vector<Task> copies(tasks.begin(), tasks.end());
  std::vector<State> states;
  for (const Task& task : tasks) states.push_back(*task.state);
  for (std::size_t i = 0; i < copies.size(); ++i) {
    copies[i].state = &states[i];
    copies[i].sampled_at.clear();
  }
  film(copies);
  simulator_.run(tasks, recording);
}

void FilmingSimulator::film(std::span<Task> tasks) {
  std::vector<std::optional<Take>> takes(tasks.size());
  for (std::size_t i = 0; i < tasks.size(); ++i)
    if (tasks[i].status == Status::ok) takes[i].emplace(tasks[i], reels_[tasks[i].body], rate_, cuts_);
  const auto next_steps = [&](std::size_t i) { return takes[i]->next_steps(); };
  const auto look = [&](std::size_t i, const Task& part) { takes[i]->look(part); };
  run_in_pieces(simulator_, tasks, {.stress = true}, next_steps, look);
}

void FilmingSimulator::cut() {
  for (auto& [body, reel] : reels_) reel.steps = 0;
}

std::vector<FilmedLife> film_lives(const Experiment& experiment, Simulator& simulator,
                                   std::span<const Newborn> newborns, const Test& test) {
  FilmingSimulator camera(simulator, filmed_frames_per_second);
  const Evaluation evaluation(experiment, camera);
  const Scenario* scenario = experiment.scenarios.empty() ? nullptr : &experiment.scenarios[test.scenario];
  Cohort matured{evaluation.birth.of(newborns, scenario != nullptr && scenario->develops ? scenario : nullptr)};
  std::vector<Life>& lives = matured.lives;
  std::vector<std::vector<std::vector<std::uint32_t>>> numbers(lives.size());  // by life and cycle
  const auto note_numbers = [&] {
    for (std::size_t i = 0; i < lives.size(); ++i) numbers[i].push_back(lives[i].living.numbers.numbers());
  };
  note_numbers();
  evaluation.development.run(lives, [&](double) {
    camera.cut();
    note_numbers();
  });
  camera.cut_at(ends_of_windows(experiment));
  if (scenario == nullptr)
    evaluation.measurement.run(matured, [](double) {});
  else
    evaluation.measurement.run_in(test, lives);
  std::vector<FilmedLife> filmed;
  for (std::size_t i = 0; i < lives.size(); ++i) {
    Film film = camera.take(lives[i].living.body);
    std::erase_if(film, [](const Shot& shot) { return shot.frames.empty(); });
    const std::size_t cycles = std::min(film.size(), static_cast<std::size_t>(experiment.development.cycles));
    for (std::size_t shot = 0; shot < film.size(); ++shot)  // a scenario may have damaged the body
      film[shot].numbers = shot < cycles ? numbers[i][shot] : lives[i].living.numbers.numbers();
    lives[i].result.records.push_back(std::move(lives[i].record));
    filmed.push_back({lives[i].newborn.life, std::move(lives[i].result), std::move(film), cycles});
  }
  return filmed;
}

}  // namespace evodevo
