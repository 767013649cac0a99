// What counts as stress: the parameter that the operators have in common.
#include "life.hpp"

namespace evodevo::test {
namespace {

/// A chain of five springs, each of which one measure puts first and another last.
Life chain() {
  Life life = life_of_masses(6, false);
  for (std::uint32_t s = 0; s < 5; ++s) life.add_spring(s, s + 1, bone, s == 0 ? 9 : 5 - s * 0.1);
  life.living.peak_force = {10, 30, 11, 12, 13};
  life.living.muscle_work = {0.5, 0.1, 0.9, 0.2, 0.3};
  life.living.tension = {0, 1, 2, 4, -3};
  return life;
}

struct Measure {
  const char* by;
  SpringRequest request;
  std::uint32_t most, least;
};

class StressMeasure : public testing::TestWithParam<Measure> {
 protected:
  std::string by() const { return std::string("by = '") + GetParam().by + "'\n"; }
};

TEST_P(StressMeasure, DecidesWhichSpringIsTheMostStressed) {
  for (const char* name : {"stiffness-adaptation", "length-adaptation"}) {
    const Edits edits = develop(*make<Devo>(name, by() + "springs = 1"), chain(), 1);
    ASSERT_EQ(edits.changed_springs.size(), 1u);
    EXPECT_EQ(edits.changed_springs[0].spring, GetParam().most);
  }
}

TEST_P(StressMeasure, DecidesWhichSpringGoes) {
  const Edits edits = develop(*make<Devo>("spring-turnover", by() + "springs = 1"), chain(), 1);
  EXPECT_EQ(edits.removed_springs, std::vector{GetParam().least});
}

TEST_P(StressMeasure, DecidesWhereMassesCome) {
  Life life = chain();
  for (std::uint32_t i = 0; i < 6; ++i) life.living.state.position[i] = {10.0 * i, 0, 1};
  life.bounds = {{0, 0, 0}, {50, 0, 2}};
  const auto devo = make<Devo>("mass-growth", by() + "masses = 1\nsprings = 1\nwhere = 'by-stress'");
  int among_most = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const auto edits = develop(*devo, life, seed);
    ASSERT_EQ(edits.new_masses.size(), 1u);
    among_most += static_cast<std::uint32_t>(edits.new_masses[0].place.x / 10) == GetParam().most;
  }
  // the most stressed spring has 0.31 to 1 of the sum of what is above 0; the mean of 100 draws is off by 0.05
  EXPECT_GT(among_most, 15);
}

TEST_P(StressMeasure, IsWhatTheyAskFor) {
  const auto expect_request = [](const SpringRequest& request, const SpringRequest& expected) {
    EXPECT_EQ(request.stress, expected.stress);
    EXPECT_EQ(request.peak_force, expected.peak_force);
    EXPECT_EQ(request.muscle_work, expected.muscle_work);
    EXPECT_EQ(request.tension, expected.tension);
  };
  for (const char* name : {"spring-turnover", "stiffness-adaptation", "length-adaptation", "amplitude-adaptation"})
    expect_request(make<Devo>(name, by())->observes(), GetParam().request);
  for (const char* name : {"mass-turnover", "mass-growth"}) {
    expect_request(make<Devo>(name, by() + "where = 'by-stress'")->observes(), GetParam().request);
    expect_request(make<Devo>(name, by())->observes(), {});
  }
  expect_request(make<Devo>("ballistic-growth")->observes(), {});
}

INSTANTIATE_TEST_SUITE_P(Operators, StressMeasure,
                         testing::Values(Measure{"mean-force", {.stress = true}, 0, 4},
                                         Measure{"peak", {.peak_force = true}, 1, 0},
                                         Measure{"work", {.muscle_work = true}, 2, 1},
                                         Measure{"tension", {.tension = true}, 3, 4},
                                         Measure{"compression", {.tension = true}, 4, 3}),
                         [](const auto& test) {
                           std::string name = test.param.by;
                           std::erase(name, '-');
                           return name;
                         });

}  // namespace
}  // namespace evodevo::test
