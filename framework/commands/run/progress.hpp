// The display of a run's progress, and of its outcome.
#pragma once

#include <atomic>
#include <chrono>

#include "cluster/farm.hpp"
#include "commands/shell/output/terminal.hpp"
#include "evolution/evolution.hpp"

namespace evodevo {

/// Displays progress: on a terminal, as one line that is kept up to date and is no wider than the terminal; elsewhere,
/// as one line for each generation.
class ProgressDisplay {
 public:
  /// `past` has the summaries of the generations that earlier processes made. If `stop` is set, the display says that
  /// the run will stop after the current generation. With a farm, which may be null, it tells how idle the ranks are,
  /// and writes a line for each generation, since a launcher lets each output look like a terminal.
  ProgressDisplay(const Experiment& experiment, const std::vector<Summary>& past, const std::atomic<bool>& stop,
                  const Farm* farm = nullptr);

  Observer observer();
  /// Ends the line on the terminal.
  void finish();

  /// Wall-clock time [s] and spring evaluations of this process.
  double seconds() const;
  std::uint64_t spring_evaluations() const { return spring_evaluations_; }

 private:
  void generation_done(const Summary& summary);
  void generation_progress(double done);
  /// Estimates the time until the run has used up the evaluations that the experiment allows, s.
  double seconds_left(double evaluations) const;
  std::vector<LinePart> parts(double evaluations) const;
  std::string line(std::size_t columns) const;
  void show_live();

  const Experiment& experiment_;
  const std::atomic<bool>& stop_;
  const Farm* const farm_;
  const bool live_;
  const std::chrono::steady_clock::time_point start_;
  std::int64_t evaluations_before_ = 0;   ///< evaluations by earlier processes
  double spring_evaluations_before_ = 0;  ///< spring evaluations by earlier processes
  double seconds_before_ = 0;             ///< time of their generations
  Summary last_;
  double evaluations_ = 0;  ///< including those of the generation under way
  LiveLine live_line_;
  std::int64_t diverged_ = 0, refused_ = 0;
  std::uint64_t spring_evaluations_ = 0;
};

/// Returns a time such as "3 min 20 s".
std::string duration_text(double seconds);

/// Prints the best robot and the folder of the run. Returns false after it has said that no robot has a fitness.
bool print_best(const Experiment& experiment, const Archive& archive);

/// Prints the speed at which a number of spring evaluations took some seconds, of which some were spent verifying the
/// front, whose spring evaluations are not counted.
void print_speed(double spring_evaluations, double seconds, double verifying = 0);

/// Prints what each rank has contributed to a run that took `whole` seconds.
void print_shares(const std::vector<Share>& shares, double whole);

/// Prints how this process has spent its time.
void print_time_spent(const TimeSpent& time, const Simulator& simulator);

}  // namespace evodevo
