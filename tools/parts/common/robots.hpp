// Random robots of an experiment.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "evodevo/body.hpp"
#include "experiment/experiment.hpp"

namespace evodevo::tools {

/// The genome's body, if it can be simulated.
std::optional<Body> robot_of(const Experiment& experiment, const Genome& genome);

/// The genomes of the first `count` random robots of the experiment's encoding that can be simulated, have a muscle and
/// at least `springs` springs. Throws std::runtime_error where a hundred times as many give too few.
std::vector<Genome> random_genomes(const Experiment& experiment, std::size_t count, std::size_t springs);

/// Their bodies.
std::vector<Body> random_robots(const Experiment& experiment, std::size_t count, std::size_t springs);

}  // namespace evodevo::tools
