// The common part of `run` and `resume`.
#pragma once

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
  Channel* ranks = nullptr;      ///< that work on the run; null: this process alone
};

/// Makes the run that arguments of the command `run` ask for, without other ranks, and returns the exit code.
int make_run(const Given& given);

/// Advances a run, whose RunSpec::stop is stop_requested(), until it is finished or interrupted. Prints the outcome and
/// returns the exit code. Throws std::runtime_error if anything fails, for example the simulator's device. The message
/// gives the cause, the last complete generation and the command that continues the run.
int evolve_and_report(Run& run, const RunOutput& output = {});

}  // namespace evodevo
