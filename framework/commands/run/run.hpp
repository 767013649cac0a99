// The common part of `run` and `resume`.
#pragma once

#include <filesystem>

#include "cluster/farm.hpp"
#include "commands/run/generation_log.hpp"
#include "commands/run/time_limit.hpp"
#include "commands/shell/command.hpp"
#include "engine/run.hpp"

namespace evodevo {

/// What a run writes besides its archive, and when it has to be done.
struct RunOutput {
  GenerationLog* log = nullptr;  ///< null: none
  bool page = false;             ///< report.html in its folder, when it is finished
  TimeLimit* limit = nullptr;    ///< null: none

  /// Logs a generation that has ended, and asks for the end of the run if no further one fits into the time limit.
  /// Several threads may call it. `island` is 0 if the run has no islands.
  void generation_done(const Summary& summary, std::int64_t island = 0) const;
  /// Whether the run ends because of the time limit. Then it is verified and shown, although it is not finished.
  bool ends_by_clock() const { return limit != nullptr && limit->is_reached(); }
};

/// Begins the end of a run, when nothing is evolved any more: from now on, signals and the time limit end the process
/// at once. Returns the number of best individuals to verify, and announces it, if an individual has a fitness; `later`
/// is the command that does it later.
std::size_t begin_ending(const Experiment& experiment, const RunOutput& output, bool has_best,
                         const std::string& later);

/// Makes the run that arguments of the command `run` ask for, without other ranks, and returns the exit code.
int make_run(const Given& given);

/// Advances a run until it is finished or interrupted. `farm` evaluates for it, or is null. Prints the outcome and
/// returns the exit code. Throws std::runtime_error if anything fails, for example the simulator's device. The message
/// gives the cause, the last complete generation and the command that continues the run.
int evolve_and_report(Run& run, Farm* farm = nullptr, const RunOutput& output = {});

}  // namespace evodevo
