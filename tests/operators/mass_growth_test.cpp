#include "life.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

TEST(MassGrowth, MassesComeAndNoneGoes) {
  const auto devo = make<Devo>("mass-growth", "masses = 7\nsprings = 3");
  const Life life = two_chains();
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Edits edits = develop(*devo, life, seed);
    EXPECT_EQ(edits.new_masses.size(), 7u);
    EXPECT_EQ(edits.new_springs.size(), 7u * 3);
    const LivingBody grown = after(life, edits);
    EXPECT_EQ(grown.body.masses.size(), 6u + 7);
    EXPECT_EQ(grown.body.springs.size(), 4u + 21);
    for (const NewMass& mass : edits.new_masses) EXPECT_EQ(mass.mass, 0.35);
  }
}

TEST(MassGrowth, EndsAtTheLimit) {
  Life life = two_chains();
  const auto devo = make<Devo>("mass-growth", "masses = 5\nlimit = 13\nsprings = 2");
  std::vector<std::size_t> sizes;
  for (std::uint64_t application = 0; application < 4; ++application) {
    life.living = after(life, develop(*devo, life, application));
    sizes.push_back(life.living.body.masses.size());
  }
  EXPECT_THAT(sizes, ::testing::ElementsAre(11, 13, 13, 13));
  EXPECT_TRUE(digest(develop(*make<Devo>("mass-growth", "limit = 3"), life, 1)).empty()) << "nor does any go";
}

TEST(MassGrowth, MassesComeOnSpringsByTheirStress) {
  const auto devo = make<Devo>("mass-growth", "masses = 1\nsprings = 1\nwhere = 'by-stress'\nmin_distance = 0.0");
  const Life life = two_chains();
  const auto& positions = life.living.state.position;
  int first_chain = 0;
  std::vector<int> along(4, 0);
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    const Edits edits = develop(*devo, life, seed);
    ASSERT_EQ(edits.new_masses.size(), 1u);
    const Vec3 position = edits.new_masses[0].position;
    bool on_spring = false;
    for (const Spring& spring : life.living.body.springs) {
      const Vec3 a = positions[spring.a], b = positions[spring.b];
      on_spring |= norm(position - a) + norm(position - b) < norm(b - a) + 1e-12;
    }
    EXPECT_TRUE(on_spring);
    first_chain += position.x < 50;
    ++along.at(static_cast<std::size_t>(4 * (position.y - std::floor(position.y))));
  }
  EXPECT_NEAR(first_chain, 750, 70);                              // five standard deviations
  for (const int quarter : along) EXPECT_NEAR(quarter, 250, 70);  // uniformly between the ends
}

TEST(MassGrowth, NoMassComesBelowTheFloorOrTooNear) {
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

TEST(MassGrowth, DegenerateBodiesStayAsTheyAre) {
  for (const char* toml : {"", "where = 'by-stress'\njoin = 'nearest'"}) {
    const auto devo = make<Devo>("mass-growth", toml);
    EXPECT_TRUE(digest(develop(*devo, Life{}, 1)).empty());
    EXPECT_TRUE(digest(develop(*devo, life_of_masses(1), 1)).empty());
    EXPECT_TRUE(digest(develop(*devo, life_of_masses(5), 1)).empty());
  }
  Life airy = life_of_masses(2);
  airy.living.body.masses[0].material = airy.living.body.masses[1].material = air;
  airy.add_spring(0, 1, bone, 1);
  EXPECT_TRUE(digest(develop(*make<Devo>("mass-growth"), airy, 1)).empty()) << "to air nothing can be joined";
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
