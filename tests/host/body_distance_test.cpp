// Distances between grown bodies.
#include "body_distance.hpp"

#include <gtest/gtest.h>

#include "breeding.hpp"
#include "disturbance.hpp"
#include "support/experiments.hpp"

namespace evodevo {
namespace {

/// Masses of 1 kg at places, each joined to the next.
GrownBody chain(const std::vector<Vec3>& places, std::vector<std::uint32_t> numbers) {
  GrownBody grown{{}, places, std::move(numbers)};
  for (std::uint32_t i = 0; i < places.size(); ++i) {
    grown.body.masses.push_back({places[i], 1});
    if (i > 0) grown.body.springs.push_back({i - 1, i, 1, 0});
  }
  return grown;
}

TEST(BodyDistance, OfSpringsIsThePartThatOnlyOneBodyHas) {
  const std::vector<Vec3> line{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}};
  const GrownBody body = chain(line, {0, 1, 2, 3});
  EXPECT_EQ(spring_distance(body, body), 0);
  EXPECT_EQ(spring_distance(body, chain(line, {3, 2, 1, 0})), 0) << "a spring has no direction, a mass no place";
  EXPECT_EQ(spring_distance(body, chain(line, {0, 1, 2, 7})), 0.5) << "2 of 4 springs are in both";
  EXPECT_EQ(spring_distance(body, chain(line, {4, 5, 6, 7})), 1);
  EXPECT_EQ(spring_distance(body, chain(line, {0, 2, 4, 6})), 1) << "the same masses do not make the same springs";
  EXPECT_EQ(spring_distance({}, {}), 0);
  EXPECT_EQ(spring_distance(body, {}), 1);
}

TEST(BodyDistance, OfMassIsThePartThatLiesElsewhere) {
  const GrownBody along = chain({{-1, 0, 0}, {1, 0, 0}}, {0, 1}), across = chain({{0, -1, 0}, {0, 1, 0}}, {0, 1});
  EXPECT_EQ(mass_distance(along, along), 0);
  EXPECT_DOUBLE_EQ(mass_distance(along, across), 1);
  EXPECT_DOUBLE_EQ(mass_distance(across, along), 1);
  const GrownBody elsewhere = chain({{4, 5, 6}, {6, 5, 6}}, {0, 1});
  EXPECT_NEAR(mass_distance(along, elsewhere), 0, 1e-12) << "where a body is does not count";
  // half a cell of 0.2 m further out: half of each mass is in the next cell
  EXPECT_NEAR(mass_distance(chain({{-0.9, 0, 0}, {0.9, 0, 0}}, {0, 1}), along), 0.5, 1e-12);
}

TEST(BodyDistance, OfMassHasNoJumps) {
  const GrownBody body = chain({{-1, 0, 0}, {1, 0, 0}, {0.3, 0.7, 0.2}, {-0.3, -0.7, -0.2}}, {0, 1, 2, 3});
  for (const double step : {1e-3, 1e-6, 1e-9}) {
    GrownBody moved = body;
    moved.places[2].y += step, moved.places[3].y -= step;
    EXPECT_GT(mass_distance(body, moved), 0);
    EXPECT_LT(mass_distance(body, moved), 10 * step);
  }
}

/// The bodies of one random genome after so many starts.
std::vector<GrownBody> grown_from_starts(const Experiment& experiment, std::uint32_t starts, bool noise) {
  const auto simulator = make_cpu_simulator(experiment.scene, experiment.stepping, 1);
  const Individual individual = breed(experiment, {}, 0, 4, 1).front();
  const Evaluation evaluation(experiment, *simulator);
  std::vector<Life> lives = evaluation.birth(std::vector<Newborn>(starts, {individual.id, 0, &individual.genome}));
  const std::size_t born = lives.front().living.body.masses.size();
  for (std::uint32_t i = 0; noise && i < starts; ++i) disturb(lives[i], experiment, i);
  evaluation.develop(lives, [](double) {});
  std::vector<GrownBody> bodies;
  for (const Life& life : lives)
    bodies.push_back({life.living.body, life.living.state.position, mass_numbers(born, life.result.record)});
  return bodies;
}

TEST(BodyDistance, OfTwoLivesOfOneGenomeIsZeroWithoutNoiseAlone) {
  std::string text = testing::small_experiment;
  text.insert(text.find("[[fitness]]"),
              "[[development.operator]]\nname = \"mass-turnover\"\nthreshold = 100\nlimit = 2\n");
  const Experiment experiment = testing::read(
      text,
      {{"encoding.size", "[3, 2, 2]", ""}, {"development.cycles", "6", ""}, {"development.cycle_time", "0.2", ""}});
  const auto quiet = grown_from_starts(experiment, 2, false), noisy = grown_from_starts(experiment, 2, true);
  ASSERT_FALSE(quiet[0].body.springs.empty());
  EXPECT_GE(*std::max_element(quiet[0].numbers.begin(), quiet[0].numbers.end()), quiet[0].body.masses.size())
      << "no mass has come";
  EXPECT_EQ(spring_distance(quiet[0], quiet[1]), 0);
  EXPECT_EQ(mass_distance(quiet[0], quiet[1]), 0);
  EXPECT_GT(mass_distance(noisy[0], noisy[1]), 0);
}

}  // namespace
}  // namespace evodevo
