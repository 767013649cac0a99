#include "report/filming.hpp"

#include <algorithm>
#include <cmath>

namespace evodevo {
namespace {

/// What a divergence leaves cannot be shown.
void add_frame(Shot& shot, const State& state) {
  Frame frame{state.time, {}};
  for (const Vec3& place : state.position) frame.places.push_back(seen(place));
  const bool finite = std::all_of(frame.places.begin(), frame.places.end(), [](const SeenPlace& p) {
    return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
  });
  if (finite) shot.frames.push_back(std::move(frame));
}

/// A task that is done in parts.
struct InParts {
  Task* whole;
  Task part;
  Shot* shot;
  std::uint64_t parts;

  /// The steps up to the i-th boundary, as evenly as whole steps allow.
  std::uint64_t boundary(std::uint64_t i) const { return whole->steps * std::min(i, parts) / parts; }
  bool wants(std::uint64_t i) const { return part.status == Status::ok && i < parts && whole->steps > 0; }

  void prepare(std::uint64_t i) { part.steps = boundary(i + 1) - boundary(i); }

  void gather() {
    whole->work += part.work;
    whole->spring_evaluations += part.spring_evaluations;
    for (std::size_t s = 0; s < part.stress.size(); ++s)
      shot->stress[s] += part.stress[s] * static_cast<double>(part.steps) / static_cast<double>(whole->steps);
    add_frame(*shot, *part.state);
  }

  void finish(bool stress_wanted) {
    whole->preparation = std::move(part.preparation);
    whole->status = part.status;
    whole->ended_at = part.ended_at;
    whole->reason = std::move(part.reason);
    if (part.status != Status::ok) shot->stress.clear();
    if (stress_wanted) whole->stress = shot->stress;
  }
};

InParts begin(Task& task, Film& film, double rate) {
  Shot& shot = film.emplace_back(Shot{*task.body, {}, std::vector<double>(task.body->springs.size(), 0.0)});
  add_frame(shot, *task.state);
  InParts in_parts{&task, {}, &shot, 1};
  Task& part = in_parts.part;
  part.body = task.body;
  part.state = task.state;
  part.dt = task.dt;
  part.preparation = std::move(task.preparation);
  part.status = task.status;
  const auto frames = static_cast<std::uint64_t>(std::ceil(static_cast<double>(task.steps) * task.dt * rate - 1e-9));
  in_parts.parts = std::clamp<std::uint64_t>(frames, 1, std::max<std::uint64_t>(1, task.steps));
  return in_parts;
}

/// The i-th shot comes after as many cycles, and all behind the last cycle show the same body.
void number_masses(Film& film, const LifeRecord& record) {
  if (film.empty()) return;
  MassNumbers numbers(film.front().body.masses.size());
  const std::vector<Change> changes = record.changes();
  auto next = changes.begin();
  for (std::size_t i = 0; i < film.size(); ++i) {
    for (; next != changes.end() && next->cycle <= i; ++next) {
      numbers.come(next->edits);
      numbers.go(next->edits);
    }
    film[i].numbers = numbers.all();
  }
}

}  // namespace

void FilmingSimulator::run(std::span<Task> tasks, Recording recording) {
  std::vector<InParts> all;
  std::uint64_t most = 0;
  for (Task& task : tasks) {
    all.push_back(begin(task, films_[task.body], rate_));
    most = std::max(most, all.back().parts);
  }
  for (std::uint64_t i = 0; i < most; ++i) {
    std::vector<Task> parts;
    std::vector<InParts*> owners;
    for (InParts& in_parts : all) {
      if (!in_parts.wants(i)) continue;
      in_parts.prepare(i);
      owners.push_back(&in_parts);
      parts.push_back(std::move(in_parts.part));
      parts.back().work = 0;
      parts.back().spring_evaluations = 0;
    }
    simulator_.run(parts, {.stress = true, .work = recording.work});
    for (std::size_t k = 0; k < parts.size(); ++k) {
      owners[k]->part = std::move(parts[k]);
      owners[k]->gather();
    }
  }
  for (InParts& in_parts : all) in_parts.finish(recording.stress);
}

std::vector<FilmedLife> film_lives(const Experiment& experiment, Simulator& simulator,
                                   std::span<const Newborn> newborns) {
  FilmingSimulator camera(simulator, filmed_frames_per_second);
  const Evaluation evaluation(experiment, camera);
  std::vector<Life> lives = evaluation.birth(newborns);
  evaluation.develop(lives, [](double) {});
  evaluation.measure(lives, [](double) {});
  std::vector<FilmedLife> filmed;
  for (Life& life : lives) {
    Film film = camera.take(life.living.body);
    number_masses(film, life.result.record);
    const std::size_t cycles = std::min(film.size(), static_cast<std::size_t>(experiment.development.cycles));
    filmed.push_back({std::move(life.result), std::move(film), cycles});
  }
  return filmed;
}

}  // namespace evodevo
