// In which values two experiments differ.
#pragma once

#include <initializer_list>
#include <string>

#include "experiment/experiment.hpp"

namespace evodevo {

/// "simulation.dt is 0.001, in the first experiment 0.0005" for the first value in one of these tables that differs
/// from that of `first`; empty where none does.
std::string difference(const Experiment& experiment, const Experiment& first,
                       std::initializer_list<const char*> tables);

}  // namespace evodevo
