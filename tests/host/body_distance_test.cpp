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

TEST(BodyDistance, OfMassIsThePartThatOnlyOneBodyHasWhereverItLies) {
  const std::vector<Vec3> line{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}},
      turned{{5, 5, 0}, {5, 6, 0}, {5, 7, 0}, {5, 8, 0}};
  const GrownBody body = chain(line, {0, 1, 2, 3});
  EXPECT_EQ(mass_distance(body, chain(turned, {0, 1, 2, 3})), 0);
  EXPECT_EQ(mass_distance(body, chain(line, {3, 1, 0, 2})), 0) << "masses have no order";
  EXPECT_DOUBLE_EQ(mass_distance(body, chain(turned, {0, 1, 2, 7})), 2.0 / 5);
  EXPECT_EQ(mass_distance(body, chain(line, {4, 5, 6, 7})), 1);
  EXPECT_EQ(mass_distance({}, {}), 0);
  EXPECT_EQ(mass_distance(body, {}), 1);
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
      {{"encoding.size", "[3, 2, 2]", ""}, {"development.cycles", "30", ""}, {"development.cycle_time", "0.2", ""}});
  const auto quiet = grown_from_starts(experiment, 2, false), noisy = grown_from_starts(experiment, 2, true);
  ASSERT_FALSE(quiet[0].body.springs.empty());
  EXPECT_GE(*std::max_element(quiet[0].numbers.begin(), quiet[0].numbers.end()), quiet[0].body.masses.size())
      << "no mass has come";
  EXPECT_EQ(spring_distance(quiet[0], quiet[1]), 0);
  EXPECT_EQ(mass_distance(quiet[0], quiet[1]), 0);
  EXPECT_GT(spring_distance(noisy[0], noisy[1]), 0);
}

}  // namespace
}  // namespace evodevo
