// The first random robots of an experiment, from which a user learns what all others will be like.
#pragma once

#include <string>
#include <vector>

#include "experiment/experiment.hpp"

namespace evodevo {

struct FirstRobots {
  std::vector<double> lengths;        ///< at birth, of those that have a length, m, in ascending order
  std::vector<std::string> warnings;  ///< of what makes that none of them can walk
};

/// Makes at most ten. Throws what the operators throw.
FirstRobots first_robots(const Experiment& experiment);

}  // namespace evodevo
