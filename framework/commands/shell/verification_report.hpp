// Verifies individuals and prints the results, for several commands.
#pragma once

#include <vector>

#include "evolution/archive/archive.hpp"

namespace evodevo {

/// Verifies the `count` best individuals of a run, and stores and returns the results.
std::vector<Verification> verify_best(const Experiment& experiment, Simulator& simulator, Archive& archive,
                                      std::size_t count);

void print(const Verification& verification, const Objective& objective);

}  // namespace evodevo
