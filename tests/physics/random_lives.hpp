// Random bodies in random scenes, for properties that hold whatever they are.
#pragma once

#include <cstdint>
#include <vector>

#include "support.hpp"

namespace evodevo::test {

/// A random body in motion, and steps that every method bears.
struct Life {
  std::uint64_t seed = 0;
  Body body;
  State start;
  double dt = 0.0005;  ///< s
  std::uint64_t steps = 60;
};

/// Any of the forces, each of any strength.
Scene random_scene(std::uint64_t seed);

/// `count` lives of up to 16 masses in one scene: springs of any material and strain, some of no length; masses of 0
/// kg, masses that coincide, and masses without springs.
std::vector<Life> random_lives(const Scene& scene, std::uint64_t seed, std::size_t count);

/// A state and a scene as seen in a mirror across the x axis.
State mirrored(State state);
Scene mirrored(Scene scene);

/// All lives in one batch.
std::vector<Answer> simulate(Simulator& simulator, const std::vector<Life>& lives, Recording recording = {});

}  // namespace evodevo::test
