// The parameter that chooses the measure of stress, which several operators have.
#include "life.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

/// A chain of five springs, which different measures put into different orders.
Life chain() {
  Life life = life_of_masses(6, false);
  for (std::uint32_t s = 0; s < 5; ++s) life.add_spring(s, s + 1, bone, s == 0 ? 9 : 5 - s * 0.1);
  life.living.peak_force = {10, 30, 11, 12, 13};
  life.living.muscle_work = {0.5, 0.1, 0.9, 0.2, 0.3};
  life.living.tension = {0, 1, 2, 4, -3};
  return life;
}

struct Judgement {
  const char* by;
  RecordRequest request;
  std::uint32_t most, least;
};

class StressMeasure : public ::testing::TestWithParam<Judgement> {
 protected:
  std::string by() const { return std::string("by = '") + GetParam().by + "'\n"; }

  /// The values by which the springs of `life` are ordered.
  std::vector<double> stress(const Life& life) const {
    const std::string name = GetParam().by;
    const LivingBody& records = life.living;
    std::vector<double> stress = name == "mean-force" ? records.stress
                                 : name == "peak"     ? records.peak_force
                                 : name == "work"     ? records.muscle_work
                                                      : records.tension;
    if (name == "compression")
      for (double& value : stress) value = -value;
    return stress;
  }
};

TEST_P(StressMeasure, DecidesWhichSpringIsTheMostStressedAndWhichGoes) {
  const double most = stress(chain())[GetParam().most], least = stress(chain())[GetParam().least];
  for (const char* name : {"stiffness-adaptation", "length-adaptation"}) {
    const Edits edits = develop(*make<Devo>(name, by() + "springs = 1"), chain(), 1);
    ASSERT_EQ(edits.changed_springs.size(), 1u);
    EXPECT_EQ(edits.changed_springs[0].spring, GetParam().most);
    EXPECT_EQ(causes(edits.changed_springs), std::vector{most});
  }
  const Edits edits = develop(*make<Devo>("spring-turnover", by() + "springs = 1"), chain(), 1);
  EXPECT_EQ(indices(edits.removed_springs), std::vector{GetParam().least});
  EXPECT_EQ(causes(edits.removed_springs), std::vector{least});
  EXPECT_TRUE(causes(edits.new_springs).empty()) << "the place is random";
  const auto beside =
      develop(*make<Devo>("spring-turnover", by() + "springs = 1\nwhere = 'most-stressed'"), chain(), 1);
  EXPECT_EQ(causes(beside.new_springs), std::vector{most});
}

TEST_P(StressMeasure, IsTheCauseOfSpringsThatAreDrawnByIt) {
  const auto drawn = develop(*make<Devo>("spring-turnover", by() + "springs = 2\nwhere = 'by-stress'"), chain(), 1);
  ASSERT_FALSE(drawn.new_springs.empty());
  for (std::size_t i = 0; i < drawn.new_springs.size(); ++i) {
    // the cause is one of the two springs between the chain's masses i, i + 1 and i + 2
    const std::uint32_t first = std::min(drawn.new_springs[i].a, drawn.new_springs[i].b);
    EXPECT_THAT(drawn.new_springs[i].cause, ::testing::AnyOf(stress(chain())[first], stress(chain())[first + 1]));
  }
}

TEST_P(StressMeasure, HasANameAndAUnit) {
  const std::pair<const char*, EditKind> edits[] = {{"spring-turnover", EditKind::removed_spring},
                                                    {"spring-turnover", EditKind::new_spring},
                                                    {"mass-turnover", EditKind::new_mass},
                                                    {"mass-growth", EditKind::new_mass},
                                                    {"length-adaptation", EditKind::changed_spring}};
  for (const auto& [name, kind] : edits) {
    const Measure measure = make<Devo>(name, by())->measure(kind);
    EXPECT_EQ(measure.name, GetParam().by);
    EXPECT_EQ(measure.unit, measure.name == "work" ? "J" : "N");
  }
}

TEST_P(StressMeasure, DecidesWhereMassesCome) {
  Life life = chain();
  for (std::uint32_t i = 0; i < 6; ++i) life.living.state.position[i] = {10.0 * i, 0, 1};
  life.bounds = {{0, 0, 0}, {50, 0, 2}};
  const auto devo = make<Devo>("mass-growth", by() + "masses = 1\nsprings = 1\nwhere = 'by-stress'");
  const std::vector<double> stress = this->stress(life);
  double sum = 0;
  for (const double value : stress) sum += std::max(0.0, value);
  constexpr int draws = 2000;
  std::vector<int> masses_on(5, 0);
  for (std::uint64_t seed = 0; seed < draws; ++seed) {
    const auto edits = develop(*devo, life, seed);
    ASSERT_EQ(edits.new_masses.size(), 1u);
    const auto spring = static_cast<std::size_t>(edits.new_masses[0].position.x / 10);
    ++masses_on.at(spring);
    EXPECT_EQ(causes(edits.new_masses), std::vector{stress[spring]});
  }
  for (std::size_t s = 0; s < 5; ++s) {
    const double share = std::max(0.0, stress[s]) / sum;
    EXPECT_NEAR(masses_on[s], draws * share, 5 * std::sqrt(draws * share * (1 - share))) << s;
  }
}

TEST_P(StressMeasure, IsWhatTheyAskFor) {
  const auto expect_request = [](const RecordRequest& request, const RecordRequest& expected) {
    const auto fields = [](const RecordRequest& r) {
      return std::tuple(r.stress, r.peak_force, r.muscle_work, r.tension);
    };
    EXPECT_EQ(fields(request), fields(expected));
  };
  for (const char* name : {"spring-turnover", "stiffness-adaptation", "length-adaptation", "amplitude-adaptation"})
    expect_request(make<Devo>(name, by())->observes(), GetParam().request);
  for (const char* name : {"mass-turnover", "mass-growth"}) {
    expect_request(make<Devo>(name, by() + "where = 'by-stress'")->observes(), GetParam().request);
    expect_request(make<Devo>(name, by())->observes(), {});
  }
  expect_request(make<Devo>("ballistic-growth")->observes(), {});
  expect_request(make<Devo>("ballistic-phase")->observes(), {});
}

INSTANTIATE_TEST_SUITE_P(Operators, StressMeasure,
                         ::testing::Values(Judgement{"mean-force", {.stress = true}, 0, 4},
                                           Judgement{"peak", {.peak_force = true}, 1, 0},
                                           Judgement{"work", {.muscle_work = true}, 2, 1},
                                           Judgement{"tension", {.tension = true}, 3, 4},
                                           Judgement{"compression", {.tension = true}, 4, 3}),
                         [](const auto& test) {
                           std::string name = test.param.by;
                           std::erase(name, '-');
                           return name;
                         });

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
