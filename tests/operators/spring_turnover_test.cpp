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

TEST(SpringTurnover, TheLeastStressedGoAndAsManyCome) {
  const auto devo = make<Devo>("spring-turnover");
  const Life life = busy_life();
  const Edits edits = develop(*devo, life, 1);
  std::set<double> gone;
  for (const std::uint32_t s : edits.removed_springs) gone.insert(life.living.stress[s]);
  ASSERT_EQ(gone.size(), 125u);
  EXPECT_EQ(*gone.rbegin(), 124);
  EXPECT_EQ(edits.new_springs.size(), 125u);
  EXPECT_TRUE(edits.removed_masses.empty());
  EXPECT_TRUE(edits.new_masses.empty());
  EXPECT_EQ(after(life, edits).body.springs.size(), 400u);
}

TEST(SpringTurnover, NewSpringsJoinPairsThatWereNotJoined) {
  const auto devo = make<Devo>("spring-turnover");
  const Life life = busy_life();
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    std::set<Pair> pairs = joined(life.living.body);
    for (const NewSpring& spring : develop(*devo, life, seed).new_springs) {
      EXPECT_NE(spring.a, spring.b);
      // new springs join pairs of masses that no old spring, removed or not, and no other new spring joins
      EXPECT_TRUE(pairs.insert(ordered(spring.a, spring.b)).second);
    }
  }
}

TEST(SpringTurnover, AllFreePairsAreReachedAlike) {
  const auto devo = make<Devo>("spring-turnover", "springs = 10");
  Life life = life_of_masses(12, false);
  for (std::uint32_t i = 1; i < 12; ++i) life.add_spring(0, i, bone, i);
  std::map<Pair, int> count;
  for (std::uint64_t seed = 0; seed < 1100; ++seed)
    for (const NewSpring& spring : develop(*devo, life, seed).new_springs) ++count[ordered(spring.a, spring.b)];
  ASSERT_EQ(count.size(), 55u);
  for (const auto& [pair, times] : count) EXPECT_NEAR(times, 200, 70);
}

TEST(SpringTurnover, MaterialsAreTheMeanOfTheMassesAndNeverAir) {
  const auto devo = make<Devo>("spring-turnover");
  const Life life = busy_life();
  const auto materials = context().materials;
  bool with_air = false;
  for (std::uint64_t seed = 0; seed < 10; ++seed)
    for (const NewSpring& spring : develop(*devo, life, seed).new_springs) {
      const auto a = life.living.body.masses[spring.a].material, b = life.living.body.masses[spring.b].material;
      EXPECT_EQ(spring.material, mean(materials[a], materials[b]));
      EXPECT_GT(spring.material.stiffness, 0);
      with_air |= a == air || b == air;
    }
  EXPECT_TRUE(with_air) << "masses of air are joined to others";
}

TEST(SpringTurnover, WithoutMaterialsOfMassesThoseOfTheGoneStay) {
  const auto devo = make<Devo>("spring-turnover");
  const Life life = busy_life(false);
  const Edits edits = develop(*devo, life, 1);
  std::multiset<double> gone, come;
  const auto key = [](const Material& m) { return m.stiffness + m.phase; };
  for (const std::uint32_t s : edits.removed_springs)
    gone.insert(key(life.living.body.materials[life.living.body.springs[s].material]));
  for (const NewSpring& spring : edits.new_springs) come.insert(key(spring.material));
  EXPECT_EQ(gone, come);
}

TEST(SpringTurnover, NewSpringsAreBornWithoutForce) {
  const auto devo = make<Devo>("spring-turnover");
  const Life life = busy_life();
  const LivingBody grown = after(life, develop(*devo, life, 1));
  bool some_muscle = false;
  for (std::size_t s = 400 - 125; s < 400; ++s) {
    const Spring& spring = grown.body.springs[s];
    const double distance = norm(grown.state.position[spring.a] - grown.state.position[spring.b]);
    const double relative_length = grown.body.materials[spring.material].relative_length(life.time);
    EXPECT_NEAR(spring.rest_length * relative_length, distance, 1e-12);
    some_muscle |= std::abs(relative_length - 1) > 0.01;
  }
  EXPECT_TRUE(some_muscle);
}

