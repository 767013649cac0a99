// How masses come and go: mass-turnover and mass-growth.
#include "life.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::SizeIs;
using ::testing::UnorderedElementsAre;

constexpr std::uint32_t masses = 100;

/// A ring in which every mass is joined to the ten masses on either side, except that the springs from mass 0 to 1, 2
/// and 3 are missing. So mass 0 has 17 springs, masses 1, 2 and 3 have 19, and all others have 20.
Life ring(bool with_materials = true) {
  Life life = life_of_masses(masses, with_materials);
  for (std::uint32_t i = 0; i < masses; ++i)
    for (std::uint32_t step = 1; step <= 10; ++step)
      if (i != 0 || step > 3) life.add_spring(i, (i + step) % masses, bone, 1);
  return life;
}

TEST_BOTH_DRAWS(MassTurnover, MassesOfFewSpringsGo) {
  const auto devo = make<Devo>("mass-turnover");
  const Life life = ring();
  const Edits edits = develop(*devo, life, 1);
  // neighbours of removed masses fall below the threshold too, but degrees were compared before the removal
  EXPECT_THAT(indices(edits.removed_masses), UnorderedElementsAre(0, 1, 2, 3));
  EXPECT_EQ(edits.removed_masses[0].index, 0u) << "fewest springs first";
  EXPECT_THAT(causes(edits.removed_masses), ElementsAre(17, 19, 19, 19));
  const Measure measure = devo->measure(EditKind::removed_mass);
  EXPECT_EQ(measure.name, "degree");
  EXPECT_EQ(measure.unit, "springs");
  EXPECT_THAT(edits.new_masses, SizeIs(4));
  EXPECT_TRUE(edits.removed_springs.empty());
  EXPECT_EQ(after(life, edits).body.masses.size(), masses);
}

TEST_BOTH_DRAWS(MassTurnover, ContactsThroughAirCount) {
  Life life = ring();
  life.living.body.masses[0].air_contacts = 1;
  life.living.body.masses[2].air_contacts = 1;
  const Edits edits = develop(*make<Devo>("mass-turnover"), life, 1);
  EXPECT_THAT(indices(edits.removed_masses), UnorderedElementsAre(0, 1, 3));
  EXPECT_THAT(causes(edits.removed_masses), ElementsAre(18, 19, 19));
}

TEST_BOTH_DRAWS(MassTurnover, ThresholdIsTheFewestSpringsThatStay) {
  const auto gone = [](const std::string& toml) { return develop(*make<Devo>("mass-turnover", toml), ring(), 1); };
  EXPECT_TRUE(gone("threshold = 17").empty());
  EXPECT_THAT(indices(gone("threshold = 18").removed_masses), ElementsAre(0));
  EXPECT_THAT(gone("threshold = 21").removed_masses, SizeIs(10));
}

TEST_BOTH_DRAWS(MassTurnover, LimitTakesTheFewestSpringsFirstAndTiesAtRandom) {
  const Life life = ring();
  EXPECT_TRUE(develop(*make<Devo>("mass-turnover", "limit = 0"), life, 1).empty());
  const auto devo = make<Devo>("mass-turnover", "limit = 2");
  std::vector<int> second(masses, 0);
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    const auto gone = indices(develop(*devo, life, seed).removed_masses);
    ASSERT_EQ(gone.size(), 2u);
    EXPECT_EQ(gone[0], 0u);
    ++second[gone[1]];
  }
  for (const std::uint32_t mass : {1, 2, 3}) EXPECT_NEAR(second[mass], 100, 45);
}

TEST_BOTH_DRAWS(MassTurnover, NewMassesLieInBoundsAndApart) {
  const auto devo = make<Devo>("mass-turnover", "threshold = 21\nmin_distance = 0.25");
  for (const bool resets : {false, true}) {
    Life life = ring();
    life.resets = resets;
    const DevoContext context = life.context();
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      const Edits edits = develop(*devo, life, seed);
      ASSERT_FALSE(edits.new_masses.empty());
      std::vector<Vec3> positions;
      for (std::uint32_t i = 0; i < masses; ++i)
        if (std::ranges::count(edits.removed_masses, i, &Removal::index) == 0) positions.push_back(context.position(i));
      for (const NewMass& mass : edits.new_masses) {
        const auto& [x, y, z] = mass.position;  // the bounds are (-2, -2, 0) to (2, 2, 2)
        EXPECT_TRUE(std::abs(x) <= 2 && std::abs(y) <= 2 && std::abs(z - 1) <= 1);
        EXPECT_FALSE(mass.mass) << "that of the context";
        for (const Vec3& other : positions) EXPECT_GE(norm(mass.position - other), 0.25);
        positions.push_back(mass.position);
      }
    }
  }
}

