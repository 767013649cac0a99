// The generation loop.
#pragma once

#include <atomic>
#include <functional>

#include "evolution/archive/archive.hpp"
#include "life/evaluation.hpp"

namespace evodevo {

/// Who watches a run.
struct Observer {
  std::function<void(const Summary&)> generation_done = [](const Summary&) {};
  /// Part of the generation under way that is simulated, 0 … 1.
  std::function<void(double)> generation_progress = [](double) {};
};

/// Where a run's time went, s. Phases overlap, so they may add up to more than the whole.
struct TimeSpent {
  double whole = 0, archive = 0;
  PhaseTimes evaluation;
};

/// Adds what a process has spent to the run's record. A process that is killed adds nothing.
void record_time_spent(Archive& archive, const TimeSpent& time);
/// The sum of what was added; nothing where that is nothing yet.
std::optional<TimeSpent> recorded_time_spent(const Archive& archive);

/// Whether a run that has come to these generations has spent the experiment's evaluations or spring evaluations.
bool is_finished(const Settings& settings, const std::vector<Summary>& generations);

/// Evolves from where the archive stands until the run is finished, or `stop` is set and the generation under way is
/// committed. An archive continued gives the same as one never interrupted.
TimeSpent evolve(const Experiment& experiment, Simulator& simulator, Archive& archive, const std::atomic<bool>& stop,
                 const Observer& observer);

}  // namespace evodevo
