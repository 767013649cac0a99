// How far a run has come, and the time that it has spent.
#pragma once

#include <optional>
#include <vector>

#include "archive/archive.hpp"
#include "life/evaluation.hpp"

namespace evodevo {

/// Wall-clock time that a run has spent, s. Phases overlap, so the sum of the phases may exceed the whole.
struct TimeSpent {
  double whole = 0;       ///< time in Evolution::advance() and pause()
  double breed = 0;       ///< the parts of it that were spent making genomes,
  double verify = 0;      ///< verifying the front,
  double select = 0;      ///< and ranking and selecting
  double archive = 0;     ///< writing the archive, perhaps while the next generation is evaluated
  PhaseTimes evaluation;  ///< time in each phase of evaluation, without that of verification

  TimeSpent& operator+=(const TimeSpent& other);
};

/// Adds the time that this process has spent to the times in the run's record. The time of a process that is killed is
/// not recorded.
void record_time_spent(Archive& archive, const TimeSpent& time);
/// Returns the recorded times, summed over all processes that worked on the run; nullopt if no time has been recorded
/// yet.
std::optional<TimeSpent> recorded_time_spent(const Archive& archive);

/// Returns whether a run with these generations has used up the experiment's evaluations, spring evaluations or hours.
bool is_finished(const Settings& settings, const std::vector<Summary>& generations);
/// Returns whether the best of a run, as many as its experiment says, have been verified.
bool is_verified(const Archive& archive, const Settings& settings);

}  // namespace evodevo