TEST_BOTH_DRAWS(MassTurnover, PlacesFillTheBounds) {
  const auto devo = make<Devo>("mass-turnover");
  Life life = ring();
  life.bounds = {{10, 20, 30}, {11, 22, 33}};
  std::vector<Vec3> places;
  for (std::uint64_t seed = 0; seed < 100; ++seed)
    for (const NewMass& mass : develop(*devo, life, seed).new_masses) places.push_back(mass.position);
  const Box box = bounding_box(places);
  EXPECT_LT(norm(box.low - life.bounds.low), 0.15);
  EXPECT_LT(norm(box.high - life.bounds.high), 0.15);
}

TEST_BOTH_DRAWS(MassTurnover, WithoutAFreePlaceTheMassStays) {
  const Life life = ring();
  EXPECT_TRUE(develop(*make<Devo>("mass-turnover", "min_distance = 50.0"), life, 1).empty());

  // there is room for one new mass: the diagonal of the box is shorter than the minimum distance
  Life narrow = life;
  narrow.bounds = {{10, 10, 10}, {11, 11, 11}};
  const Edits edits = develop(*make<Devo>("mass-turnover", "min_distance = 2.0\nsprings = 1000"), narrow, 1);
  EXPECT_THAT(indices(edits.removed_masses), ElementsAre(0));
  EXPECT_EQ(edits.new_masses.size(), 1u);
  EXPECT_EQ(edits.new_springs.size(), masses - 1) << "those that were to go but stay are partners too";
}

TEST_BOTH_DRAWS(MassTurnover, OnlyMassesThatStayTakeUpRoom) {
  const auto devo = make<Devo>("mass-turnover", "threshold = 18\nmin_distance = 0.01");
  const auto gone = [&](std::size_t at) {
    Life life = ring();
    life.bounds = {life.living.state.position[at], life.living.state.position[at]};
    return indices(develop(*devo, life, 1).removed_masses);
  };
  EXPECT_THAT(gone(0), ElementsAre(0)) << "at the place of the one that goes";
  EXPECT_TRUE(gone(50).empty());
}

TEST_BOTH_DRAWS(MassTurnover, NewMassesAreJoinedToDifferentMassesThatStayByTheMeanOfTheirMaterialsWithoutAir) {
  const auto devo = make<Devo>("mass-turnover");
  const Life life = ring();
  const auto materials = context().materials;
  std::set<std::uint32_t> partners_of_all;
  std::set<std::int32_t> seen;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const Edits edits = develop(*devo, life, seed);
    for (const NewMass& mass : edits.new_masses) seen.insert(mass.material);
    EXPECT_THAT(edits.new_springs, SizeIs(4 * 25));
    std::vector<std::set<std::uint32_t>> partners(4);
    for (const NewSpring& spring : edits.new_springs) {
      const auto [old, fresh] = ordered(spring.a, spring.b);
      ASSERT_GE(fresh, masses);
      ASSERT_GE(old, 4u) << "masses 0 to 3 go";
      ASSERT_LT(old, masses);
      partners.at(fresh - masses).insert(old);
      partners_of_all.insert(old);
      EXPECT_EQ(spring.material, mean(materials[life.living.body.masses[old].material],
                                      materials[edits.new_masses[fresh - masses].material]));
      EXPECT_FALSE(spring.rest_length) << "it is born without force";
      EXPECT_FALSE(spring.like) << "it is mixed";
    }
    EXPECT_THAT(partners, Each(SizeIs(25)));
  }
  EXPECT_EQ(partners_of_all.size(), masses - 4);
  EXPECT_THAT(seen, ElementsAre(bone, muscle, muscle2, tissue));
}

TEST_BOTH_DRAWS(MassTurnover, NewMassesAreJoinedToTheNearestThatStay) {
  const auto devo = make<Devo>("mass-turnover", "join = 'nearest'\nsprings = 7");
  for (const bool resets : {false, true}) {
    Life life = ring();
    life.resets = resets;
    const DevoContext context = life.context();
    const Edits edits = develop(*devo, life, 1);
    ASSERT_EQ(edits.new_masses.size(), 4u);
    ASSERT_EQ(edits.new_springs.size(), 4u * 7);
    for (std::uint32_t m = 0; m < 4; ++m) {
      std::vector<std::pair<double, std::uint32_t>> order;
      for (std::uint32_t i = 4; i < masses; ++i)
        order.emplace_back(norm(context.position(i) - edits.new_masses[m].position), i);
      std::sort(order.begin(), order.end());
      for (std::size_t s = 0; s < 7; ++s)
        EXPECT_EQ(ordered(edits.new_springs[7 * m + s].a, edits.new_springs[7 * m + s].b),
                  Pair(order[s].second, masses + m));
    }
  }
}

