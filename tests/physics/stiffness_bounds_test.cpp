// Upper bounds of frequencies, compared with the eigenvalues of the whole matrix.
#include "analysis/stiffness_bounds.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "stiffness_matrix.hpp"
#include "support.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

/// Returns twice the largest eigenvalue of the diagonal block of any mass.
double twice_the_blocks(const Eigen::MatrixXd& matrix) {
  double largest = 0;
  for (Eigen::Index i = 0; i < matrix.rows(); i += 3)
    largest = std::max(largest, 2 * largest_eigenvalue(matrix.block<3, 3>(i, i)));
  return largest;
}

TEST(StiffnessBounds, ThatOfBlocksLiesBetweenTheEigenvalueAndThatOfDiscs) {
  for (const Resistance resistance : {Resistance{1, 0}, Resistance{0, 1}, Resistance{0.3, 40}})
    for (std::uint64_t seed = 0; seed < 100; ++seed) {
      Body body = random_body(static_cast<std::uint32_t>(4 + seed % 8), 3, 5, seed);
      for (Material& material : body.materials) material.damping = 0.3;
      std::vector<Vec3> places;
      for (const Mass& mass : body.masses) places.push_back(mass.rest);
      std::vector<double> resisting;
      for (const Spring& spring : body.springs) resisting.push_back(resistance(body, spring));
      const Eigen::MatrixXd matrix = mass_weighted_matrix(body, resisting);
      const StiffnessBounds bounds(body, places, resistance);
      const double blocks = bounds.of_blocks();
      EXPECT_NEAR(blocks, twice_the_blocks(matrix), 1e-9 * blocks);
      EXPECT_LE(largest_eigenvalue(matrix), blocks * (1 + 1e-9));
      EXPECT_LE(blocks, bounds.of_discs() * (1 + 1e-9));
      EXPECT_TRUE(bounds.blocks_are_below(blocks * (1 + 1e-6)));
      EXPECT_FALSE(bounds.blocks_are_below(blocks * (1 - 1e-6)));
    }
}

TEST(StiffnessBounds, NothingMovesAMassWithoutMass) {
  const Vec3 places[] = {{0, 0, 0}, {1, 0, 0}};
  const Body body{
      .masses = {{places[0], 0}, {places[1], 0.5}}, .springs = {{0, 1, 1, 0}}, .materials = {{100, 0, 0, 0}}};
  const StiffnessBounds bounds(body, places, {1, 0});
  EXPECT_DOUBLE_EQ(bounds.of_discs(), 400);
  EXPECT_DOUBLE_EQ(bounds.of_blocks(), 400);
  EXPECT_TRUE(bounds.blocks_are_below(401));
  EXPECT_FALSE(bounds.blocks_are_below(399));
}

TEST(StiffnessBounds, ASpringWithoutADirectionResistsInAll) {
  const Vec3 places[] = {{0, 0, 0}, {0, 0, 0}, {0, 2, 0}};
  const Body body{.masses = {{places[0], 1}, {places[1], 1}, {places[2], 1}},
                  .springs = {{0, 1, 1, 0}, {1, 2, 1, 0}},
                  .materials = {{100, 0, 0, 0}}};
  const StiffnessBounds bounds(body, places, {1, 0});
  EXPECT_DOUBLE_EQ(bounds.of_blocks(), 400);
  EXPECT_TRUE(bounds.blocks_are_below(401));
  EXPECT_FALSE(bounds.blocks_are_below(399));
}

TEST(StiffnessBounds, NothingIsABoundWherePlacesAreNotNumbers) {
  const Vec3 places[] = {{0, 0, 0}, {1, std::numeric_limits<double>::quiet_NaN(), 0}};
  const Body body{.masses = {{places[0], 1}, {places[1], 1}}, .springs = {{0, 1, 1, 0}}, .materials = {{100, 0, 0, 0}}};
  const StiffnessBounds bounds(body, places, {1, 0});
  EXPECT_TRUE(std::isnan(bounds.of_discs()));
  EXPECT_TRUE(std::isnan(bounds.of_blocks()));
  EXPECT_FALSE(bounds.blocks_are_below(std::numeric_limits<double>::max()));
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
