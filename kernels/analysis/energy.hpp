// The energy of a body.
#pragma once

#include "core/scene.hpp"
#include "evodevo/body.hpp"

namespace evodevo {

/// The kinetic, elastic and, with gravity, height energy (above the origin) of a body, J: `State::start_energy` for a
/// body that does not start by state_at_birth().
double total_energy(const Body& body, const State& state, const Scene& scene);

}  // namespace evodevo
