// What masses do when regulated-growth tells them to, and its limits.
#include <cmath>

#include "regulation.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

double new_stiffness(const Body& body, const ChangedSpring& change) {
  return change.stiffness_factor.value() * body.materials[body.springs[change.spring].material].stiffness;
}

TEST_BOTH_DRAWS(MassActs, StiffensOrSoftensTheSpringsOfAMass) {
  const auto devo = make<Devo>("regulated-growth", std::string(one_act) + "\nrate = 0.2");
  Life life = varied_life();
  const Body& body = life.living.body;
  for (const float weight : {2.0f, -2.0f}) {
    life.own = genes(*devo, {{"stiffen", "contact", weight}});
    const auto most =
        static_cast<std::uint32_t>(std::max_element(life.contact.begin(), life.contact.end()) - life.contact.begin());
    const Edits edits = develop(*devo, life, 1);
    const double output = std::tanh(weight * life.contact[most]);
    std::size_t next = 0;
    for (std::uint32_t s = 0; s < body.springs.size(); ++s) {
      if (body.springs[s].a != most && body.springs[s].b != most) continue;
      ASSERT_LT(next, edits.changed_springs.size());
      const ChangedSpring& change = edits.changed_springs[next];
      EXPECT_EQ(change.spring, s);
      EXPECT_NEAR(new_stiffness(body, change), body.stiffness(body.springs[s]) * std::exp(0.2 * output), 1e-9);
      EXPECT_NEAR(edits.changed_springs[next++].cause, output, 1e-12);
    }
    EXPECT_EQ(next, edits.changed_springs.size());
  }
}

TEST_BOTH_DRAWS(MassActs, BothMassesOfASpringStiffenIt) {
  const auto devo = make<Devo>("regulated-growth", "actions = 100\nhigh = 1e6");
  Life life = two_chains();
  life.own = genes(*devo, {{"stiffen", "bias", 1.0f}});
  const Edits edits = develop(*devo, life, 1);
  ASSERT_EQ(edits.changed_springs.size(), 4u);
  for (const ChangedSpring& change : edits.changed_springs)
    EXPECT_NEAR(new_stiffness(life.living.body, change), 10000 * std::exp(0.1 * 2 * std::tanh(1.0)), 1e-9);
}

TEST_BOTH_DRAWS(MassActs, DaughtersLieWhereThereIsRoom) {
  // a chain along y at a height of 1 m; its ends have all their partners on one side
  const auto devo = make<Devo>("regulated-growth", "actions = 2\nsprings = 3\ndistance = 0.25");
  Life life = two_chains();
  life.own = genes(*devo, {{"divide", "contact", 1}});
  life.contact = {1, 0, 0.5, 0, 0, 0};
  const Edits edits = develop(*devo, life, 1);
  ASSERT_EQ(edits.new_masses.size(), 2u);
  EXPECT_EQ(edits.new_masses[0].position, (Vec3{0, -0.25, 1}));
  EXPECT_EQ(edits.new_masses[1].position, (Vec3{0, 2.25, 1}));
  EXPECT_FALSE(edits.new_masses[0].mass) << "that of the context";
  EXPECT_EQ(joined(after(life, edits).body),
            (std::set<Pair>{{0, 1}, {1, 2}, {3, 4}, {4, 5}, {0, 6}, {1, 6}, {2, 7}, {1, 7}}))
      << "to the mother and her partner";
  EXPECT_EQ(after(life, edits).body.masses.back().mass, 0.35);
  for (const std::uint32_t daughter : {0, 1}) {
    EXPECT_EQ(edits.new_masses[daughter].mother, daughter == 0 ? 0u : 2u);
    EXPECT_NEAR(edits.new_masses[daughter].cause, std::tanh(daughter == 0 ? 1 : 0.5), 1e-12);
  }

  // amid her partners the direction is random, and the floor holds
  life.contact = {0, 1, 0, 0, 0, 0};
  for (Vec3& position : life.living.state.position) position.z = 0;
  std::set<double> places;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Edits one = develop(*devo, life, seed);
    ASSERT_EQ(one.new_masses.size(), 1u);
    EXPECT_GE(one.new_masses[0].position.z, 0);
    EXPECT_LE(norm(one.new_masses[0].position - life.living.state.position[1]), 0.25 + 1e-12);
    EXPECT_THAT(one.new_springs, ::testing::SizeIs(3));
    places.insert(one.new_masses[0].position.x);
  }
  EXPECT_EQ(places.size(), 20u);
}

TEST_BOTH_DRAWS(MassActs, DaughtersGetOneSpringToEachPartnerWhateverItsNumberOfSprings) {
  const auto devo = make<Devo>("regulated-growth", "actions = 1\nsprings = 4\ndistance = 0.25");
  Life life = two_chains();
  Body& body = life.living.body;
  body.springs.insert(body.springs.end(), {body.springs[0], body.springs[1], body.springs[0]});  // parallel
  life.own = genes(*devo, {{"divide", "contact", 1}});
  life.contact = {0, 1, 0, 0, 0, 0};
  const Edits edits = develop(*devo, life, 1);
  EXPECT_EQ(edits.new_springs.size(), 3u) << "to the mother and her two partners";
  EXPECT_EQ(joined(after(life, edits).body), (std::set<Pair>{{0, 1}, {1, 2}, {3, 4}, {4, 5}, {0, 6}, {1, 6}, {2, 6}}));
}