TEST_BOTH_DRAWS(MassTurnover, WithoutMaterialsOfMassesSpringsTakeThoseOfOthers) {
  Life life = ring(false);
  for (Spring& spring : life.living.body.springs) spring.material = spring.a % 2 ? muscle : tissue;
  std::set<double> seen;
  const Edits edits = develop(*make<Devo>("mass-turnover"), life, 1);
  for (const NewMass& mass : edits.new_masses) EXPECT_EQ(mass.material, no_material);
  for (const NewSpring& spring : edits.new_springs) seen.insert(spring.material.stiffness);
  EXPECT_EQ(seen, (std::set<double>{4000, 5000}));
  const Body& body = life.living.body;
  for (const NewSpring& spring : edits.new_springs) {
    ASSERT_TRUE(spring.like) << "they go on like these others";
    EXPECT_EQ(spring.material, body.materials[body.springs.at(*spring.like).material]);
  }
}

TEST_BOTH_DRAWS(MassTurnover, HalfOfASmallBodyStays) {
  const auto devo = make<Devo>("mass-turnover");
  Life life = life_of_masses(7, false);
  for (std::uint32_t a = 0; a < 7; ++a)
    for (std::uint32_t b = a + 1; b < 7; ++b) life.add_spring(a, b, bone, 1);
  const Edits edits = develop(*devo, life, 1);
  EXPECT_THAT(edits.removed_masses, SizeIs(3));
  EXPECT_THAT(edits.new_masses, SizeIs(3));
  EXPECT_THAT(edits.new_springs, SizeIs(3 * 4)) << "fewer than 25, since there are no other masses";
  EXPECT_EQ(after(life, edits).body.springs.size(), 6u + 12);
}

// mass-growth --------------------------------------------------------------------------------------------------------

TEST_BOTH_DRAWS(MassGrowth, MassesComeAndNoneGoes) {
  const auto devo = make<Devo>("mass-growth", "masses = 7\nsprings = 3");
  const Life life = two_chains();
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Edits edits = develop(*devo, life, seed);
    EXPECT_THAT(edits.new_masses, SizeIs(7));
    const Body grown = after(life, edits).body;
    EXPECT_THAT(std::span(grown.masses).subspan(6), Each(Field(&Mass::mass, 0.35)));
    EXPECT_EQ(grown.masses.size(), 6u + 7);
    EXPECT_EQ(grown.springs.size(), 4u + 7 * 3);
  }
}

TEST_BOTH_DRAWS(MassGrowth, EndsAtTheLimit) {
  Life life = two_chains();
  const auto devo = make<Devo>("mass-growth", "masses = 5\nlimit = 13\nsprings = 2");
  std::vector<std::size_t> sizes;
  for (std::uint64_t application = 0; application < 4; ++application) {
    life.living = after(life, develop(*devo, life, application));
    sizes.push_back(life.living.body.masses.size());
  }
  EXPECT_THAT(sizes, ElementsAre(11, 13, 13, 13));
  EXPECT_TRUE(develop(*make<Devo>("mass-growth", "limit = 3"), life, 1).empty()) << "nor does any go";
}

TEST_BOTH_DRAWS(MassGrowth, MassesComeAnywhereOnASpring) {
  const auto devo = make<Devo>("mass-growth", "masses = 1\nsprings = 1\nwhere = 'by-stress'\nmin_distance = 0.0");
  const Life life = two_chains();
  const auto& positions = life.living.state.position;
  std::vector<int> along(4, 0);
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    const Edits edits = develop(*devo, life, seed);
    ASSERT_EQ(edits.new_masses.size(), 1u);
    const Vec3 position = edits.new_masses[0].position;
    EXPECT_TRUE(std::ranges::any_of(life.living.body.springs, [&](const Spring& spring) {
      const Vec3 a = positions[spring.a], b = positions[spring.b];
      return norm(position - a) + norm(position - b) < norm(b - a) + 1e-12;
    }));
    ++along.at(static_cast<std::size_t>(4 * (position.y - std::floor(position.y))));
  }
  for (const int quarter : along) EXPECT_NEAR(quarter, 250, 70);  // five standard deviations
}

TEST_BOTH_DRAWS(MassGrowth, NoMassComesBelowTheFloorOrTooNear) {
  const auto devo = make<Devo>("mass-growth", "masses = 1000\nsprings = 1\nwhere = 'by-stress'\nmin_distance = 0.3");
  Life life = two_chains();
  for (Vec3& position : life.living.state.position) position.z = -0.001;  // sunk into the floor
  const Edits edits = develop(*devo, life, 1);
  ASSERT_FALSE(edits.new_masses.empty());
  EXPECT_LT(edits.new_masses.size(), 20u) << "four springs of 1 m have no more room";
  std::vector<Vec3> positions = life.living.state.position;
  for (const NewMass& mass : edits.new_masses) {
    EXPECT_GE(mass.position.z, 0);
    for (const Vec3& other : positions) EXPECT_GE(norm(mass.position - other), 0.3);
    positions.push_back(mass.position);
  }
}

TEST_BOTH_DRAWS(MassGrowth, NothingIsJoinedToAir) {
  Life airy = life_of_masses(2);
  airy.living.body.masses[0].material = airy.living.body.masses[1].material = air;
  airy.add_spring(0, 1, bone, 1);
  EXPECT_TRUE(develop(*make<Devo>("mass-growth"), airy, 1).empty());
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
