// Upper bounds of frequencies, compared with the eigenvalues of the whole matrix.
#include "analysis/stiffness_bounds.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "random_numbers.hpp"

namespace evodevo::test {
namespace {

constexpr int tries = 200;

/// A body of a few masses with springs of various stiffness and damping between them, and where they are.
struct Tangle {
  explicit Tangle(Random& random) {
    const std::uint32_t masses = 2 + random.below(8);
    body.materials = {{1000, 0.1, 1, 0, 0.2}, {200, 0.1, 1, 0, 0.7}, {31000, 0.1, 1, 0, 0.05}};
    for (std::uint32_t i = 0; i < masses; ++i) {
      positions.push_back(random.vector(1));
      body.masses.push_back({positions.back(), random.of_any_scale(0.05, 2)});
    }
    for (std::uint32_t i = 1; i < masses; ++i)
      for (std::uint32_t j = 0; j < i; ++j)
        if (j + 1 == i || random.chance(0.5)) body.springs.push_back({i, j, 1, random.below(3)});
  }

  Body body;
  std::vector<Vec3> positions;
};

/// Returns the mass-weighted matrix M^-1/2 K M^-1/2.
Eigen::MatrixXd matrix_of(const Tangle& tangle, const Resistance& resistance) {
  const auto size = static_cast<Eigen::Index>(3 * tangle.positions.size());
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(size, size);
  for (const Spring& spring : tangle.body.springs) {
    const Vec3 along = tangle.positions[spring.b] - tangle.positions[spring.a];
    const Eigen::Vector3d direction = Eigen::Vector3d(along.x, along.y, along.z).normalized();
    Eigen::VectorXd edge = Eigen::VectorXd::Zero(size);
    edge.segment<3>(3 * spring.a) = -direction / std::sqrt(tangle.body.masses[spring.a].mass);
    edge.segment<3>(3 * spring.b) = direction / std::sqrt(tangle.body.masses[spring.b].mass);
    matrix += resistance(tangle.body, spring) * edge * edge.transpose();
  }
  return matrix;
}

double largest_eigenvalue(const Eigen::MatrixXd& matrix) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix, Eigen::EigenvaluesOnly).eigenvalues().maxCoeff();
}

/// Returns twice the largest eigenvalue of the diagonal block of any mass.
double twice_the_blocks(const Eigen::MatrixXd& matrix) {
  double largest = 0;
  for (Eigen::Index i = 0; i < matrix.rows(); i += 3)
    largest = std::max(largest, 2 * largest_eigenvalue(matrix.block<3, 3>(i, i)));
  return largest;
}

TEST(StiffnessBounds, EachIsTighterAndCostsMoreThanTheOneBefore) {
  Random random(1);
  for (const Resistance resistance : {Resistance{1, 0}, Resistance{0, 1}, Resistance{0.3, 40}})
    for (int i = 0; i < tries; ++i) {
      const Tangle tangle(random);
      const StiffnessBounds bounds(tangle.body, tangle.positions, resistance);
      const Eigen::MatrixXd matrix = matrix_of(tangle, resistance);
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
}  // namespace evodevo::test
