// The permutation test of scenes.
#include "environments/scene_effect.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/philox.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

using Distances = std::vector<std::vector<double>>;

/// Returns the distances between bodies that are represented by one number each.
Distances distances(const std::vector<double>& bodies) {
  Distances all(bodies.size(), std::vector<double>(bodies.size()));
  for (std::size_t i = 0; i < bodies.size(); ++i)
    for (std::size_t j = i + 1; j < bodies.size(); ++j) all[i][j] = std::abs(bodies[i] - bodies[j]);
  return all;
}

TEST(SceneEffect, HoldsTheMeans) {
  const SceneEffect effect = scene_effect(distances({0, 0.1, 0.2, 1, 1}), 3);
  EXPECT_NEAR(effect.between, 0.9, 1e-12);
  // the mean distance is 0.4/3 within the first scene and 0 within the other
  EXPECT_NEAR(effect.within.value(), 0.2 / 3, 1e-12);
}

TEST(SceneEffect, IsAsRareAsItsDeal) {
  // of the 20 ways to assign six bodies to two scenes, 2 give at least this effect; for ten bodies, it is 2 of the 252
  // ways
  EXPECT_NEAR(scene_effect(distances({0, 0.01, 0.02, 0.9, 0.91, 0.92}), 3).p.value(), 0.1, 0.015);
  EXPECT_NEAR(scene_effect(distances({0, 0.1, 0.2, 0.3, 0.4, 1, 1.1, 1.2, 1.3, 1.4}), 5).p.value(), 2.0 / 252, 0.004);
}

TEST(SceneEffect, OfBodiesThatTheSceneDoesNotSortIsNone) {
  EXPECT_EQ(scene_effect(distances({0, 0.5, 1, 0, 0.5, 1}), 3).p, 1) << "no deal is less far apart";
  EXPECT_EQ(scene_effect(distances({1, 1, 1, 1}), 2).p, 1) << "all are equal";
}

TEST(SceneEffect, OfNoiseAloneIsSelectedAsOftenAsPSays) {
  Rng rng(philox, {.seed = 3});
  int at_most_a_fifth = 0;
  constexpr int trials = 200;
  for (int trial = 0; trial < trials; ++trial) {
    std::vector<double> bodies(10);
    for (double& body : bodies) body = rng.uniform();
    if (scene_effect(distances(bodies), 5).p <= 0.2) ++at_most_a_fifth;
  }
  // four standard deviations of a binomial distribution
  EXPECT_NEAR(at_most_a_fifth, trials * 0.2, 4 * std::sqrt(trials * 0.2 * 0.8));
}

TEST(SceneEffect, OfOneBodyIsADistanceAndNoMore) {
  const SceneEffect effect = scene_effect(distances({0, 0.4, 0.6}), 1);
  EXPECT_NEAR(effect.between, 0.5, 1e-12);
  EXPECT_FALSE(effect.within);
  EXPECT_FALSE(effect.p);
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
