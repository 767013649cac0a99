// The ground under a body, and the state of a body at the start of its life.
#pragma once

#include <vector>

#include "core/scene.hpp"
#include "evodevo/body.hpp"

namespace evodevo {

/// The state of a body at the start of its life: its rest positions, moved so that the lowest mass is on the ground and
/// the centre of mass is over the origin; velocities and time are 0; `start_energy` is set for the scene.
State state_at_birth(const Body& body, const Scene& scene);

/// The height of the ground under a point, m; 0 without a floor.
double ground_height(const Scene& scene, const Vec3& position);

/// Moves all positions (m) up or down by the same distance, so that the lowest is on the ground.
void put_on_ground(std::vector<Vec3>& positions, const Scene& scene);

}  // namespace evodevo
