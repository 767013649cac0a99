#include "life.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

/// A chain of four springs, of which the first grows and the second shrinks.
Life chain() {
  Life life = life_of_masses(5, false);
  for (std::uint32_t s = 0; s < 4; ++s) life.add_spring(s, s + 1, bone, 1);
  life.living.body.springs[0].growth = 2.5f;
  life.living.body.springs[1].growth = 0.4f;
  return life;
}

TEST(BallisticGrowth, GoesLinearlyFromBirthToTheEnd) {
  const auto devo = make<Devo>("ballistic-growth");
  Life life = chain();
  const Body newborn = life.living.body;
  life.applications = 8;
  for (life.application = 1; life.application <= 8; ++life.application) {
    life.living = after(life, develop(*devo, life, 1));
    for (std::uint32_t s = 0; s < 4; ++s) {
      const Spring& spring = life.living.body.springs[s];
      const double expected = 1 + (static_cast<double>(spring.growth) - 1) * life.application / 8;
      EXPECT_NEAR(spring.rest_length / newborn.springs[s].rest_length, expected, 1e-12);
    }
  }
}

TEST(BallisticGrowth, GoesOnWhereOtherOperatorsLeaveALength) {
  const auto devo = make<Devo>("ballistic-growth");
  Life life = chain();
  const double at_birth = life.living.body.springs[0].rest_length;
  life.applications = 2;
  life.application = 1;
  life.living = after(life, develop(*devo, life, 1));
  life.living.body.springs[0].rest_length *= 0.9;
  life.application = 2;
  life.living = after(life, develop(*devo, life, 1));
  EXPECT_NEAR(life.living.body.springs[0].rest_length, 0.9 * 2.5 * at_birth, 1e-12);
}

TEST(BallisticGrowth, FollowsASpringWhenOthersGo) {
  Life life = chain();
  life.living = after(life, {.removed_springs = {0}, .removed_masses = {4}, .new_springs = {}});
  ASSERT_EQ(life.living.body.springs.size(), 2u);
  life.application = life.applications = 1;
  const double before = life.living.body.springs[0].rest_length;
  life.living = after(life, develop(*make<Devo>("ballistic-growth"), life, 1));
  EXPECT_NEAR(life.living.body.springs[0].rest_length, 0.4 * before, 1e-7);
}

TEST(BallisticGrowth, TwoOperatorsMultiply) {
  Life life = chain();
  const double at_birth = life.living.body.springs[0].rest_length;
  life.applications = 2;
  for (life.application = 1; life.application <= 2; ++life.application)
    for (int op = 0; op < 2; ++op) life.living = after(life, develop(*make<Devo>("ballistic-growth"), life, 1));
  EXPECT_NEAR(life.living.body.springs[0].rest_length, 2.5 * 2.5 * at_birth, 1e-12);
}

TEST(BallisticGrowth, IsOneEditForAllSprings) {
  Life life = chain();
  life.applications = 7;
  const Edits edits = develop(*make<Devo>("ballistic-growth"), life, 1);
  ASSERT_TRUE(edits.growth.has_value());
  EXPECT_EQ(std::tuple(edits.growth->from, edits.growth->to, edits.growth->whole), std::tuple(2, 3, 7));
  EXPECT_TRUE(edits.changed_springs.empty());
}

TEST(BallisticGrowth, BodiesWithoutGrowthStayAsTheyAre) {
  const auto devo = make<Devo>("ballistic-growth");
  EXPECT_TRUE(digest(develop(*devo, Life{}, 1)).empty());
  EXPECT_TRUE(digest(develop(*devo, two_chains(), 1)).empty());
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
