// Starts that differ by noise.
#pragma once

#include "life/evaluation.hpp"

namespace evodevo {

/// Moves each mass along each axis at random by up to 1e-4 of the body's longest side. `start` (below 240) says which
/// noise.
void disturb(Life& life, const Experiment& experiment, std::uint32_t start);

}  // namespace evodevo
