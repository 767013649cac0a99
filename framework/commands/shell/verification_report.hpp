// Verifies individuals and prints the results, for several commands.
#pragma once

#include <vector>

#include "archive/archive.hpp"

namespace evodevo {

/// Verifies one life of each of the `count` best individuals of a run, and returns the results without storing them.
/// Throws UsageError if one of them has had no such life.
std::vector<Verification> verify_life_of_best(const Experiment& experiment, Simulator& simulator,
                                              const Archive& archive, std::size_t count, std::int64_t life);

/// Prints verifications, and which of the individuals is best in lives to come.
void print(const std::vector<Verification>& verifications, const Objective& objective);

}  // namespace evodevo
