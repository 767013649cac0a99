// The common part of `run` and `resume`.
#pragma once

#include "evolution/archive/archive.hpp"

namespace evodevo {

/// Evolves until the run is finished or interrupted, prints the outcome and returns the exit code. If anything fails,
/// such as the simulator's device, throws std::runtime_error; its text also names the last complete generation and the
/// command that continues the run.
int evolve_and_report(const Experiment& experiment, Simulator& simulator, Archive& archive);

}  // namespace evodevo
