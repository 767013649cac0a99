// The display of the progress of a run with islands.
#pragma once

#include <atomic>
#include <chrono>
#include <mutex>
#include <vector>

#include "commands/shell/output/terminal.hpp"
#include "evolution/evolution.hpp"

namespace evodevo {

/// Displays the progress of all islands together: on a terminal, as one line that is kept up to date; elsewhere, as one
/// line for as many generations as there are islands. Several threads may use it.
class IslandsProgress {
 public:
  /// `past` has the summaries of the generations that each island has completed already. `evaluations` is the number of
  /// evaluations in the whole run, and `is_live` says whether the line may be rewritten.
  IslandsProgress(const Experiment& island, std::int64_t evaluations, const std::vector<std::vector<Summary>>& past,
                  const std::atomic<bool>& stop, bool is_live);

  /// An island, numbered from 1, has completed a generation.
  void generation_done(std::int64_t island, const Summary& summary);
  /// Ends the line on the terminal.
  void finish();

  /// Wall-clock time [s] and spring evaluations since this object was made.
  double seconds() const;
  std::uint64_t spring_evaluations() const { return spring_evaluations_; }

 private:
  std::int64_t evaluations_done() const;
  std::string line(std::size_t columns) const;
  void show();

  const Experiment& island_;
  const std::int64_t evaluations_;
  const std::atomic<bool>& stop_;
  const bool is_live_;
  const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::mutex mutex_;
  std::vector<std::optional<Summary>> last_;  ///< of each island
  std::int64_t before_ = 0;                   ///< evaluations by earlier processes
  std::size_t generations_ = 0;               ///< completed since this object was made, on all islands
  LiveLine live_line_;
  std::uint64_t spring_evaluations_ = 0;
};

}  // namespace evodevo
