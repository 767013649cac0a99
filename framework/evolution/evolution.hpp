// The generation loop.
#pragma once

#include <atomic>
#include <functional>

#include "evolution/archive/archive.hpp"
#include "evolution/evaluator.hpp"

namespace evodevo {

class Migration;

/// Functions that evolve() calls to report its progress.
struct Observer {
  /// Called after each generation, which may still be being written into the archive (ArchiveWriter).
  std::function<void(const Summary&)> generation_done = [](const Summary&) {};
  /// Called with the fraction of the current generation that has been simulated, 0 to 1.
  std::function<void(double)> generation_progress = [](double) {};
};

/// Wall-clock time that a run has spent, s. Phases overlap, so the sum of the phases may exceed the whole.
struct TimeSpent {
  double whole = 0;       ///< time in evolve()
  double breed = 0;       ///< the parts of it that were spent making genomes,
  double verify = 0;      ///< verifying the front,
  double select = 0;      ///< and ranking and selecting
  double archive = 0;     ///< writing the archive, perhaps while the next generation is evaluated
  PhaseTimes evaluation;  ///< time in each phase of evaluation, without that of verification
};

/// Adds the time that this process has spent to the times in the run's record. The time of a process that is killed is
/// not recorded.
void record_time_spent(Archive& archive, const TimeSpent& time);
/// Returns the recorded times, summed over all processes that worked on the run; nullopt if no time has been recorded
/// yet.
std::optional<TimeSpent> recorded_time_spent(const Archive& archive);

/// Returns the best and the median of some scores of one objective.
BestAndMedian best_and_median(std::vector<double> scores, bool maximise);

/// Returns whether a run with these generations has used up the experiment's evaluations, spring evaluations or hours.
bool is_finished(const Settings& settings, const std::vector<Summary>& generations);

/// Continues the run in the archive until the run is finished. If `stop` is set in the meantime, finishes and commits
/// the current generation, then returns. A run that was interrupted and continued gives the same results as one that
/// was not interrupted. With a migration, the experiment is that of one island, and others have to evolve at the same
/// time; while it waits for their migrants, `stop` ends it at once.
TimeSpent evolve(const Experiment& experiment, Evaluator& evaluator, Archive& archive, const std::atomic<bool>& stop,
                 const Observer& observer, Migration* migration = nullptr);
/// Does the same in this process alone.
TimeSpent evolve(const Experiment& experiment, Simulator& simulator, Archive& archive, const std::atomic<bool>& stop,
                 const Observer& observer);

}  // namespace evodevo
