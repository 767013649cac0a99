// Verifications as commands make and print them.
#pragma once

#include <vector>

#include "evolution/archive/archive.hpp"

namespace evodevo {

/// Verifies the `count` best individuals of a run and stores what came out.
std::vector<Verification> verify_best(const Experiment& experiment, Simulator& simulator, Archive& archive,
                                      std::size_t count);

void print(const Verification& verification, const Objective& objective);

}  // namespace evodevo
