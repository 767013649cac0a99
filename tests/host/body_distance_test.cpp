// Distances between developed bodies.
#include "environments/body_distance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>

#include "base/philox.hpp"
#include "evolution/breeding.hpp"
#include "life/birth.hpp"
#include "support/experiments.hpp"

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

TEST(BodyDistance, OfMassGoesByMassAndNotByLoad) {
  const GrownBody body = cloud({{0, 0, 0}, {1, 0, 0}});
  GrownBody heavy = body;
  heavy.body.masses[1].mass = 3;
  EXPECT_DOUBLE_EQ(mass_distance(body, heavy), 0.25 / 3) << "a quarter of all comes from the first place";
  heavy.body.masses[1].payload = 2;
  EXPECT_EQ(mass_distance(body, heavy), 0);
}

TEST(BodyDistance, OfMassHeedsNeitherOrderNorNumberNorPose) {
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

TEST(BodyDistance, OfMassIsAPseudometric) {
  Rng rng(philox, {.seed = 6});
  for (int trial = 0; trial < 50; ++trial) {
    const GrownBody a = cloud(random_places(1 + rng.below(5), rng)), b = cloud(random_places(1 + rng.below(5), rng)),
                    c = cloud(random_places(1 + rng.below(5), rng));
    EXPECT_EQ(mass_distance(a, a), 0);
    EXPECT_GT(mass_distance(a, b), 0);
    EXPECT_EQ(mass_distance(a, b), mass_distance(b, a));
    EXPECT_LE(mass_distance(a, c), mass_distance(a, b) + mass_distance(b, c) + 1e-14);
  }
}

/// The bodies that one random genome develops from `starts` starts.
std::vector<GrownBody> grown_from_starts(const Experiment& experiment, std::uint32_t starts, bool noise) {
  const auto simulator = make_cpu_simulator(experiment.scene, experiment.stepping, 1);
  const Individual individual = breed(experiment, {}, 0, 4, 1).front();
  const Evaluation evaluation(experiment, *simulator);
  std::vector<Life> lives = evaluation.birth.of(std::vector<Newborn>(starts, {individual.id, 0, &individual.genome}));
  std::vector<GrowthObserver> observers(starts, GrowthObserver(lives.front().living.body));
  for (std::uint32_t i = 0; noise && i < starts; ++i) perturb(lives[i], experiment, i);
  std::vector<GrownBody> bodies(starts);
  evaluation.development.run(lives, [&](double) {
    for (std::size_t i = 0; i < starts; ++i) bodies[i] = observers[i].after_cycle(lives[i]);
  });
  return bodies;
}

/// The small experiment with an additional operator.
Experiment experiment_with(const std::string& devo, std::vector<Override> overrides = {}) {
  std::string text = testing::small_experiment;
  text.insert(text.find("[[fitness]]"), "[[development.operator]]\n" + devo + "\n");
  overrides.insert(overrides.begin(), {{"encoding.size", "[3, 2, 2]", ""}, {"development.cycle_time", "0.2", ""}});
  return testing::read(text, overrides);
}

TEST(BodyDistance, OfTwoLivesOfOneGenomeIsZeroWithoutNoiseAlone) {
  const Experiment experiment =
      experiment_with("name = \"mass-turnover\"\nthreshold = 100\nlimit = 2", {{"development.cycles", "30", ""}});
  const auto quiet = grown_from_starts(experiment, 2, false), noisy = grown_from_starts(experiment, 2, true);
  ASSERT_FALSE(quiet[0].body.springs.empty());
  EXPECT_GE(*std::max_element(quiet[0].numbers.begin(), quiet[0].numbers.end()), quiet[0].born) << "no mass has come";
  EXPECT_EQ(spring_distance(quiet[0], quiet[1]), 0);
  EXPECT_EQ(mass_distance(quiet[0], quiet[1]), 0);
  EXPECT_GT(spring_distance(noisy[0], noisy[1]), 0);
  EXPECT_GT(mass_distance(noisy[0], noisy[1]), 0);
}

TEST(BodyDistance, SeesThatTwoScenesLetMassesComeElsewhere) {
  const std::string growth = "name = \"mass-growth\"\nmasses = 3\nwhere = \"by-stress\"";
  const std::vector<Override> flat{{"development.cycles", "6", ""}};
  std::vector<Override> slope = flat;
  slope.push_back({"scene.gravity.slope", "30", ""});
  const GrownBody a = grown_from_starts(experiment_with(growth, flat), 1, false).front(),
                  b = grown_from_starts(experiment_with(growth, slope), 1, false).front();
  ASSERT_EQ(a.body.masses.size(), a.born + 18);
  ASSERT_EQ(a.numbers, b.numbers) << "as many masses have come, so that numbers tell nothing";
  EXPECT_GT(mass_distance(a, b), 1e-4);
  EXPECT_GT(spring_distance(a, b), 0.1);
}

TEST(BodyDistance, OfBodiesThatDidNotDevelopIsZeroWhateverTheScene) {
  const std::vector<Override> still{{"development.control", "no-change", ""}};
  const std::string none = "name = \"mass-growth\"";
  std::vector<Override> slope = still, load = still;
  slope.push_back({"scene.gravity.slope", "30", ""});
  load.push_back({"scene.payload.share", "0.3", ""});
  const GrownBody flat = grown_from_starts(experiment_with(none, still), 1, false).front(),
                  on_slope = grown_from_starts(experiment_with(none, slope), 1, false).front(),
                  loaded = grown_from_starts(experiment_with(none, load), 1, false).front();
  EXPECT_NE(flat.positions, on_slope.positions);
  EXPECT_EQ(mass_distance(flat, on_slope), 0);
  EXPECT_EQ(spring_distance(flat, on_slope), 0);
  // the payload shifts the body; adding the payload to masses and later subtracting it causes rounding errors
  EXPECT_NE(flat.body.masses.back().rest, loaded.body.masses.back().rest);
  EXPECT_NEAR(mass_distance(flat, loaded), 0, 1e-14);
  EXPECT_EQ(spring_distance(flat, loaded), 0);
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
