// How well an estimate of stress finds the springs that development would choose.
#pragma once

#include <cstddef>
#include <span>

namespace evodevo::tools {

/// Returns the share, in [0, 1], of the `count` largest elements of `truth` that are among the `count` largest of
/// `estimate`. If equal values in `estimate` compete for the last places, the result is the mean over all ways to
/// choose among them.
double share_found(std::span<const double> truth, std::span<const double> estimate, std::size_t count);

}  // namespace evodevo::tools
