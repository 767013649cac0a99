// The bodies that the measuring programs simulate, and the scene in which they move.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/scene.hpp"
#include "evodevo/body.hpp"

namespace evodevo::tools {

inline constexpr double time_step = 0.0005;  ///< the paper's time step [s]

/// A body and a name that tells its origin.
struct NamedBody {
  std::string name;
  Body body;
};

/// Returns a body by its name. "cube10" is the paper's lattice of 10 x 10 x 10 voxels, one metre high (section V-A).
/// "knn1000" is random_ball(masses). Any other name is that of a JSON file that `evodevo body` has written. If
/// `materials` is not 0, that many materials replace those of the body.
NamedBody body_named(const std::string& name, std::uint32_t masses, std::uint32_t materials = 0);

std::vector<Vec3> points_in_ball(std::uint32_t count, std::uint64_t seed);

/// A body of random points in the unit ball, each joined to its 25 nearest neighbours. The springs cycle through the
/// paper's materials.
Body random_ball(std::uint32_t masses);

/// Returns the body with the amplitude of all materials set to 0, so that its muscles keep their length.
Body without_actuation(Body body);

/// Gravity, floor, friction and damping with the paper's values.
Scene walking_scene();

/// Returns a description of the scene, with units.
std::string description(const Scene& scene);

}  // namespace evodevo::tools
