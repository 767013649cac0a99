// The frame of reference in which developed bodies are compared.
#include "environments/grown_body.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace evodevo::EVODEVO_FILE {
namespace {

/// Returns `p` rotated by the angle `angle` about the z axis and then about the x axis, and shifted.
Vec3 moved(Vec3 p, double angle, Vec3 shift) {
  const double c = std::cos(angle), s = std::sin(angle);
  p = {c * p.x - s * p.y, s * p.x + c * p.y, p.z};
  return Vec3{p.x, c * p.y - s * p.z, s * p.y + c * p.z} + shift;
}

std::vector<Vec3> all_moved(std::vector<Vec3> positions, double angle, Vec3 shift) {
  for (Vec3& position : positions) position = moved(position, angle, shift);
  return positions;
}

void expect_near(Vec3 a, Vec3 b, double tolerance = 1e-12) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

const std::vector<Vec3> tetrahedron{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 1}};
constexpr Vec3 far_away{3, -2, 5};

TEST(Undeformed, UndoesARigidMotion) {
  const std::vector<Vec3> positions = all_moved(tetrahedron, 2, far_away);
  for (const Vec3 rest : {Vec3{0.1, 0.2, 0.3}, Vec3{-2, 1, 4}, tetrahedron[2]})
    expect_near(undeformed(moved(rest, 2, far_away), positions, tetrahedron), rest);
}

TEST(Undeformed, MirrorsNothing) {
  const std::vector<Vec3> flat{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  const Vec3 above{0.3, 0.4, 0.5};
  for (const double angle : {0.0, 1.0, 2.0, 3.0, 4.0, 5.0})
    expect_near(undeformed(moved(above, angle, far_away), all_moved(flat, angle, far_away), flat), above);
}

TEST(Undeformed, GoesAlongWithTheMassesAroundIt) {
  // two pieces ten body lengths apart, each rotated separately
  std::vector<Vec3> rest = tetrahedron;
  for (const Vec3& position : tetrahedron) rest.push_back(position + Vec3{10, 0, 0});
  std::vector<Vec3> positions = all_moved(tetrahedron, 1, {0, 0, 0});
  for (const Vec3& position : tetrahedron) positions.push_back(moved(position, -0.5, {10, 0, 0}));
  const Vec3 inside{0.2, 0.3, 0.2};
  expect_near(undeformed(moved(inside, 1, {0, 0, 0}), positions, rest), inside, 0.01);
  expect_near(undeformed(moved(inside, -0.5, {10, 0, 0}), positions, rest), inside + Vec3{10, 0, 0}, 0.01);
  // at the position of a mass, the result is the rest position of that mass, independently of the others
  expect_near(undeformed(positions[1], positions, rest), rest[1], 1e-9);
}

Life newborn(const std::vector<Vec3>& rest) {
  Life life;
  for (const Vec3& position : rest) life.living.body.masses.push_back({position, 1});
  life.living.state.position = rest;
  life.living.numbers = MassNumbers(rest.size());
  return life;
}

/// Adds a mass at a position and removes another one, as devo operators do.
void replace_mass(Life& life, Vec3 position, std::uint32_t goes) {
  LivingBody& living = life.living;
  living.body.masses.push_back({position, 1});
  living.body.masses.erase(living.body.masses.begin() + goes);
  living.state.position.push_back(position);
  living.state.position.erase(living.state.position.begin() + goes);
  living.numbers.apply({.removed_masses = {goes}, .new_masses = {{position, 1}}});
}

TEST(GrowthObserver, MassesOfBirthKeepTheirRestPlacesInBodyLengthsFromTheCorner) {
  Life life = newborn(all_moved(tetrahedron, 0, far_away));
  GrowthObserver growth(life.living.body);
  life.living.state.position = {{1, 2, 3}, {9, 8, 7}, {0, 1, 0}, {4, 4, 1}};
  const GrownBody grown = growth.after_cycle(life);
  EXPECT_EQ(grown.positions, life.living.state.position);
  EXPECT_EQ(grown.born, 4u);
  EXPECT_EQ(grown.numbers, (std::vector<std::uint32_t>{0, 1, 2, 3}));
  EXPECT_EQ(grown.rest_positions, (std::vector<Vec3>{{0, 0, 0}, {0.5, 0, 0}, {0, 1, 0}, {0, 0, 0.5}}));
}

TEST(GrowthObserver, AMassThatComesKeepsTheRestPlaceThatItCameTo) {
  Life life = newborn(tetrahedron);
  GrowthObserver growth(life.living.body);
  const Vec3 rest{0.2, 0.6, 0.4};
  life.living.state.position = all_moved(tetrahedron, 1, far_away);
  replace_mass(life, moved(rest, 1, far_away), 0);
  const GrownBody first = growth.after_cycle(life);
  EXPECT_EQ(first.numbers, (std::vector<std::uint32_t>{1, 2, 3, 4}));
  expect_near(first.rest_positions[3], 0.5 * rest);

  for (Vec3& position : life.living.state.position) position = {position.z, 2 * position.x, 0};
  const GrownBody second = growth.after_cycle(life);
  EXPECT_EQ(second.rest_positions, first.rest_positions);
}

TEST(GrowthObserver, WhereNoMassOfBeforeIsLeftThoseThatComeBelongWhereTheyAre) {
  Life life = newborn({{0, 0, 0}});
  GrowthObserver growth(life.living.body);
  replace_mass(life, {1, 2, 3}, 0);
  EXPECT_EQ(growth.after_cycle(life).rest_positions, (std::vector<Vec3>{{1, 2, 3}}));
}

TEST(GrowthObserver, ABodyWithoutExtentHasPlacesAllTheSame) {
  Life life = newborn({{1, 1, 1}, {1, 1, 1}});
  EXPECT_EQ(GrowthObserver(life.living.body).after_cycle(life).rest_positions,
            (std::vector<Vec3>{{0, 0, 0}, {0, 0, 0}}));
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
