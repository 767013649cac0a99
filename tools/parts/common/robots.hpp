// Random robots of an experiment.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "evodevo/body.hpp"
#include "experiment/experiment.hpp"

namespace evodevo::tools {

/// Returns the body that a genome grows, with the payload, or nothing if the body is invalid or cannot be simulated.
std::optional<Body> robot_of(const Experiment& experiment, const Genome& genome);

/// Draws random genomes of the experiment's encoding; returns the first `count` whose bodies can be simulated, have a
/// muscle and have at least `springs` springs. Throws std::runtime_error if 100 * `count` draws do not suffice.
std::vector<Genome> random_genomes(const Experiment& experiment, std::size_t count, std::size_t springs);

/// Returns the bodies of these genomes.
std::vector<Body> random_robots(const Experiment& experiment, std::size_t count, std::size_t springs);

}  // namespace evodevo::tools
