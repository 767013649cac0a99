// The fitness of robots that are simulated with one time-stepping setting.
#pragma once

#include <span>
#include <vector>

#include "experiment/experiment.hpp"
#include "simulation.hpp"

namespace evodevo::tools::accuracy {

struct Fitnesses {
  std::vector<double> values;  ///< fitness of each robot; NaN if it has diverged
  double cost;                 ///< computing time per simulated second of one robot [s]
  double diverged;             ///< share of the robots that have diverged
};

/// Simulates bodies from birth in the scene of the experiment, without development, and scores them by the first
/// fitness operator of the experiment. At birth, each coordinate of each mass is moved by up to `perturbation` m.
Fitnesses measure(const Experiment& experiment, std::span<const Body> bodies, const Setting& setting,
                  const Device& device, double perturbation = 0);

}  // namespace evodevo::tools::accuracy
