// The operators that change a property of the most stressed springs.
#include <cmath>

#include "life.hpp"
#include "support/messages.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

/// A chain of 40 springs, alternately of bone and muscle. Spring s has a stress of s N.
Life chain() {
  Life life = life_of_masses(41, false);
  for (std::uint32_t s = 0; s < 40; ++s) life.add_spring(s, s + 1, s % 2 ? muscle : bone, s);
  return life;
}

double relative_length(const Body& body, std::uint32_t s) {
  const Spring& spring = body.springs[s];
  return spring.rest_length / spring.first_length;
}
double stiffness(const Body& body, std::uint32_t s) { return body.stiffness(body.springs[s]); }
double amplitude(const Body& body, std::uint32_t s) { return body.materials[body.springs[s].material].amplitude; }

struct Property {
  const char* name;
  double (*value)(const Body&, std::uint32_t);
  bool of_muscles_alone;
  double low, high;  ///< bounds set in the tests; the values in the chain lie between them
};

class Adaptation : public ::testing::TestWithParam<Property> {
 protected:
  static std::unique_ptr<Devo> make_adaptation(const std::string& toml) {
    return make<Devo>(GetParam().name + std::string("-adaptation"), toml);
  }
  static std::unique_ptr<Devo> make_with(double factor, std::int64_t springs = 5) {
    return make_adaptation("springs = " + std::to_string(springs) + "\nfactor = " + std::to_string(factor) +
                           "\nlow = " + std::to_string(GetParam().low) + "\nhigh = " + std::to_string(GetParam().high));
  }
  double value(const Body& body, std::uint32_t s) const { return GetParam().value(body, s); }
};

TEST_P(Adaptation, MultipliesThePropertyOfTheMostStressedAloneAndChangesNothingElse) {
  const Life life = chain();
  for (const double factor : {0.9, 1.1}) {
    const LivingBody grown = after(life, develop(*make_with(factor), life, 1));
    ASSERT_EQ(grown.body.springs.size(), 40u);
    const std::uint32_t last_unchanged = GetParam().of_muscles_alone ? 40 - 11 : 40 - 6;
    for (std::uint32_t s = 0; s < 40; ++s) {
      SCOPED_TRACE(s);
      const bool changes = s > last_unchanged && (s % 2 == 1 || !GetParam().of_muscles_alone);
      EXPECT_NEAR(value(grown.body, s), (changes ? factor : 1) * value(life.living.body, s), 1e-9);
      const Spring &before = life.living.body.springs[s], &now = grown.body.springs[s];
      EXPECT_EQ(Pair(now.a, now.b), Pair(before.a, before.b));
      EXPECT_EQ(grown.stress[s], life.living.stress[s]);
      EXPECT_EQ(grown.body.materials[now.material].phase, life.living.body.materials[before.material].phase);
      EXPECT_EQ(grown.body.materials[now.material].frequency, life.living.body.materials[before.material].frequency);
      for (const auto& other : {relative_length, stiffness, amplitude})
        if (other != GetParam().value) {
          EXPECT_EQ(other(grown.body, s), other(life.living.body, s));
        }
    }
  }
}

TEST_P(Adaptation, StaysWithinItsBoundsForALifetime) {
  for (const double factor : {0.9, 1.1}) {
    Life life = chain();
    for (std::uint64_t cycle = 0; cycle < 60; ++cycle)
      life.living = after(life, develop(*make_with(factor, 1000), life, cycle));
    for (std::uint32_t s = 0; s < 40; ++s) {
      if (GetParam().of_muscles_alone && s % 2 == 0) continue;
      EXPECT_NEAR(value(life.living.body, s), factor < 1 ? GetParam().low : GetParam().high, 1e-9);
    }
    EXPECT_TRUE(digest(develop(*make_with(factor, 1000), life, 1)).empty()) << "nothing is left to change";
  }
}

