// Distances between developed bodies, and the frame of reference in which they are compared.
#include "environments/body_distance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "base/philox.hpp"
#include "life/birth.hpp"
#include "support/changed.hpp"
#include "support/lives.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

/// A chain of masses of 1 kg at rest positions. Masses with numbers from `born` on were added after birth.
GrownBody chain(const std::vector<Vec3>& positions, std::vector<std::uint32_t> numbers, std::size_t born = 100) {
  GrownBody grown{{}, positions, positions, std::move(numbers), born};
  for (std::uint32_t i = 0; i < positions.size(); ++i) {
    grown.body.masses.push_back({positions[i], 1});
    if (i > 0) grown.body.springs.push_back({i - 1, i, 1, 0});
  }
  return grown;
}

/// A chain in which all masses exist from birth.
GrownBody cloud(const std::vector<Vec3>& positions) {
  std::vector<std::uint32_t> numbers(positions.size());
  std::iota(numbers.begin(), numbers.end(), 0u);
  return chain(positions, numbers);
}

std::vector<Vec3> random_places(std::size_t count, Rng& rng) {
  std::vector<Vec3> positions(count);
  for (Vec3& position : positions) position = {rng.uniform(), rng.uniform(), rng.uniform()};
  return positions;
}

const std::vector<Vec3> line{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}};

TEST(BodyDistance, OfSpringsIsThePartThatOnlyOneBodyHas) {
  const GrownBody body = chain(line, {0, 1, 2, 3});
  EXPECT_EQ(spring_distance(body, body), 0);
  EXPECT_EQ(spring_distance(body, chain(line, {3, 2, 1, 0})), 0) << "a spring has no direction, a mass no place";
  EXPECT_EQ(spring_distance(body, chain(line, {0, 1, 2, 7})), 0.5) << "2 of 4 springs are in both";
  EXPECT_EQ(spring_distance(body, chain(line, {4, 5, 6, 7})), 1);
  EXPECT_EQ(spring_distance(body, chain(line, {0, 2, 4, 6})), 1) << "the same masses do not make the same springs";
  EXPECT_EQ(spring_distance({}, {}), 0);
  EXPECT_EQ(spring_distance(body, {}), 1);
}

TEST(BodyDistance, OfSpringsToMassesThatCameLaterGoesByWhereTheyCame) {
  const GrownBody body = chain(line, {0, 1, 2, 3}, 3);
  std::vector<Vec3> elsewhere = line;
  elsewhere[3] = {3, 1.1 * same_position, 0};
  EXPECT_EQ(spring_distance(body, chain(elsewhere, {0, 1, 2, 3}, 3)), 0.5) << "another mass of the same number";
  EXPECT_EQ(spring_distance(body, chain(line, {0, 1, 2, 9}, 3)), 0) << "the same mass by another number";
  elsewhere[3] = {3, 0.9 * same_position, 0};
  EXPECT_EQ(spring_distance(body, chain(elsewhere, {0, 1, 2, 3}, 3)), 0) << "where noise has moved it";
  EXPECT_EQ(spring_distance(body, chain(line, {0, 1, 2, 3}, 4)), 0.5) << "a mass of birth is no later one";
  EXPECT_EQ(spring_distance(chain(line, {3, 4, 5, 6}, 3), chain(line, {7, 8, 9, 10}, 3)), 0) << "none is left of birth";
}

TEST(BodyDistance, OfTwoMassesThatCameNearOneTheNearerIsTheSame) {
  // each mass added later is joined to a different one of the masses present at birth
  const auto body = [](const std::vector<double>& later) {
    GrownBody grown = cloud({{0, 0, 0}, {5, 0, 0}, {9, 0, 0}});
    grown.born = 3;
    grown.body.springs.clear();
    for (std::uint32_t i = 0; i < later.size(); ++i) {
      grown.body.masses.push_back({{}, 1});
      grown.rest_positions.push_back({1, later[i], 0});
      grown.numbers.push_back(3 + i);
      grown.body.springs.push_back({i, 3 + i, 1, 0});
    }
    return grown;
  };
  const GrownBody one = body({0}), two = body({0.8 * same_position, 0.1 * same_position});
  EXPECT_EQ(spring_distance(one, two), 1) << "the nearer one is joined to another mass of birth";
  EXPECT_EQ(spring_distance(two, one), 1);
  EXPECT_EQ(spring_distance(two, two), 0);
  EXPECT_EQ(spring_distance(one, body({0.1 * same_position, 0.8 * same_position})), 0.5);
}

TEST(BodyDistance, OfMassIsHowFarItHasToBeMoved) {
  const GrownBody body = cloud(line);
  std::vector<Vec3> moved = line;
  moved[0].x = 1.25;
  EXPECT_DOUBLE_EQ(mass_distance(body, cloud(moved)), 1.25 / (3 * 4)) << "one of four, past another one";
  moved = line;
  for (Vec3& position : moved) position = position + Vec3{0.5, -0.25, 0.125};
  EXPECT_DOUBLE_EQ(mass_distance(body, cloud(moved)), (0.5 + 0.25 + 0.125) / 3) << "all of them";
  EXPECT_DOUBLE_EQ(mass_distance(cloud({{0, 0, 0}}), cloud({{0, 0, 0}, {0, 0, 1}})), 0.5 / 3);
  std::vector<Vec3> twice = line;
  twice.insert(twice.end(), line.begin(), line.end());
  EXPECT_NEAR(mass_distance(body, cloud(twice)), 0, 1e-15) << "as much mass at each place, in parts";
}

