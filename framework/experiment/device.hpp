// Where an experiment is simulated.
#pragma once

#include <memory>

#include "experiment/experiment.hpp"

namespace evodevo {

/// The simulator for the experiment's device and threads. Throws ConfigError where CUDA is asked for and not to be had.
std::unique_ptr<Simulator> make_simulator(const Experiment& experiment);

}  // namespace evodevo
