// The device on which an experiment is simulated.
#pragma once

#include <exception>
#include <memory>
#include <string>
#include <vector>

#include "experiment/experiment.hpp"

namespace evodevo {

/// Makes the simulator for the experiment's device and number of threads. On CUDA it uses the experiment's GPUs. Throws
/// ConfigError if the experiment asks for CUDA and CUDA cannot be used.
std::unique_ptr<Simulator> make_simulator(const Experiment& experiment);
/// The same for steps by another method or in another precision, and on another device.
std::unique_ptr<Simulator> make_simulator(const Experiment& experiment, const Stepping& stepping, Device device);

/// Returns the numbers of the GPUs that an experiment on CUDA uses if it names none; none if CUDA cannot be used.
std::vector<int> usable_gpus();

/// Returns a text that says how an experiment can avoid a failure of its device, to be appended to the failure's
/// message. The text is empty if there is no way to avoid the failure.
std::string remedy_for(const std::exception& failure);

}  // namespace evodevo