TEST_BOTH_DRAWS(MassActs, CrowdedDaughtersAreNotBorn) {
  Life life = two_chains();
  life.contact = {1, 0, 0, 0, 0, 0};
  for (const auto& [min_distance, born] : {std::pair("0.24", 1u), {"0.26", 0u}}) {
    const auto devo = make<Devo>("regulated-growth", std::string("distance = 0.25\nmin_distance = ") + min_distance);
    life.own = genes(*devo, {{"divide", "contact", 1}});
    const Edits edits = develop(*devo, life, 1);
    EXPECT_EQ(edits.new_masses.size(), born);
    EXPECT_EQ(remembered(edits.mass_memory).size(), 2 * (6 + born));
  }
}

TEST_BOTH_DRAWS(MassActs, BodiesGrowToTheLimits) {
  const auto devo = make<Devo>("regulated-growth",
                               "actions = 5\nlimit = 40\nsprings = 4\nmost_springs = 9\nleast_springs = 2\n"
                               "low = 4000.0\nhigh = 11000.0\nmin_distance = 0.0\nrate = 1.0");
  for (const float sign : {1.0f, -1.0f}) {
    Life life = varied_life();
    life.own = genes(
        *devo, {{"divide", "bias", 1}, {"reach", "contact", 1}, {"let go", "load", 1}, {"stiffen", "bias", sign}});
    life.complete_for(*devo);
    const std::vector<double> first = life.degree;
    for (std::uint64_t application = 0; application < 30; ++application) {
      const Edits edits = develop(*devo, life, application);
      EXPECT_LE(edits.new_masses.size(), 5u);
      EXPECT_LE(edits.removed_springs.size(), 5u);
      ASSERT_NO_THROW(life.living = after(life, edits));
      life.complete_for(*devo);
      for (std::size_t i = 0; i < life.degree.size(); ++i) {
        EXPECT_LE(life.degree[i], i < 12 ? std::max(9.0, first[i]) : 9.0);
        EXPECT_GE(life.degree[i], i < 12 ? std::min(2.0, first[i]) : 1.0);
      }
    }
    EXPECT_EQ(life.living.body.masses.size(), 40u);
    for (const Spring& spring : life.living.body.springs)
      EXPECT_THAT(life.living.body.stiffness(spring), ::testing::AllOf(::testing::Ge(4000), ::testing::Le(11000)));
  }
}

TEST_BOTH_DRAWS(MassActs, NoMassLosesItsLastSprings) {
  Life life = two_chains();  // every spring has a mass at an end of its chain, which has no other
  const auto released = [&](const std::string& toml) {
    const auto devo = make<Devo>("regulated-growth", toml);
    life.own = genes(*devo, {{"let go", "bias", 1}});
    return develop(*devo, life, 1).removed_springs.size();
  };
  EXPECT_EQ(released("least_springs = 1"), 0u);
  life.add_spring(0, 2, bone, 1);  // a triangle
  EXPECT_EQ(released("least_springs = 1"), 1u) << "then two of its masses have one spring left";
  EXPECT_EQ(released("least_springs = 2"), 0u);
}

TEST_BOTH_DRAWS(MassActs, ReachesForTheNearestMassWithRoom) {
  const auto devo = make<Devo>("regulated-growth", "actions = 1\nmost_springs = 2\nsprings = 2");
  Life life = life_of_masses(5, false);
  for (std::uint32_t i = 0; i < 5; ++i) life.living.state.position[i] = {double(i), 0, 1};
  for (const auto& [a, b] : {Pair{0, 1}, {2, 3}, {2, 4}}) life.add_spring(a, b, bone, 1);
  life.own = genes(*devo, {{"reach", "contact", 1}});
  life.contact = {1, 0, 0, 0, 0};
  const Edits edits = develop(*devo, life, 1);  // 1 is joined already, and 2 is full
  ASSERT_EQ(edits.new_springs.size(), 1u);
  EXPECT_EQ(ordered(edits.new_springs[0].a, edits.new_springs[0].b), Pair(0, 3));
  EXPECT_EQ(edits.new_springs[0].material.stiffness, 10000);
  EXPECT_EQ(edits.new_springs[0].like, 0u) << "like the spring whose material it takes over";
}

TEST_BOTH_DRAWS(MassActs, OnesThatAreHeldBackGiveTheirTurnsToOthers) {
  const auto devo = make<Devo>("regulated-growth", "actions = 1\nleast_springs = 1\nmost_springs = 20");
  Life life = two_chains();  // no mass may lose a spring, except in a triangle
  life.add_spring(3, 5, bone, 0.5);
  life.own = genes(*devo, {{"let go", "contact", 1}});
  life.contact = {0, 1, 0, 0.5, 0, 0};
  EXPECT_THAT(indices(develop(*devo, life, 1).removed_springs), ::testing::ElementsAre(4)) << "mass 1 wanted it most";
}

TEST_BOTH_DRAWS(MassActs, DegenerateBodiesStayAsTheyAre) {
  const auto devo = make<Devo>("regulated-growth", "min_distance = 0.0\nleast_springs = 1");
  Life at_one_place = two_chains(), nowhere = two_chains(), airy = life_of_masses(2);
  for (Vec3& position : at_one_place.living.state.position) position = {1, 1, 1};
  for (Vec3& position : nowhere.living.state.position) position = {NAN, INFINITY, 1};
  airy.living.body.masses[0].material = airy.living.body.masses[1].material = air;  // to which nothing can be joined
  airy.add_spring(0, 1, bone, 1);
  // those without materials have nothing to make springs of
  for (Life life : {Life{}, life_of_masses(1), life_of_masses(5, false), at_one_place, nowhere, airy}) {
    life.own = genes(*devo, {{"divide", "bias", 1}, {"reach", "bias", 1}, {"let go", "bias", 1}});
    EXPECT_TRUE(develop(*devo, life, 1).empty()) << life.living.body.masses.size() << " masses";
  }
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
