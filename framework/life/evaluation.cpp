#include "life/evaluation.hpp"

#include <algorithm>
#include <iterator>
#include <memory>
#include <mutex>
#include <numeric>
#include <utility>

#include "life/measurement/combining.hpp"
#include "threads/parallel.hpp"

namespace evodevo {
namespace {

/// The number of cohorts for so many newborns, of at most `most` that a simulator takes at once. A quarter of them may
/// be small, because a small population leaves a device partly idle anyway; if there are more, each should be large.
std::size_t cohorts_for(std::size_t newborns, std::size_t most) {
  return std::clamp<std::size_t>(std::max(std::min(newborns / smallest_cohort, most / 4), newborns / large_cohort), 1,
                                 most);
}

std::size_t number_of_lives(std::span<const Newborn> newborns) {
  return std::accumulate(newborns.begin(), newborns.end(), std::size_t{0},
                         [](std::size_t sum, const Newborn& newborn) { return sum + newborn.lives; });
}

/// Returns `count` newborns of a cohort, which keeps what is left of them.
Cohort taken(Cohort& from, std::size_t first, std::size_t count) {
  const auto of = [&](std::vector<Life>& lives) {
    const auto begin = std::make_move_iterator(lives.begin() + static_cast<std::ptrdiff_t>(first));
    return std::vector<Life>(begin, begin + static_cast<std::ptrdiff_t>(count));
  };
  Cohort part{of(from.lives)};
  for (auto& [scenario, lives] : from.in_scenarios) part.in_scenarios[scenario] = of(lives);
  return part;
}

}  // namespace

Evaluation::Evaluation(const Experiment& experiment, Simulator& simulator)
    : Evaluation(experiment, simulator, Conditions(experiment)) {}

Evaluation::Evaluation(const Experiment& experiment, Simulator& simulator, const Conditions& conditions)
    : simulation(experiment, simulator, conditions),
      windows(experiment, conditions.later),
      birth(experiment, simulation),
      development(experiment, simulation, windows),
      measurement(experiment, simulation, windows),
      experiment_(experiment) {}

std::vector<Result> Evaluation::evaluate(std::span<const Newborn> newborns, const Progress& progress) const {
  const std::size_t lives = number_of_lives(newborns);
  const auto most = static_cast<std::size_t>(simulation.simulator().concurrency());
  return evaluate_in(std::min(cohorts_for(lives, most), std::max<std::size_t>(1, newborns.size())), newborns, progress);
}

std::vector<Result> Evaluation::evaluate_in(std::size_t cohorts, std::span<const Newborn> newborns,
                                            const Progress& progress) const {
  const auto begin = [&](std::size_t cohort) { return cohort * newborns.size() / cohorts; };
  std::vector<Result> results(newborns.size());
  std::vector<std::shared_ptr<const void>> announced;  // of each cohort until it has ended
  for (std::size_t i = 0; i < cohorts; ++i)
    announced.push_back(
        simulation.simulator().announce(number_of_lives(newborns.subspan(begin(i), begin(i + 1) - begin(i)))));
  std::mutex progress_mutex;
  std::vector<double> done(cohorts, 0.0);
  const int first = Priority::of_this_thread();
  on_own_threads(cohorts, [&](std::size_t i) {
    // Earlier cohorts have priority throughout. Thus the first one reaches its long final evaluation while the others
    // are still developing.
    const Priority priority(first + static_cast<int>(i));
    std::vector<Result> of_cohort =
        evaluate_cohort(newborns.subspan(begin(i), begin(i + 1) - begin(i)), [&](double part) {
          const std::lock_guard lock(progress_mutex);
          done[i] = part;
          progress(std::accumulate(done.begin(), done.end(), 0.0) / static_cast<double>(cohorts));
        });
    announced[i].reset();
    std::move(of_cohort.begin(), of_cohort.end(), results.begin() + static_cast<std::ptrdiff_t>(begin(i)));
  });
  return results;
}

std::vector<Result> Evaluation::evaluate_cohort(std::span<const Newborn> newborns, const Progress& progress) const {
  const std::size_t scenes = 1 + scenarios_that_develop(experiment_).size();
  const double developing = development.duration() * static_cast<double>(scenes),
               whole = developing + measurement.duration(), share = whole > 0 ? developing / whole : 0;
  const std::vector<Newborn> all = each_life(experiment_, newborns);
  Cohort born = birth.in_all_scenes(all);
  std::vector<Result> of_lives;
  while (of_lives.size() < all.size()) {
    const std::size_t before = of_lives.size(),
                      count = windows.fitting_within_life(std::span(born.lives).subspan(before));
    const auto group_progress = [&](double done) {
      progress((static_cast<double>(before) + done * static_cast<double>(count)) / static_cast<double>(all.size()));
    };
    Cohort group = matured(taken(born, before, count), [&](double done) { group_progress(done * share); });
    measurement.run(group, [&](double done) { group_progress(share + done * (1 - share)); });
    for (Life& life : group.lives) {
      life.result.records.push_back(std::move(life.record));
      of_lives.push_back(std::move(life.result));
    }
  }
  std::vector<Result> results;
  auto next = std::make_move_iterator(of_lives.begin());
  for (const Newborn& newborn : newborns) {
    const auto first = std::exchange(next, next + newborn.lives);
    results.push_back(of_all_lives(experiment_, {first, next}, newborn.life));
  }
  return results;
}

Cohort Evaluation::matured(Cohort born, const Progress& progress) const {
  const auto count = static_cast<std::ptrdiff_t>(born.lives.size());
  std::vector<Life> all = std::move(born.lives);  // they develop in one batch, which uses a device better than several
  for (auto& [scenario, lives] : born.in_scenarios) std::move(lives.begin(), lives.end(), std::back_inserter(all));
  development.run(all, progress);
  auto next = std::make_move_iterator(all.begin());
  born.lives.assign(next, next + count);
  for (auto& [scenario, lives] : born.in_scenarios) {
    next += count;
    lives.assign(next, next + count);
    for (std::size_t i = 0; i < lives.size(); ++i)
      born.lives[i].result.spring_evaluations += lives[i].result.spring_evaluations;
  }
  return born;
}

}  // namespace evodevo
