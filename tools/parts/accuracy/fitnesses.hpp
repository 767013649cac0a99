// The fitness of robots that are simulated with one time-stepping setting.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "experiment/experiment.hpp"
#include "simulation.hpp"

namespace evodevo::tools::accuracy {

struct Fitnesses {
  std::vector<double> values;  ///< fitness of each robot; NaN if it has diverged
  double cost;                 ///< computing time per simulated second of one robot [s]
  double diverged;             ///< share of the robots that have diverged
};

/// Reads the experiment in a file, some of whose keys the study sets. Throws ConfigError if it cannot be read, or if
/// its first fitness is not a measure that measure() can take: one of which more is better, and that needs no more than
/// where the body is when the window opens and closes.
Experiment measurable_experiment(const std::string& file, std::vector<Override> set_by_study);

/// Simulates bodies from birth in the scene of the experiment, without development, and scores them by the first
/// fitness operator of the experiment. At birth, each coordinate of each mass is moved by up to `perturbation` m.
Fitnesses measure(const Experiment& experiment, std::span<const Body> bodies, const Setting& setting,
                  const Device& device, double perturbation = 0);

}  // namespace evodevo::tools::accuracy
