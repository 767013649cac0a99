// Random bodies in random scenes, for tests of general properties.
#pragma once

#include <cstdint>
#include <vector>

#include "support.hpp"

namespace evodevo::test {

/// A random body in motion, with a step at which every method is stable.
struct Life {
  std::uint64_t seed = 0;
  Body body;
  State start;
  double dt = 0.0005;  ///< time step [s]
  std::uint64_t steps = 60;
  std::vector<SamplePoint> sampled_at = {};
};

/// Returns a scene with random forces of random strength.
Scene random_scene(std::uint64_t seed);

/// Returns `count` lives of up to 16 masses in one scene. Springs have random materials and strains, and some have zero
/// length. There are masses of 0 kg, masses at the same position, and masses without springs.
std::vector<Life> random_lives(const Scene& scene, std::uint64_t seed, std::size_t count);

/// Returns the mirror image of a state, or of a scene, with the x axis reversed.
State mirrored(State state);
Scene mirrored(Scene scene);

/// Simulates all lives in one batch.
std::vector<Answer> simulate(Simulator& simulator, const std::vector<Life>& lives, Recording recording = {});

/// The largest distance (m) between masses at the end of a life and those of 64 others, whose masses start up to
/// `moved` m elsewhere along each axis; on the CPU. It is far more than `moved` where that decides in which step a mass
/// reaches a rigid floor, or whether friction holds it.
double sensitivity(const Life& life, const Scene& scene, const Stepping& stepping, double moved);

}  // namespace evodevo::test
