// The ground under a body, and how a body lies on it at the start of its life.
#pragma once

#include <vector>

#include "core/scene.hpp"
#include "evodevo/body.hpp"

namespace evodevo {

/// Sets `state` to the start of a life: the rest positions moved so that the lowest mass is on the ground and the
/// centre of mass over the origin, at rest, at t = 0; `start_energy` for the scene.
State state_at_birth(const Body& body, const Scene& scene);

/// How high the ground is under a place, m; 0 without a floor.
double ground_height(const Scene& scene, const Vec3& position);

/// Moves positions up or down, all alike, until the lowest is on the ground.
void put_on_ground(std::vector<Vec3>& positions, const Scene& scene);

}  // namespace evodevo
