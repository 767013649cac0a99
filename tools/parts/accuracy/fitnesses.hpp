// What robots score when they are measured with one setting.
#pragma once

#include <span>
#include <vector>

#include "experiment/experiment.hpp"
#include "simulation.hpp"

namespace evodevo::tools::accuracy {

struct Fitnesses {
  std::vector<double> values;  ///< not a number for robots that diverge
  double cost;                 ///< seconds of computing for a simulated second of one robot
  double diverged;             ///< their share
};

/// The first fitness of the experiment, in its scene, of bodies from their birth on. `perturbation`: how far each place
/// is moved first, m.
Fitnesses measure(const Experiment& experiment, std::span<const Body> bodies, const Setting& setting,
                  const Device& device, double perturbation = 0);

}  // namespace evodevo::tools::accuracy
