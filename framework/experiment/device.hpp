// Where an experiment is simulated.
#pragma once

#include <exception>
#include <memory>
#include <string>

#include "experiment/experiment.hpp"

namespace evodevo {

/// The simulator for the experiment's device and threads. Throws ConfigError where CUDA is asked for and not to be had.
std::unique_ptr<Simulator> make_simulator(const Experiment& experiment);

/// How an experiment avoids a failure of its device, to be appended to the failure's message; empty if it cannot.
std::string remedy_for(const std::exception& failure);

}  // namespace evodevo