TEST_P(Adaptation, WhatLiesBeyondABoundGoesNoFurtherAndIsNotPulledBack) {
  Life life = chain();
  for (Spring& spring : life.living.body.springs) spring.rest_length *= 10;
  life.living.body.materials[bone] = {50'000, 0, 0, 0};
  life.living.body.materials[muscle] = {50'000, 0.9, 1, 0};
  EXPECT_TRUE(digest(develop(*make_with(1.1, 1000), life, 1)).empty());
  const LivingBody grown = after(life, develop(*make_with(0.9, 1000), life, 1));
  EXPECT_NEAR(value(grown.body, 39), 0.9 * value(life.living.body, 39), 1e-9) << "but it may come back";
}

TEST_P(Adaptation, CountsStressThatIsNoNumberAsTheLeastAndBreaksTiesAtRandom) {
  Life life = chain();
  std::fill(life.living.stress.begin() + 20, life.living.stress.end(), std::nan(""));
  for (const ChangedSpring& change : develop(*make_with(1.1), life, 1).changed_springs) EXPECT_LT(change.spring, 20u);
  for (const double stress : {0.0, 5.0, std::nan("")}) {
    life.living.stress.assign(40, stress);
    std::vector<int> changed(40, 0);
    for (std::uint64_t seed = 0; seed < 400; ++seed)
      for (const ChangedSpring& change : develop(*make_with(1.1, 10), life, seed).changed_springs)
        ++changed[change.spring];
    for (std::uint32_t s = 0; s < 40; ++s) {
      const double expected = !GetParam().of_muscles_alone ? 100 : s % 2 ? 200 : 0;
      EXPECT_NEAR(changed[s], expected, 50) << s;  // five standard deviations
    }
  }
}

TEST_P(Adaptation, RefusesParametersThatDoNotGoTogether) {
  using evodevo::testing::at_place;
  const auto making = [](const std::string& toml) { return [toml] { make_adaptation(toml); }; };
  EXPECT_THAT(making("factor = 1.0"),
              ::testing::ThrowsMessage<ConfigError>(at_place("test.toml:1:10: test.factor = 1: ", "expected")));
  const std::string low = std::to_string(GetParam().high), high = std::to_string(GetParam().low);
  EXPECT_THAT(making("high = " + high + "\nlow = " + low),
              ::testing::ThrowsMessage<ConfigError>(at_place("test.toml:2:7: test.low = ", "high")));
  EXPECT_NO_THROW(making("high = " + low + "\nlow = " + low)()) << "a bound from both sides";
}

INSTANTIATE_TEST_SUITE_P(Properties, Adaptation,
                         ::testing::Values(Property{"length", relative_length, false, 0.5, 2},
                                           Property{"stiffness", stiffness, false, 2000, 30'000},
                                           Property{"amplitude", amplitude, true, 0.05, 0.5}),
                         [](const auto& tested) { return std::string(tested.param.name); });

/// Returns the life after an operator has been applied `applications` times.
Life lived_on(Life life, const Devo& devo, std::uint64_t applications) {
  for (std::uint64_t application = 0; application < applications; ++application)
    life.living = after(life, develop(devo, life, application));
  return life;
}

TEST_BOTH_DRAWS(LengthAdaptation, ABodyThatGrowsAndTopplesKeepsTheBounds) {
  const auto growth = make<Devo>("mass-growth", "masses = 5\nsprings = 8\nwhere = 'by-stress'");
  Life grown = lived_on(chain(), *growth, 2);
  for (Vec3& position : grown.living.state.position) position = {-position.z, position.y, position.x + 2};
  grown = lived_on(grown, *growth, 2);
  const std::vector<Spring>& springs = grown.living.body.springs;
  ASSERT_GT(springs.size(), 150u);
  const auto longer = make<Devo>("length-adaptation", "springs = 1000\nfactor = 1.2\nhigh = 1.3");
  const auto shorter = make<Devo>("length-adaptation", "springs = 1000\nfactor = 0.8\nlow = 0.7");
  const Life stretched = lived_on(grown, *longer, 3), shrunk = lived_on(grown, *shorter, 3);
  for (std::size_t s = 0; s < springs.size(); ++s) {
    EXPECT_NEAR(stretched.living.body.springs[s].rest_length, 1.3 * springs[s].rest_length, 1e-9) << s;
    EXPECT_NEAR(shrunk.living.body.springs[s].rest_length, 0.7 * springs[s].rest_length, 1e-9) << s;
  }
}

TEST_BOTH_DRAWS(LengthAdaptation, SpringsThatCameWithoutLengthStay) {
  Life life = chain();
  life.living.body.springs[39].rest_length = life.living.body.springs[39].first_length = 0;
  const Edits edits = develop(*make<Devo>("length-adaptation", "springs = 1"), life, 1);
  ASSERT_EQ(edits.changed_springs.size(), 1u);
  EXPECT_EQ(edits.changed_springs[0].spring, 38u);
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
