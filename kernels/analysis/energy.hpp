// The energy of a body.
#pragma once

#include "core/scene.hpp"
#include "evodevo/body.hpp"

namespace evodevo {

/// The sum of a body's kinetic energy, elastic energy and, in a scene with gravity, height energy above the origin, J.
/// It is the State::start_energy of a body that does not start from state_at_birth().
double total_energy(const Body& body, const State& state, const Scene& scene);

}  // namespace evodevo
