// What a run shows while it goes on, and at its end.
#pragma once

#include <atomic>
#include <chrono>

#include "evolution/evolution.hpp"

namespace evodevo {

/// One line that is kept up to date on a terminal; one line for each generation elsewhere.
class ProgressDisplay {
 public:
  /// `past` are the generations done before this process began; `stop` is shown while it waits for a generation's end.
  ProgressDisplay(const Experiment& experiment, const std::vector<Summary>& past, const std::atomic<bool>& stop);

  Observer observer();
  /// Ends the live line.
  void finish();

  /// Of this process.
  double seconds() const;
  std::uint64_t spring_evaluations() const { return spring_evaluations_; }

 private:
  void generation_done(const Summary& summary);
  void generation_progress(double done);
  /// Estimates the time until the run has used up the evaluations that the experiment allows, s.
  double seconds_left(double evaluations) const;
  std::string line(double evaluations) const;
  void show_live(double evaluations);

  const Experiment& experiment_;
  const std::atomic<bool>& stop_;
  const bool live_;
  const std::chrono::steady_clock::time_point start_;
  std::int64_t evaluations_before_ = 0;  ///< this process
  double spring_evaluations_before_ = 0;
  Summary last_;
  std::int64_t diverged_ = 0;
  std::uint64_t spring_evaluations_ = 0;
};

/// Prints the best robot, where everything is, and the speed.
void print_outcome(const Experiment& experiment, const Archive& archive, const ProgressDisplay& progress);

/// Prints where the time of this process went.
void print_time_spent(const TimeSpent& time, const Simulator& simulator);

}  // namespace evodevo
