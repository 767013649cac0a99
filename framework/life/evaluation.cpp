#include "life/evaluation.hpp"

#include <algorithm>
#include <iterator>
#include <memory>
#include <mutex>
#include <numeric>

#include "threads/parallel.hpp"

namespace evodevo {
namespace {

/// The number of cohorts for so many newborns, of at most `most` that a simulator takes at once. A quarter of them may
/// be small, because a small population leaves a device partly idle anyway; if there are more, each should be large.
std::size_t cohorts_for(std::size_t newborns, std::size_t most) {
  return std::clamp<std::size_t>(std::max(std::min(newborns / smallest_cohort, most / 4), newborns / large_cohort), 1,
                                 most);
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
      experiment_(experiment),
      developing_scenarios_(scenarios_that_develop(experiment)) {}

std::vector<Result> Evaluation::evaluate(std::span<const Newborn> newborns, const Progress& progress) const {
  const auto most = static_cast<std::size_t>(simulation.simulator().concurrency());
  return evaluate_in(cohorts_for(newborns.size(), most), newborns, progress);
}

std::vector<Result> Evaluation::evaluate_in(std::size_t cohorts, std::span<const Newborn> newborns,
                                            const Progress& progress) const {
  const auto begin = [&](std::size_t cohort) { return cohort * newborns.size() / cohorts; };
  std::vector<Result> results(newborns.size());
  std::vector<std::shared_ptr<const void>> announced;  // of each cohort until it has ended
  for (std::size_t i = 0; i < cohorts; ++i)
    announced.push_back(simulation.simulator().announce(begin(i + 1) - begin(i)));
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
  const double developing = development.duration() * static_cast<double>(1 + developing_scenarios_.size()),
               whole = developing + measurement.duration(), share = whole > 0 ? developing / whole : 0;
  std::vector<Life> born = birth.of(newborns);
  std::vector<Result> results;
  while (results.size() < newborns.size()) {
    const auto before = static_cast<double>(results.size());
    const std::size_t count = windows.fitting_within_life(std::span(born).subspan(results.size()));
    const auto first = born.begin() + static_cast<std::ptrdiff_t>(results.size());
    const auto group_progress = [&](double done) {
      progress((before + done * static_cast<double>(count)) / static_cast<double>(newborns.size()));
    };
    Matured group = matured({std::make_move_iterator(first), std::make_move_iterator(first + count)},
                            [&](double done) { group_progress(done * share); });
    measurement.run(group, [&](double done) { group_progress(share + done * (1 - share)); });
    for (Life& life : group.lives) results.push_back(std::move(life.result));
  }
  return results;
}

Matured Evaluation::matured(std::vector<Life> born, const Progress& progress) const {
  const auto count = static_cast<std::ptrdiff_t>(born.size());
  std::vector<Newborn> newborns;
  if (!developing_scenarios_.empty())
    for (const Life& life : born) newborns.push_back(life.newborn);
  std::vector<Life> all = std::move(born);  // they develop in one batch, which uses a device better than several
  for (const std::size_t scenario : developing_scenarios_) {
    std::vector<Life> lives = birth.of(newborns, &experiment_.scenarios[scenario]);
    std::move(lives.begin(), lives.end(), std::back_inserter(all));
  }
  development.run(all, progress);
  Matured matured;
  auto next = std::make_move_iterator(all.begin());
  matured.lives.assign(next, next + count);
  for (const std::size_t scenario : developing_scenarios_) {
    next += count;
    std::vector<Life>& lives = matured.in_scenarios[scenario];
    lives.assign(next, next + count);
    for (std::size_t i = 0; i < lives.size(); ++i)
      matured.lives[i].result.spring_evaluations += lives[i].result.spring_evaluations;
  }
  return matured;
}

}  // namespace evodevo
