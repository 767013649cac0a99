// The display of a run's progress, and of its outcome.
#pragma once

#include <atomic>
#include <chrono>
#include <memory>

#include "commands/shell/output/terminal.hpp"
#include "engine/run.hpp"

namespace evodevo {

/// Displays the progress of a run: on a terminal, as one line that is kept up to date and is no wider than the
/// terminal; elsewhere, as lines. If ranks work on the run, writes lines, too, since a launcher lets each output look
/// like a terminal.
class ProgressDisplay {
 public:
  virtual ~ProgressDisplay() = default;

  /// Another generation has been made; see Observer.
  virtual void generation_done(std::int64_t island, const Summary& summary) = 0;
  /// The fraction of the current generation that has been simulated.
  virtual void generation_progress(double) {}
  /// Ends the line on the terminal.
  virtual void finish() = 0;

  /// Wall-clock time [s] and spring evaluations since this object was made.
  double seconds() const;
  std::uint64_t spring_evaluations() const { return spring_evaluations_; }

 protected:
  std::uint64_t spring_evaluations_ = 0;

 private:
  const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Returns what displays the progress of a run, which must outlive it. If `stop` is set, the display says that the run
/// will stop after the current generation.
std::unique_ptr<ProgressDisplay> progress_of(const Run& run, const std::atomic<bool>& stop, bool has_ranks);

/// Displays the progress of a run with one population; elsewhere than on a terminal, as one line for each generation.
/// If ranks evaluate for it, tells how idle they are.
class PopulationProgress final : public ProgressDisplay {
 public:
  PopulationProgress(const Run& run, const std::atomic<bool>& stop, bool is_live);

  void generation_done(std::int64_t island, const Summary& summary) override;
  void generation_progress(double done) override;
  void finish() override;

 private:
  /// Estimates the time until the run has used up the evaluations that the experiment allows, s.
  double seconds_left(double evaluations) const;
  std::vector<LinePart> parts(double evaluations) const;
  std::string line(std::size_t columns) const;
  void show_live();

  const Run& run_;
  const Experiment& experiment_;
  const std::atomic<bool>& stop_;
  const bool live_;
  std::int64_t evaluations_before_ = 0;   ///< evaluations by earlier processes
  double spring_evaluations_before_ = 0;  ///< spring evaluations by earlier processes
  double seconds_before_ = 0;             ///< time of their generations
  Summary last_;
  double evaluations_ = 0;  ///< including those of the generation under way
  LiveLine live_line_;
  std::int64_t diverged_ = 0, refused_ = 0;
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
