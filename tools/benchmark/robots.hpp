// Random robots of an experiment.
#pragma once

#include <cstddef>
#include <vector>

#include "evodevo/body.hpp"
#include "experiment.hpp"

namespace evodevo::benchmark {

/// The first `count` random robots of the experiment's encoding that can be simulated, have a muscle and at least
/// `springs` springs. Throws std::runtime_error where a hundred times as many give too few.
std::vector<Body> random_robots(const Experiment& experiment, std::size_t count, std::size_t springs);

}  // namespace evodevo::benchmark
