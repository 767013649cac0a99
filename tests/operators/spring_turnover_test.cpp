#include <cmath>
#include <map>

#include "life.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

/// A life of 60 masses and 400 springs with stresses of 0 to 399 N in random order.
Life busy_life(bool with_materials = true) {
  Life life = life_of_masses(60, with_materials);
  std::vector<std::uint32_t> stress(400);
  for (std::uint32_t i = 0; i < 400; ++i) stress[i] = i;
  Rng rng = stream(7);
  rng.shuffle(stress);
  std::set<Pair> pairs;
  while (pairs.size() < 400) {
    const std::uint32_t a = rng.below(60), b = rng.below(60);
    if (a == b || !pairs.insert(ordered(a, b)).second) continue;
    life.add_spring(a, b, static_cast<std::uint32_t>(bone + pairs.size() % 4), stress[pairs.size() - 1]);
  }
  return life;
}

TEST_BOTH_DRAWS(SpringTurnover, TheLeastStressedGoAndAsManyComeBetweenOthers) {
  const auto devo = make<Devo>("spring-turnover");
  const Life life = busy_life();
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Edits edits = develop(*devo, life, seed);
    std::set<double> gone;
    for (const std::uint32_t s : indices(edits.removed_springs)) gone.insert(life.living.stress[s]);
    ASSERT_EQ(gone.size(), 125u);
    EXPECT_EQ(*gone.rbegin(), 124);
    EXPECT_EQ(edits.new_springs.size(), 125u);
    EXPECT_TRUE(edits.removed_masses.empty());
    EXPECT_TRUE(edits.new_masses.empty());
    std::set<Pair> pairs = joined(life.living.body);
    for (const NewSpring& spring : edits.new_springs) {
      EXPECT_NE(spring.a, spring.b);
      // new springs join pairs of masses that no old spring, removed or not, and no other new spring joins
      EXPECT_TRUE(pairs.insert(ordered(spring.a, spring.b)).second);
      EXPECT_FALSE(spring.rest_length) << "the host lets it be born without force";
    }
  }
}

TEST_BOTH_DRAWS(SpringTurnover, AllFreePairsAreReachedAlike) {
  const auto devo = make<Devo>("spring-turnover", "springs = 10");
  Life life = life_of_masses(12, false);
  for (std::uint32_t i = 1; i < 12; ++i) life.add_spring(0, i, bone, i);
  std::map<Pair, int> count;
  for (std::uint64_t seed = 0; seed < 1100; ++seed)
    for (const NewSpring& spring : develop(*devo, life, seed).new_springs) ++count[ordered(spring.a, spring.b)];
  ASSERT_EQ(count.size(), 55u);
  for (const auto& [pair, times] : count) EXPECT_NEAR(times, 200, 70);
}

TEST_BOTH_DRAWS(SpringTurnover, MaterialsAreTheMeanOfTheMassesAndNeverAir) {
  const auto devo = make<Devo>("spring-turnover");
  const Life life = busy_life();
  const auto materials = context().materials;
  bool with_air = false;
  for (std::uint64_t seed = 0; seed < 10; ++seed)
    for (const NewSpring& spring : develop(*devo, life, seed).new_springs) {
      const auto a = life.living.body.masses[spring.a].material, b = life.living.body.masses[spring.b].material;
      EXPECT_EQ(spring.material, mean(materials[a], materials[b]));
      EXPECT_GT(spring.material.stiffness, 0);
      EXPECT_FALSE(spring.like) << "it is mixed";
      with_air |= a == air || b == air;
    }
  EXPECT_TRUE(with_air) << "masses of air are joined to others";
}

TEST_BOTH_DRAWS(SpringTurnover, WithoutMaterialsOfMassesThoseOfTheGoneStay) {
  const auto devo = make<Devo>("spring-turnover");
  const Life life = busy_life(false);
  const Edits edits = develop(*devo, life, 1);
  std::multiset<double> gone, come;
  const auto key = [](const Material& m) { return m.stiffness + m.phase; };
  for (const std::uint32_t s : indices(edits.removed_springs))
    gone.insert(key(life.living.body.materials[life.living.body.springs[s].material]));
  for (const NewSpring& spring : edits.new_springs) come.insert(key(spring.material));
  EXPECT_EQ(gone, come);
  std::multiset<std::uint32_t> models, removed;
  for (const NewSpring& spring : edits.new_springs) models.insert(spring.like.value());
  for (const std::uint32_t s : indices(edits.removed_springs)) removed.insert(s);
  EXPECT_EQ(models, removed) << "each goes on like the one whose place it takes";
}

TEST_BOTH_DRAWS(SpringTurnover, BreaksTiesAtRandom) {
  const auto devo = make<Devo>("spring-turnover", "springs = 40");
  Life life = busy_life();
  // 20 springs have distinct low stresses, and all others the same high stress
  for (double& stress : life.living.stress) stress = stress < 20 ? stress : 1000;
  std::vector<int> gone(400, 0);
  for (std::uint64_t seed = 0; seed < 950; ++seed)
    for (const std::uint32_t s : indices(develop(*devo, life, seed).removed_springs)) ++gone[s];
  for (std::size_t s = 0; s < 400; ++s) {
    if (life.living.stress[s] < 20)
      EXPECT_EQ(gone[s], 950);
    else
      EXPECT_NEAR(gone[s], 50, 38);  // 20 of 380 springs; the tolerance is five and a half standard deviations
  }
}

