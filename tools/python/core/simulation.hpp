// Simulates bodies of Python in batches.
#pragma once

#include <string>
#include <vector>

#include "arrays.hpp"

namespace evodevo::python {

/// What a simulation of a body returns. module.cpp describes each member.
struct SimulationResult {
  std::string status, reason;
  double ended_at = 0, time = 0, dt = 0;
  py::array_t<double> positions, velocities, masses;
  py::dict records;
  py::array_t<double> sample_times;
  py::dict samples;
};

/// Simulates bodies for some seconds. module.cpp describes the arguments.
std::vector<SimulationResult> simulate(const py::sequence& bodies, double seconds, const py::dict& scene,
                                       const py::dict& simulation, double cycle_time,
                                       const std::vector<std::string>& record, double sample_hz,
                                       const std::vector<std::string>& sampled);

}  // namespace evodevo::python
