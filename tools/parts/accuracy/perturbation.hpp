// Small displacements, from which a chaotic motion diverges.
#pragma once

#include <cmath>

#include "evodevo/body.hpp"

namespace evodevo::tools::accuracy {

/// Returns `state` with its positions moved by up to `distance` m along each axis. The displacements are deterministic.
inline State perturbed(State state, double distance) {
  for (std::size_t i = 0; i < state.position.size(); ++i) {
    const double angle = 1 + 12.9898 * static_cast<double>(i);
    state.position[i] = state.position[i] + distance * Vec3{std::sin(angle), std::sin(2 * angle), std::sin(3 * angle)};
  }
  return state;
}

}  // namespace evodevo::tools::accuracy