TEST_BOTH_DRAWS(SpringTurnover, StressThatIsNoNumberCountsAsTheGreatest) {
  const auto devo = make<Devo>("spring-turnover");
  Life life = busy_life();
  for (std::size_t s = 0; s < 400; s += 2) life.living.stress[s] = s % 4 ? std::nan("") : HUGE_VAL;
  const Edits edits = develop(*devo, life, 1);
  const std::vector<std::uint32_t> removed = indices(edits.removed_springs);
  EXPECT_EQ(std::set(removed.begin(), removed.end()).size(), 125u);
  for (const std::uint32_t s : indices(edits.removed_springs)) EXPECT_TRUE(std::isfinite(life.living.stress[s]));
  life.living.stress.assign(400, std::nan(""));
  EXPECT_EQ(develop(*devo, life, 1).removed_springs.size(), 125u);
}

TEST_BOTH_DRAWS(SpringTurnover, OnlyWhatCanBeReplacedGoes) {
  const auto devo = make<Devo>("spring-turnover");
  Life chain = life_of_masses(3, false);
  chain.add_spring(0, 1, bone, 2);
  chain.add_spring(1, 2, bone, 1);
  const Edits edits = develop(*devo, chain, 1);
  EXPECT_THAT(indices(edits.removed_springs), ::testing::ElementsAre(1));
  ASSERT_EQ(edits.new_springs.size(), 1u);
  EXPECT_EQ(ordered(edits.new_springs[0].a, edits.new_springs[0].b), Pair(0, 2));

  // all masses are joined: no spring can be added, so none is removed
  chain.add_spring(0, 2, bone, 3);
  for (const std::string where : {"random", "most-stressed", "by-stress"})
    EXPECT_TRUE(digest(develop(*make<Devo>("spring-turnover", "where = '" + where + "'"), chain, 1)).empty());

  // small bodies exchange what they have
  Life small = life_of_masses(30, false);
  for (std::uint32_t i = 1; i < 30; ++i) small.add_spring(i - 1, i, bone, i);
  const Edits exchange = develop(*devo, small, 1);
  EXPECT_EQ(exchange.removed_springs.size(), 29u);
  EXPECT_EQ(after(small, exchange).body.springs.size(), 29u);
}

TEST_BOTH_DRAWS(SpringTurnover, EachOfTheMostStressedGetsOneBeside) {
  const auto devo = make<Devo>("spring-turnover", "springs = 20\nwhere = 'most-stressed'");
  const Life life = busy_life(false);
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Edits edits = develop(*devo, life, seed);
    ASSERT_EQ(edits.new_springs.size(), 20u);
    const std::vector<double> beside = causes(edits.new_springs);
    EXPECT_THAT(beside, ::testing::AllOf(::testing::SizeIs(20), ::testing::Each(::testing::Ge(380))));
    EXPECT_GT(std::set(beside.begin(), beside.end()).size(), 5u) << "in turns";
    after(life, edits);  // throws if the host would refuse the edits
  }
}

/// Returns how often, in 1,000 trials, the new spring in `two_chains` is in the first chain.
int times_in_first_chain(const Life& life, const std::string& where) {
  const auto devo = make<Devo>("spring-turnover", "springs = 1\nwhere = '" + where + "'");
  int first = 0, second = 0;
  for (std::uint64_t seed = 0; seed < 1000; ++seed)
    for (const NewSpring& spring : develop(*devo, life, seed).new_springs) {
      first += ordered(spring.a, spring.b) == Pair(0, 2);
      second += ordered(spring.a, spring.b) == Pair(3, 5);
    }
  EXPECT_EQ(first + second, 1000) << "there is no other triangle to close";
  return first;
}

TEST_BOTH_DRAWS(SpringTurnover, SpringsComeBesideOthersByTheirStress) {
  const double nan = std::nan("");
  const struct {
    std::vector<double> stress;
    int by_stress, most_stressed;  ///< of 1,000
    double tolerance;              ///< five standard deviations
  } cases[] = {{{3, 3, 1, 1}, 750, 1000, 70},        {{0, 0, 0, 1}, 0, 0, 0},
               {{0, 0, 0, 0}, 500, 500, 80},         {{7, 7, 7, 7}, 500, 500, 80},
               {{nan, nan, nan, nan}, 500, 500, 80}, {{nan, nan, 0.5, 0.1}, 0, 0, 0}};
  Life life = two_chains();
  for (const auto& [stress, by_stress, most_stressed, tolerance] : cases) {
    life.living.stress = stress;
    EXPECT_NEAR(times_in_first_chain(life, "by-stress"), by_stress, tolerance) << ::testing::PrintToString(stress);
    EXPECT_NEAR(times_in_first_chain(life, "most-stressed"), most_stressed, most_stressed == 500 ? tolerance : 0)
        << ::testing::PrintToString(stress);
  }
}

TEST_BOTH_DRAWS(SpringTurnover, NoSpringJoinsMassesAtOnePlaceOrOfAir) {
  const auto devo = make<Devo>("spring-turnover");
  Life life = life_of_masses(3);
  life.add_spring(0, 1, bone, 2);
  life.add_spring(1, 2, bone, 1);
  Life at_one_place = life;
  at_one_place.living.state.position[2] = at_one_place.living.state.position[0];
  EXPECT_TRUE(digest(develop(*devo, at_one_place, 1)).empty());
  life.living.body.masses[0].material = life.living.body.masses[2].material = air;
  EXPECT_TRUE(digest(develop(*devo, life, 1)).empty());
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
