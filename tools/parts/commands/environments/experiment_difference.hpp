// Finds a value in which two experiments differ.
#pragma once

#include <initializer_list>
#include <string>

#include "experiment/experiment.hpp"

namespace evodevo {

/// Returns a text such as "simulation.dt is 0.001, but 0.0005 in the first experiment" for the first value in one of
/// these tables that differs from the one in `first`, or an empty text if no value differs.
std::string difference(const Experiment& experiment, const Experiment& first,
                       std::initializer_list<const char*> tables);

}  // namespace evodevo
