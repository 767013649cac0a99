// The energy of a body.
#pragma once

#include "core/scene.hpp"
#include "evodevo/body.hpp"

namespace evodevo {

/// The sum of a body's kinetic energy, elastic energy and, in a scene with gravity, gravitational energy relative to
/// the origin, J. This value is the start_energy of a State that is not made by state_at_birth().
double total_energy(const Body& body, const State& state, const Scene& scene);

}  // namespace evodevo
