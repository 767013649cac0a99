// What `run` and `resume` do once they have a run to go on with.
#pragma once

#include "evolution/archive/archive.hpp"

namespace evodevo {

/// Evolves until the end or an interruption, says what came out and returns the exit code. Where anything fails, such
/// as the simulator's device, it throws std::runtime_error, whose text adds up to which generation the run is complete
/// and how it goes on.
int evolve_and_report(const Experiment& experiment, Simulator& simulator, Archive& archive);

}  // namespace evodevo
