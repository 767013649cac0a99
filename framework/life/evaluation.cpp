#include "life/evaluation.hpp"

#include <algorithm>
#include <mutex>
#include <numeric>

#include "threads/parallel.hpp"

namespace evodevo {
namespace {

// smallest number of bodies in a cohort if there are several; smaller cohorts would use a device inefficiently
constexpr std::size_t smallest_cohort = 64;

}  // namespace

Evaluation::Evaluation(const Experiment& experiment, Simulator& simulator)
    : Evaluation(experiment, simulator, Conditions(experiment)) {}

Evaluation::Evaluation(const Experiment& experiment, Simulator& simulator, const Conditions& conditions)
    : simulation(experiment, simulator, conditions),
      windows(experiment, conditions.later),
      birth(experiment, simulation),
      development(experiment, simulation, windows),
      measurement(experiment, simulation, windows) {}

std::vector<Result> Evaluation::evaluate(std::span<const Newborn> newborns, const Progress& progress) const {
  const std::size_t cohorts = std::clamp<std::size_t>(newborns.size() / smallest_cohort, 1,
                                                      static_cast<std::size_t>(simulation.simulator().concurrency()));
  std::vector<Result> results(newborns.size());
  std::mutex progress_mutex;
  std::vector<double> done(cohorts, 0.0);
  on_own_threads(cohorts, [&](std::size_t i) {
    // Earlier cohorts have priority throughout. Thus the first one reaches its long final evaluation while the others
    // are still developing.
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
  const double developing = development.duration(), whole = developing + measurement.duration(),
               share = whole > 0 ? developing / whole : 0;
  std::vector<Life> lives = birth.of(newborns);
  development.run(lives, [&](double done) { progress(done * share); });
  measurement.run(lives, [&](double done) { progress(share + done * (1 - share)); });
  std::vector<Result> results;
  for (Life& life : lives) results.push_back(std::move(life.result));
  return results;
}

}  // namespace evodevo