TEST(BodyDistance, OfMassHeedsNeitherLoadNorOrderNorNumberNorPose) {
  const GrownBody body = cloud({{0, 0, 0}, {1, 0, 0}});
  GrownBody heavy = body;
  heavy.body.masses[1].mass = 3;
  EXPECT_DOUBLE_EQ(mass_distance(body, heavy), 0.25 / 3) << "a quarter of all comes from the first place";
  heavy.body.masses[1].payload = 2;
  EXPECT_EQ(mass_distance(body, heavy), 0);
  const std::vector<Vec3> positions{{0, 3, 1}, {2, 0, 5}, {1, 1, 0}, {7, 0, 0}};
  GrownBody other = chain({positions[2], positions[0], positions[3], positions[1]}, {8, 1, 9, 4}, 2);
  for (Vec3& position : other.positions) position = position + Vec3{5, 5, 5};
  EXPECT_EQ(mass_distance(cloud(positions), other), 0);
}

TEST(BodyDistance, OfMassIsTheCheapestWayToCarryItAlongEachAxis) {
  Rng rng(philox, {.seed = 5});
  // 2 masses are equivalent to 6 masses with a third of the mass each, and 3 masses to 6 masses with half of the mass
  // each
  const std::vector<Vec3> a = random_places(2, rng), b = random_places(3, rng);
  double expected = 0;
  for (const auto axis : {&Vec3::x, &Vec3::y, &Vec3::z}) {
    std::vector<std::size_t> to{0, 1, 2, 3, 4, 5};
    double cheapest = std::numeric_limits<double>::infinity();
    do {
      double cost = 0;
      for (std::size_t i = 0; i < 6; ++i) cost += std::abs(a[i / 3].*axis - b[to[i] / 2].*axis) / 6;
      cheapest = std::min(cheapest, cost);
    } while (std::next_permutation(to.begin(), to.end()));
    expected += cheapest / 3;
  }
  EXPECT_GT(expected, 0.01);
  EXPECT_NEAR(mass_distance(cloud(a), cloud(b)), expected, 1e-14);
}

/// The body that one genome develops in the small experiment with an additional operator and the given values, perhaps
/// from a perturbed start.
GrownBody grown(const std::string& devo, std::vector<std::string> values, std::optional<std::uint32_t> start = {}) {
  values.insert(values.end(), {"encoding.size=[3, 2, 2]", "development.cycle_time=0.2"});
  const std::string text =
      testing::small_with({{"springs = 2\n", "springs = 2\n[[development.operator]]\n" + devo + "\n"}});
  const Experiment experiment = testing::read(text, testing::overrides(values));
  testing::AlteredSimulator simulator(experiment);
  const std::vector<Individual> individuals = breed(experiment, {}, 0, 4, 1);
  const Evaluation evaluation(experiment, simulator);
  std::vector<Life> lives = evaluation.birth.of(testing::newborns_of(individuals));
  if (start) perturb(lives.front(), experiment, *start);
  GrowthObserver observer(lives.front().living.body);
  GrownBody body;
  evaluation.development.run(lives, [&](double) { body = observer.after_cycle(lives.front()); });
  return body;
}

TEST(BodyDistance, OfTwoLivesOfOneGenomeIsZeroWithoutNoiseAlone) {
  const std::string turnover = "name = \"mass-turnover\"\nthreshold = 100\nlimit = 2";
  const std::vector<std::string> values{"development.cycles=30"};
  const GrownBody a = grown(turnover, values), b = grown(turnover, values), c = grown(turnover, values, 1);
  EXPECT_GE(*std::max_element(a.numbers.begin(), a.numbers.end()), a.born) << "no mass has come";
  EXPECT_EQ(spring_distance(a, b), 0);
  EXPECT_EQ(mass_distance(a, b), 0);
  EXPECT_GT(spring_distance(a, c), 0);
  EXPECT_GT(mass_distance(a, c), 0);
}

TEST(BodyDistance, SeesThatTwoScenesLetMassesComeElsewhere) {
  const std::string growth = "name = \"mass-growth\"\nmasses = 3\nwhere = \"by-stress\"";
  const GrownBody a = grown(growth, {"development.draws=individual", "development.cycles=6"}),
                  b = grown(growth, {"development.draws=individual", "development.cycles=6", "scene.gravity.slope=30"});
  ASSERT_EQ(a.body.masses.size(), a.born + 18);
  ASSERT_EQ(a.numbers, b.numbers) << "as many masses have come, so that numbers tell nothing";
  EXPECT_GT(mass_distance(a, b), 1e-4);
  EXPECT_GT(spring_distance(a, b), 0.1);
}

TEST(BodyDistance, OfBodiesThatDidNotDevelopIsZeroWhateverTheyCarry) {
  const std::string still = "development.control=no-change", none = "name = \"mass-growth\"";
  const GrownBody flat = grown(none, {still}), loaded = grown(none, {still, "scene.payload.share=0.3"});
  // the payload shifts the body; adding the payload to masses and later subtracting it causes rounding errors
  EXPECT_NE(flat.body.masses.back().rest, loaded.body.masses.back().rest);
  EXPECT_NEAR(mass_distance(flat, loaded), 0, 1e-14);
  EXPECT_EQ(spring_distance(flat, loaded), 0);
}

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

void expect_near(Vec3 a, Vec3 b, double tolerance = 1e-12) { EXPECT_LE(norm(a - b), tolerance); }

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
  Edits edits(living.body);
  edits.remove_mass(goes);
  edits.add_mass(position, {.mass = 1, .identity = 9});
  living.numbers.apply(edits);
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
  EXPECT_EQ(GrowthObserver(life.living.body).after_cycle(life).rest_positions, std::vector<Vec3>(2));
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
