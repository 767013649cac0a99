// How well an estimate finds the springs that matter to development.
#pragma once

#include <cstddef>
#include <span>

namespace evodevo::tools {

/// The share of the `count` largest of `truth` that are among the `count` largest of `estimate`. Equals in the estimate
/// that do not all have room take part with the probability of being drawn at random; so the share is the mean over
/// all ways to decide between them. In [0, 1].
double share_found(std::span<const double> truth, std::span<const double> estimate, std::size_t count);

}  // namespace evodevo::tools
