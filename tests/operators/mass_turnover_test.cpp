#include "life.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

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

bool within(const Vec3& position, const Box& box) {
  return position.x >= box.low.x && position.y >= box.low.y && position.z >= box.low.z && position.x <= box.high.x &&
         position.y <= box.high.y && position.z <= box.high.z;
}

TEST(MassTurnover, MassesOfFewSpringsGo) {
  const auto devo = make<Devo>("mass-turnover");
  const Life life = ring();
  const Edits edits = develop(*devo, life, 1);
  // neighbours of removed masses fall below the threshold too, but degrees were compared before the removal
  EXPECT_THAT(edits.removed_masses, ::testing::UnorderedElementsAre(0, 1, 2, 3));
  EXPECT_EQ(edits.removed_masses[0], 0u) << "fewest springs first";
  EXPECT_EQ(edits.new_masses.size(), 4u);
  EXPECT_TRUE(edits.removed_springs.empty());
  EXPECT_EQ(after(life, edits).body.masses.size(), masses);
}

TEST(MassTurnover, TheNumberOfItsSpringsIsWhyAMassGoes) {
  const auto devo = make<Devo>("mass-turnover");
  Life life = ring();
  life.living.body.masses[0].air_contacts = 1;
  const Edits edits = develop(*devo, life, 1);
  ASSERT_EQ(edits.removed_masses.size(), 4u);
  EXPECT_THAT(edits.causes.removed_masses, ::testing::ElementsAre(18, 19, 19, 19)) << "with contacts through air";
  const Measure measure = devo->measure(&Causes::removed_masses);
  EXPECT_EQ(measure.name, "degree");
  EXPECT_EQ(measure.unit, "springs");
}

TEST(MassTurnover, ThresholdIsTheFewestSpringsThatStay) {
  const Life life = ring();
  EXPECT_TRUE(digest(develop(*make<Devo>("mass-turnover", "threshold = 17"), life, 1)).empty());
  EXPECT_THAT(develop(*make<Devo>("mass-turnover", "threshold = 18"), life, 1).removed_masses,
              ::testing::ElementsAre(0));
  EXPECT_EQ(develop(*make<Devo>("mass-turnover", "threshold = 21"), life, 1).removed_masses.size(), 10u);
}

TEST(MassTurnover, LimitTakesTheFewestSpringsFirstAndTiesAtRandom) {
  const auto devo = make<Devo>("mass-turnover", "limit = 2");
  const Life life = ring();
  std::vector<int> second(masses, 0);
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    const auto gone = develop(*devo, life, seed).removed_masses;
    ASSERT_EQ(gone.size(), 2u);
    EXPECT_EQ(gone[0], 0u);
    ++second[gone[1]];
  }
  for (const std::uint32_t mass : {1, 2, 3}) EXPECT_NEAR(second[mass], 100, 45);
  EXPECT_TRUE(digest(develop(*make<Devo>("mass-turnover", "limit = 0"), life, 1)).empty());
}

TEST(MassTurnover, ContactsThroughAirCount) {
  Life life = ring();
  life.living.body.masses[0].air_contacts = 3;
  life.living.body.masses[2].air_contacts = 1;
  EXPECT_THAT(develop(*make<Devo>("mass-turnover"), life, 1).removed_masses, ::testing::UnorderedElementsAre(1, 3));
}

TEST(MassTurnover, NewMassesLieInBoundsAndApart) {
  const auto devo = make<Devo>("mass-turnover", "threshold = 21\nmin_distance = 0.25");
  for (const bool resets : {false, true}) {
    Life life = ring();
    life.resets = resets;
    const DevoContext context = life.context();
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      const Edits edits = develop(*devo, life, seed);
      ASSERT_FALSE(edits.new_masses.empty());
      std::vector<Vec3> positions;
      const std::set<std::uint32_t> gone(edits.removed_masses.begin(), edits.removed_masses.end());
      for (std::uint32_t i = 0; i < masses; ++i)
        if (!gone.contains(i)) positions.push_back(context.position(i));
      for (const NewMass& mass : edits.new_masses) {
        EXPECT_TRUE(within(mass.position, life.bounds));
        EXPECT_EQ(mass.mass, 0.35);
        for (const Vec3& other : positions) EXPECT_GE(norm(mass.position - other), 0.25);
        positions.push_back(mass.position);
      }
    }
  }
}

TEST(MassTurnover, PlacesFillTheBounds) {
  const auto devo = make<Devo>("mass-turnover");
  Life life = ring();
  life.bounds = {{10, 20, 30}, {11, 22, 33}};
  Vec3 low = life.bounds.high, high = life.bounds.low;
  for (std::uint64_t seed = 0; seed < 100; ++seed)
    for (const NewMass& mass : develop(*devo, life, seed).new_masses) {
      low = {std::min(low.x, mass.position.x), std::min(low.y, mass.position.y), std::min(low.z, mass.position.z)};
      high = {std::max(high.x, mass.position.x), std::max(high.y, mass.position.y), std::max(high.z, mass.position.z)};
    }
  EXPECT_LT(norm(low - life.bounds.low), 0.15);
  EXPECT_LT(norm(high - life.bounds.high), 0.15);
}

TEST(MassTurnover, WithoutAFreePlaceTheMassStays) {
  const Life life = ring();
  EXPECT_TRUE(digest(develop(*make<Devo>("mass-turnover", "min_distance = 50.0"), life, 1)).empty());

  // there is room for one new mass: the diagonal of the box is shorter than the minimum distance
  Life narrow = life;
  narrow.bounds = {{10, 10, 10}, {11, 11, 11}};
  const Edits edits = develop(*make<Devo>("mass-turnover", "min_distance = 2.0\nsprings = 1000"), narrow, 1);
  EXPECT_THAT(edits.removed_masses, ::testing::ElementsAre(0));
  EXPECT_EQ(edits.new_masses.size(), 1u);
  EXPECT_EQ(edits.new_springs.size(), masses - 1) << "those that were to go but stay are partners too";
}

