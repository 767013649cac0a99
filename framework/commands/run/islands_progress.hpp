// The display of the progress of a run with islands.
#pragma once

#include <atomic>
#include <optional>
#include <vector>

#include "commands/run/progress.hpp"

namespace evodevo {

/// Displays the progress of all islands together: on a terminal, as one line that is kept up to date; elsewhere, as one
/// line for as many generations as there are islands.
class IslandsProgress final : public ProgressDisplay {
 public:
  IslandsProgress(const Run& run, const std::atomic<bool>& stop, bool is_live);

  void generation_done(std::int64_t island, const Summary& summary) override;
  void finish() override;

 private:
  std::int64_t evaluations_done() const;
  std::string line(std::size_t columns) const;
  void show();

  const Experiment& island_;
  std::int64_t evaluations_ = 0;  ///< of the whole run
  const std::atomic<bool>& stop_;
  const bool is_live_;
  std::vector<std::optional<Summary>> last_;  ///< of each island
  std::int64_t before_ = 0;                   ///< evaluations by earlier processes
  std::size_t generations_ = 0;               ///< completed since this object was made, on all islands
  LiveLine live_line_;
};

}  // namespace evodevo
