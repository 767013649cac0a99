// The settings of a simulation that is called from Python.
#pragma once

#include <pybind11/pybind11.h>

#include "experiment/experiment.hpp"

namespace evodevo::python {

/// Returns an experiment without operators that has the given tables [scene] and [simulation]. Throws ConfigError if a
/// key or a value is not one that an experiment may have.
Experiment experiment_with(const pybind11::dict& scene, const pybind11::dict& simulation);

}  // namespace evodevo::python
