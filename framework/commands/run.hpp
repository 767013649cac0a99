// The common part of `run` and `resume`.
#pragma once

#include "evolution/archive/archive.hpp"

namespace evodevo {

/// Evolves until the run is finished or interrupted, prints the outcome and returns the exit code. Throws
/// std::runtime_error if anything fails, for example the simulator's device. The message gives the cause, the last
/// complete generation and the command that continues the run.
int evolve_and_report(const Experiment& experiment, Simulator& simulator, Archive& archive);

}  // namespace evodevo