TEST(SpringTurnover, ResettingBodiesGetTheirRestDistances) {
  const auto devo = make<Devo>("spring-turnover");
  Life life = busy_life();
  life.resets = true;
  const LivingBody grown = after(life, develop(*devo, life, 1));
  for (std::size_t s = 400 - 125; s < 400; ++s) {
    const Spring& spring = grown.body.springs[s];
    EXPECT_NEAR(spring.rest_length, norm(grown.body.masses[spring.a].rest - grown.body.masses[spring.b].rest), 1e-12);
  }
}

TEST(SpringTurnover, BreaksTiesAtRandom) {
  const auto devo = make<Devo>("spring-turnover", "springs = 40");
  Life life = busy_life();
  // 20 springs have distinct low stresses, and all others the same high stress
  for (double& stress : life.living.stress) stress = stress < 20 ? stress : 1000;
  std::vector<int> gone(400, 0);
  for (std::uint64_t seed = 0; seed < 950; ++seed)
    for (const std::uint32_t s : develop(*devo, life, seed).removed_springs) ++gone[s];
  for (std::size_t s = 0; s < 400; ++s) {
    if (life.living.stress[s] < 20)
      EXPECT_EQ(gone[s], 950);
    else
      EXPECT_NEAR(gone[s], 50, 38);  // 20 of 380 springs; the tolerance is five and a half standard deviations
  }
}

TEST(SpringTurnover, StressThatIsNoNumberCountsAsTheGreatest) {
  const auto devo = make<Devo>("spring-turnover");
  Life life = busy_life();
  for (std::size_t s = 0; s < 400; s += 2) life.living.stress[s] = s % 4 ? std::nan("") : HUGE_VAL;
  const Edits edits = develop(*devo, life, 1);
  EXPECT_EQ(std::set(edits.removed_springs.begin(), edits.removed_springs.end()).size(), 125u);
  for (const std::uint32_t s : edits.removed_springs) EXPECT_TRUE(std::isfinite(life.living.stress[s]));
  life.living.stress.assign(400, std::nan(""));
  EXPECT_EQ(develop(*devo, life, 1).removed_springs.size(), 125u);
}

TEST(SpringTurnover, OnlyWhatCanBeReplacedGoes) {
  const auto devo = make<Devo>("spring-turnover");
  Life chain = life_of_masses(3, false);
  chain.add_spring(0, 1, bone, 2);
  chain.add_spring(1, 2, bone, 1);
  const Edits edits = develop(*devo, chain, 1);
  EXPECT_THAT(edits.removed_springs, ::testing::ElementsAre(1));
  ASSERT_EQ(edits.new_springs.size(), 1u);
  EXPECT_EQ(ordered(edits.new_springs[0].a, edits.new_springs[0].b), Pair(0, 2));

  // all masses are joined: no spring can be added, so none is removed
  chain.add_spring(0, 2, bone, 3);
  for (const char* where : {"random", "most-stressed", "by-stress"})
    EXPECT_TRUE(
        digest(develop(*make<Devo>("spring-turnover", "where = '" + std::string(where) + "'"), chain, 1)).empty());
}

TEST(SpringTurnover, SmallBodiesExchangeWhatTheyHave) {
  const auto devo = make<Devo>("spring-turnover");
  Life life = life_of_masses(30, false);
  for (std::uint32_t i = 1; i < 30; ++i) life.add_spring(i - 1, i, bone, i);
  const Edits edits = develop(*devo, life, 1);
  EXPECT_EQ(edits.removed_springs.size(), 29u);
  EXPECT_EQ(after(life, edits).body.springs.size(), 29u);
}

