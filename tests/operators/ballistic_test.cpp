// Ballistic development: of sizes and of phases.
#include "life.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

TEST(BallisticGrowth, GoesLinearlyFromBirthToTheEndByOneEditForAllSprings) {
  const auto devo = make<Devo>("ballistic-growth");
  EXPECT_TRUE(develop(*devo, two_chains(), 1).empty()) << "without growth";
  Life life = life_of_masses(5, false);  // a chain of four springs, of which the first grows and the second shrinks
  for (std::uint32_t s = 0; s < 4; ++s) life.add_spring(s, s + 1, bone, 1);
  const std::vector<double> growth = {1.5, -0.6, 0, 0};
  life.spring_memory() = growth;
  const Body newborn = life.living.body;
  life.applications = 8;
  for (life.application = 1; life.application <= 8; ++life.application) {
    const Edits edits = develop(*devo, life, 1);
    ASSERT_TRUE(only_scales(edits));
    const Scaling& scaling = *edits.scaling;
    EXPECT_EQ(std::tuple(scaling.number, scaling.from, scaling.to, scaling.whole),
              std::tuple(0u, life.application - 1, life.application, 8));
    EXPECT_TRUE(edits.spring_memory.items.empty());
    life.living = after(life, edits);
    for (std::uint32_t s = 0; s < 4; ++s) {
      const double length = life.living.body.springs[s].rest_length;
      EXPECT_NEAR(length / newborn.springs[s].rest_length, 1 + growth[s] * life.application / 8, 1e-12);
    }
  }
}

/// A chain of four muscles, of which the first turns forwards and the second backwards, and a passive spring that would
/// turn, too.
Life chain() {
  Life life = life_of_masses(6, false);
  for (std::uint32_t s = 0; s < 5; ++s) life.add_spring(s, s + 1, s < 4 ? muscle : bone, 1);
  life.spring_memory() = {2.5, -40, 0, 0, 1};  // the second: backwards even in absolute terms, within 10 s at 1 Hz
  life.first_time = 2;
  life.last_time = 7;
  return life;
}

/// Applies the operator as in the middle of a life: at `time`, as the `application`-th of six.
void apply_at(double time, int application, Life& life) {
  life.time = time;
  life.application = application;
  life.applications = 6;
  life.living = after(life, develop(*make<Devo>("ballistic-phase"), life, 1));
}

/// Expects the relative length of a spring at a time to be that of a muscle with this phase.
void expect_phase(const Life& life, std::uint32_t spring, double time, double phase) {
  const Body& body = life.living.body;
  Material expected = context().materials[muscle];
  expected.phase = phase;
  EXPECT_NEAR(body.materials[body.springs[spring].material].relative_length(time), expected.relative_length(time), 1e-7)
      << "spring " << spring << " at " << time << " s";
}

TEST(BallisticPhase, GoesLinearlyFromTheFirstApplicationToTheLastAndThenStays) {
  Life life = chain();
  apply_at(2, 1, life);
  for (const double time : {2.0, 2.3, 4.75, 6.9, 7.0}) {
    expect_phase(life, 0, time, 2.5 * (time - 2) / 5);
    expect_phase(life, 1, time, -40 * (time - 2) / 5);
    expect_phase(life, 2, time, 0);
  }
  apply_at(7, 6, life);
  for (const double time : {7.0, 8.1, 30.2}) {
    expect_phase(life, 0, time, 2.5);
    expect_phase(life, 1, time, -40);
  }
  const Body& body = life.living.body;
  EXPECT_NEAR(body.materials[body.springs[1].material].frequency, context().materials[muscle].frequency, 1e-12);
}

TEST(BallisticPhase, ChangesMusclesTwiceAndNothingElse) {
  Life life = chain();
  life.applications = 6;
  for (life.application = 1; life.application <= 6; ++life.application) {
    const Edits edits = develop(*make<Devo>("ballistic-phase"), life, 1);
    const bool changes = life.application == 1 || life.application == 6;
    EXPECT_EQ(edits.changed_springs.size(), changes ? 2u : 0u) << life.application;
    for (const ChangedSpring& changed : edits.changed_springs) EXPECT_LT(changed.spring, 2u);
    EXPECT_FALSE(edits.scaling);
  }
}

TEST(BallisticPhase, OneApplicationChangesPhasesAtOnce) {
  Life life = chain();
  life.last_time = life.first_time;
  life.application = life.applications = 1;
  life.living = after(life, develop(*make<Devo>("ballistic-phase"), life, 1));
  expect_phase(life, 0, 2.2, 2.5);
  expect_phase(life, 1, 9.7, -40);
}

TEST(Ballistic, SpringsRememberTheirGrowthAndTheirTurnsWhichTheEncodingMustGiveThem) {
  for (const auto& [name, remembers] : {std::pair{"ballistic-growth", "growth"}, {"ballistic-phase", "turn"}}) {
    const auto devo = make<Devo>(name);
    EXPECT_THAT(devo->spring_memory(), ::testing::ElementsAre(remembers));
    EXPECT_THAT(devo->traits().needs_at_birth, ::testing::ElementsAre(remembers));
    EXPECT_TRUE(devo->mass_memory().empty() && devo->body_memory().empty());
  }
}

TEST(BallisticPhase, ComesToItsEndOnSpringsThatAreAddedMeanwhile) {
  for (const auto& [name, parameters] :
       {std::pair{"spring-turnover", "springs = 1"}, {"mass-turnover", "threshold = 2\nlimit = 1\nsprings = 3"}}) {
    Life life = life_of_masses(6, false);
    life.first_time = 2;
    life.last_time = 7;
    for (std::uint32_t s = 0; s < 5; ++s) life.add_spring(s, s + 1, muscle, 1);
    life.spring_memory() = std::vector(5, 2.5);
    const auto frequency_of = [&](const Spring& one) { return life.living.body.materials[one.material].frequency; };
    const double first = frequency_of(life.living.body.springs[0]);
    apply_at(2, 1, life);
    life.op = 1;  // what another operator remembers follows its edits, too
    const Edits edits = develop(*make<Devo>(name, parameters), life, 1);
    ASSERT_FALSE(edits.new_springs.empty()) << name;
    life.living = after(life, edits);
    life.op = 0;
    for (const Spring& spring : life.living.body.springs) EXPECT_GT(frequency_of(spring), first + 0.01) << name;
    apply_at(7, 6, life);
    for (const Spring& spring : life.living.body.springs) EXPECT_NEAR(frequency_of(spring), first, 1e-12) << name;
  }
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
