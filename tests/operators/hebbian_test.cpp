#include <cmath>

#include "life.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;

/// A chain of four masses and three springs of bone, muscle and tissue.
Life chain(std::vector<double> tension, std::vector<double> work) {
  Life life = life_of_masses(4, false);
  life.add_spring(0, 1, bone, 1);
  life.add_spring(1, 2, muscle, 1);
  life.add_spring(2, 3, tissue, 1);
  life.living.tension = std::move(tension);
  life.living.muscle_work = std::move(work);
  return life;
}

std::vector<double> stiffnesses(const Body& body) {
  std::vector<double> values;
  for (const Spring& spring : body.springs) values.push_back(body.stiffness(spring));
  return values;
}

TEST(Hebbian, ThreeSpringsFollowTheEquation) {
  const auto devo = make<Devo>("hebbian", "rate = 0.1\nlatest = 1.0");
  const Life life = chain({2, 1, -3}, {3, 3, 6});
  const Edits edits = develop(*devo, life, 1);
  // pull relative to its mean: 2, 1, 0; work: 3/4, 3/4, 3/2; hence x = 3/2, 3/4, 0 and Y = 3/4 for all
  EXPECT_THAT(remembered(edits.spring_memory), ElementsAre(1.5, 0.75, 0));
  EXPECT_THAT(causes(edits.changed_springs), ElementsAre(1, 0.5, 0));
  // 10,000, 5000 and 4000 N/m grow by 1 + rate H and are scaled back
  const double scale = 19000.0 / (11000 + 5250 + 4000);
  const Body before = life.living.body, body = after(life, edits).body;
  EXPECT_THAT(stiffnesses(body), ElementsAre(DoubleNear(11000 * scale, 1e-9), DoubleNear(5250 * scale, 1e-9),
                                             DoubleNear(4000 * scale, 1e-9)));
  for (std::size_t s = 0; s < 3; ++s) {  // nothing else changes
    EXPECT_EQ(body.materials[body.springs[s].material], before.materials[before.springs[s].material]);
    EXPECT_EQ(body.springs[s].rest_length, before.springs[s].rest_length);
  }
}

TEST(Hebbian, ActivityIsARunningMeanInWhichRecordsThatAreNotFiniteCountAsNone) {
  const auto devo = make<Devo>("hebbian", "latest = 0.25");
  Life life = chain({1, 1, 1}, {1, 2, 3});
  life.spring_memory() = {4, 0, 2};
  EXPECT_THAT(remembered(develop(*devo, life, 1).spring_memory),
              ElementsAre(0.75 * 4 + 0.25 * 0.5, 0.25 * 1, 0.75 * 2 + 0.25 * 1.5));
  life = chain({NAN, 1, 1}, {1, 1, INFINITY});
  EXPECT_THAT(remembered(develop(*make<Devo>("hebbian", "latest = 1.0"), life, 1).spring_memory),
              ElementsAre(0, 2.25, 0));
}

TEST(Hebbian, AnActiveSpringAloneChangesNothing) {
  const auto devo = make<Devo>("hebbian", "latest = 1.0");
  for (const auto& life : {chain({1, 0, 1}, {1, 1, 1}),     // the active ones do not meet
                           chain({-1, -1, -1}, {1, 1, 1}),  // all push
                           chain({1, 1, 1}, {0, -1, 0}),    // no muscle works
                           chain({1, 1, 0}, {0, 0, 1})}) {  // no spring does both
    const Edits edits = develop(*devo, life, 1);
    EXPECT_TRUE(edits.empty());
    EXPECT_EQ(remembered(edits.spring_memory).size(), 3u) << "what it remembers is kept up all the same";
  }
  EXPECT_TRUE(develop(*make<Devo>("hebbian", "rate = 0.0"), chain({1, 1, 1}, {1, 1, 1}), 1).empty());
}

TEST(Hebbian, TheSumOfAllStiffnessesStaysTheSame) {
  const auto devo = make<Devo>("hebbian", "rate = 0.5\nlow = 0.001\nhigh = 1e9");
  Life life = chain({2, 1, 3}, {1, 4, 2});
  for (std::uint64_t application = 0; application < 60; ++application) {
    life.living = after(life, develop(*devo, life, application));
    const std::vector<double> all = stiffnesses(life.living.body);
    EXPECT_NEAR(all[0] + all[1] + all[2], 19000, 1e-6);
  }
  EXPECT_GT(stiffnesses(life.living.body)[2], 18000) << "the spring of the largest joint activity wins";
}

TEST(Hebbian, StiffnessStaysWithinItsBounds) {
  const auto devo = make<Devo>("hebbian", "rate = 1.0\nlow = 4500.0\nhigh = 6000.0");
  const auto last = [&](Life life) {
    for (std::uint64_t application = 0; application < 50; ++application)
      life.living = after(life, develop(*devo, life, application));
    return stiffnesses(life.living.body);
  };
  EXPECT_THAT(last(chain({0, 1, 2}, {6, 3, 3})), ElementsAre(4500, 4500, 6000));
  EXPECT_THAT(last(chain({2, 1, 0}, {3, 3, 6})), ElementsAre(10000, 4500, 4000)) << "already beyond, but no further";
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