TEST(MassTurnover, OnlyMassesThatStayTakeUpRoom) {
  const auto devo = make<Devo>("mass-turnover", "threshold = 18\nmin_distance = 0.01");
  Life life = ring();
  const Vec3 place_of_the_gone = life.living.state.position[0], place_of_another = life.living.state.position[50];
  life.bounds = {place_of_the_gone, place_of_the_gone};
  EXPECT_THAT(develop(*devo, life, 1).removed_masses, ::testing::ElementsAre(0));
  life.bounds = {place_of_another, place_of_another};
  EXPECT_TRUE(develop(*devo, life, 1).removed_masses.empty());
}

TEST(MassTurnover, NewMassesAreJoinedToDifferentMassesThatStay) {
  const auto devo = make<Devo>("mass-turnover");
  const Life life = ring();
  std::set<std::uint32_t> partners_of_all;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Edits edits = develop(*devo, life, seed);
    EXPECT_EQ(edits.new_springs.size(), 4u * 25);
    std::vector<std::set<std::uint32_t>> partners(4);
    for (const NewSpring& spring : edits.new_springs) {
      const auto [old, fresh] = ordered(spring.a, spring.b);
      ASSERT_GE(fresh, masses);
      ASSERT_GE(old, 4u) << "masses 0 to 3 go";
      ASSERT_LT(old, masses);
      partners.at(fresh - masses).insert(old);
      partners_of_all.insert(old);
    }
    for (const auto& own : partners) EXPECT_EQ(own.size(), 25u);
    after(life, edits);  // throws if the host would refuse the edits
  }
  EXPECT_EQ(partners_of_all.size(), masses - 4);
}

TEST(MassTurnover, NewMassesAreJoinedToTheNearestThatStay) {
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
    after(life, edits);  // throws if the host would refuse the edits
  }
}

TEST(MassTurnover, NewSpringsAreBornWithoutForce) {
  const Life life = ring();
  const LivingBody grown = after(life, develop(*make<Devo>("mass-turnover"), life, 1));
  ASSERT_GE(grown.body.springs.size(), 100u);
  for (std::size_t s = grown.body.springs.size() - 100; s < grown.body.springs.size(); ++s) {
    const Spring& spring = grown.body.springs[s];
    EXPECT_NEAR(spring.rest_length * grown.body.materials[spring.material].relative_length(life.time),
                norm(grown.state.position[spring.a] - grown.state.position[spring.b]), 1e-12);
  }
}

TEST(MassTurnover, MaterialsAreThoseOfTheBodyButNotAir) {
  const auto devo = make<Devo>("mass-turnover");
  const Life life = ring();
  const auto materials = context().materials;
  std::set<std::int32_t> seen;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const Edits edits = develop(*devo, life, seed);
    for (const NewMass& mass : edits.new_masses) seen.insert(mass.material);
    for (const NewSpring& spring : edits.new_springs) {
      const auto [old, fresh] = ordered(spring.a, spring.b);
      EXPECT_EQ(spring.material, mean(materials[life.living.body.masses[old].material],
                                      materials[edits.new_masses[fresh - masses].material]));
    }
  }
  EXPECT_THAT(seen, ::testing::ElementsAre(bone, muscle, muscle2, tissue));
}

TEST(MassTurnover, WithoutMaterialsOfMassesSpringsTakeThoseOfOthers) {
  Life life = ring(false);
  for (Spring& spring : life.living.body.springs) spring.material = spring.a % 2 ? muscle : tissue;
  std::set<double> seen;
  const Edits edits = develop(*make<Devo>("mass-turnover"), life, 1);
  for (const NewMass& mass : edits.new_masses) EXPECT_EQ(mass.material, no_material);
  for (const NewSpring& spring : edits.new_springs) seen.insert(spring.material.stiffness);
  EXPECT_EQ(seen, (std::set<double>{4000, 5000}));
}

TEST(MassTurnover, HalfOfASmallBodyStays) {
  const auto devo = make<Devo>("mass-turnover");
  Life life = life_of_masses(7, false);
  for (std::uint32_t a = 0; a < 7; ++a)
    for (std::uint32_t b = a + 1; b < 7; ++b) life.add_spring(a, b, bone, 1);
  const Edits edits = develop(*devo, life, 1);
  EXPECT_EQ(edits.removed_masses.size(), 3u);
  EXPECT_EQ(edits.new_masses.size(), 3u);
  EXPECT_EQ(edits.new_springs.size(), 3u * 4);  // fewer than 25, since there are no other masses
  EXPECT_EQ(after(life, edits).body.springs.size(), 6u + 12);
}

TEST(MassTurnover, DegenerateBodiesStayAsTheyAre) {
  const auto devo = make<Devo>("mass-turnover");
  EXPECT_TRUE(digest(develop(*devo, Life{}, 1)).empty());
  EXPECT_TRUE(digest(develop(*devo, life_of_masses(1), 1)).empty());
  EXPECT_TRUE(digest(develop(*devo, life_of_masses(5), 1)).empty());
}

TEST(MassTurnover, DependsOnItsKeyAlone) {
  const auto devo = make<Devo>("mass-turnover");
  const Life life = ring();
  const auto edits = from_eight_threads([&] { return digest(develop(*devo, life, 1)); });
  EXPECT_NE(edits, digest(develop(*devo, life, 2)));
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
