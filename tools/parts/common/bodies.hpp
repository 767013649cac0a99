// The bodies that are measured and the scene that they move in.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/scene.hpp"
#include "evodevo/body.hpp"

namespace evodevo::tools {

inline constexpr double time_step = 0.0005;  ///< s, the paper's

/// A body and where it comes from.
struct NamedBody {
  std::string name;
  Body body;
};

/// "cube10": the paper's lattice of 10 x 10 x 10 voxels, one metre high (section V-A); "knn1000": `masses` random
/// points in the unit ball, each joined to its 25 nearest neighbours; else the JSON file that `evodevo body` wrote.
/// With `materials` its springs have as many instead of their own.
NamedBody body_named(const std::string& name, std::uint32_t masses, std::uint32_t materials = 0);

std::vector<Vec3> points_in_ball(std::uint32_t count, std::uint64_t seed);

/// Random points in the unit ball, each joined to its 25 nearest neighbours, the paper's materials in turn.
Body random_ball(std::uint32_t masses);

/// The body with muscles that do not move.
Body without_actuation(Body body);

/// Gravity, floor, friction and damping with the paper's values.
Scene walking_scene();

/// A scene in words, with units.
std::string description(const Scene& scene);

}  // namespace evodevo::tools