TEST(SpringTurnover, EachOfTheMostStressedGetsOneBeside) {
  const auto devo = make<Devo>("spring-turnover", "springs = 20\nwhere = 'most-stressed'");
  const Life life = busy_life(false);
  const auto old = joined(life.living.body);
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Edits edits = develop(*devo, life, seed);
    ASSERT_EQ(edits.new_springs.size(), 20u);
    for (const NewSpring& spring : edits.new_springs) {
      const auto closes_a_triangle_with = [&](std::size_t s) {
        const Spring& strong = life.living.body.springs[s];
        if (life.living.stress[s] < 380) return false;
        for (const auto& [from, past] : {Pair(strong.a, strong.b), Pair(strong.b, strong.a)})
          for (const auto& [from_here, to] : {Pair(spring.a, spring.b), Pair(spring.b, spring.a)})
            if (from == from_here && old.contains(ordered(past, to))) return true;
        return false;
      };
      bool found = false;
      for (std::size_t s = 0; s < 400; ++s) found |= closes_a_triangle_with(s);
      EXPECT_TRUE(found);
    }
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

TEST(SpringTurnover, SpringsComeBesideOthersByTheirStress) {
  Life life = two_chains();
  EXPECT_EQ(times_in_first_chain(life, "most-stressed"), 1000);
  EXPECT_NEAR(times_in_first_chain(life, "by-stress"), 750, 70);  // five standard deviations
  life.living.stress = {0, 0, 0, 1};
  EXPECT_EQ(times_in_first_chain(life, "by-stress"), 0);
}

TEST(SpringTurnover, WithoutStressAllSpringsAreAlike) {
  Life life = two_chains();
  for (const double stress : {0.0, 7.0, std::nan("")}) {
    life.living.stress.assign(4, stress);
    EXPECT_NEAR(times_in_first_chain(life, "by-stress"), 500, 80) << stress;
    EXPECT_NEAR(times_in_first_chain(life, "most-stressed"), 500, 80) << stress;
  }
}

TEST(SpringTurnover, NoSpringComesBesideOneWhoseStressIsNoNumber) {
  Life life = two_chains();
  life.living.stress = {std::nan(""), std::nan(""), 0.5, 0.1};
  EXPECT_EQ(times_in_first_chain(life, "by-stress"), 0);
  EXPECT_EQ(times_in_first_chain(life, "most-stressed"), 0);
}

TEST(SpringTurnover, DegenerateBodiesStayAsTheyAre) {
  const auto devo = make<Devo>("spring-turnover");
  EXPECT_TRUE(digest(develop(*devo, Life{}, 1)).empty());
  EXPECT_TRUE(digest(develop(*devo, life_of_masses(1), 1)).empty());
  EXPECT_TRUE(digest(develop(*devo, life_of_masses(5), 1)).empty());

  // two masses at the same position: a spring between them would have no direction
  Life chain = life_of_masses(3, false);
  chain.add_spring(0, 1, bone, 2);
  chain.add_spring(1, 2, bone, 1);
  chain.living.state.position[2] = chain.living.state.position[0];
  EXPECT_TRUE(digest(develop(*devo, chain, 1)).empty());

  // both masses of the only free pair are air
  Life airy = life_of_masses(3);
  airy.living.body.masses[0].material = airy.living.body.masses[2].material = air;
  airy.add_spring(0, 1, bone, 2);
  airy.add_spring(1, 2, bone, 1);
  EXPECT_TRUE(digest(develop(*devo, airy, 1)).empty());
}

TEST(SpringTurnover, DependsOnItsKeyAlone) {
  const auto devo = make<Devo>("spring-turnover");
  const Life life = busy_life();
  const auto edits = from_eight_threads([&] { return digest(develop(*devo, life, 1)); });
  EXPECT_NE(edits, digest(develop(*devo, life, 2)));
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
