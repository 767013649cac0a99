// Building bodies from blueprints.
#include "life/body_building.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>
#include <tuple>

#include "analysis/neighbours.hpp"
#include "support/messages.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

/// A blueprint of masses at the given positions along x, with material 0 (bone) or 1 (air).
Blueprint row(const std::vector<std::pair<double, std::int32_t>>& masses, std::uint32_t neighbours) {
  Blueprint blueprint;
  blueprint.body.materials = {{10000, 0, 0, 0}, {}};
  for (const auto& [x, material] : masses) blueprint.body.masses.push_back({{x, 0, 3}, 0.2, material, 0});
  blueprint.neighbours = neighbours;
  return blueprint;
}

/// Returns what check_blueprint() says of a blueprint for an encoding with the given context, or an empty text.
std::string fault_of(const Blueprint& blueprint, const EncodingContext& context) {
  try {
    check_blueprint(blueprint, context);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(BodyBuilding, JoinsNeighboursByTheMeanOfTheirMaterials) {
  const BuiltBody built = build_body(row({{0, 0}, {1, 1}, {3, 0}}, 1));
  ASSERT_EQ(built.failure, "");
  ASSERT_EQ(built.body.springs.size(), 2u);
  EXPECT_EQ(built.body.springs[1].rest_length, 2);
  EXPECT_EQ(built.body.springs[1].first_length, 2);
  EXPECT_EQ(built.body.materials.at(built.body.springs[0].material).stiffness, 5000);
}

TEST(BodyBuilding, LeavesOutAirAndCountsIt) {
  // masses 1 and 2 are air and neighbours of each other; both are also joined to bone
  const BuiltBody built = build_body(row({{0, 0}, {1, 1}, {2, 1}, {3, 0}}, 3));
  ASSERT_EQ(built.failure, "");
  EXPECT_EQ(built.body.springs.size(), 5u);
  EXPECT_EQ(built.body.masses[0].air_contacts, 0u);
  EXPECT_EQ(built.body.masses[1].air_contacts, 1u);
  EXPECT_EQ(built.body.masses[2].air_contacts, 1u);
}

TEST(BodyBuilding, KeepsTheLargestPieceAndDropsLooseMasses) {
  Blueprint blueprint = row({{0, 0}, {1, 0}, {10, 0}, {11, 0}, {12, 0}, {99, 0}}, 0);
  blueprint.body.springs = {{0, 1, 1, 0}, {3, 2, 1, 0}, {4, 3, 1, 0}};
  const BuiltBody built = build_body(std::move(blueprint));
  ASSERT_EQ(built.body.masses.size(), 3u);
  ASSERT_EQ(built.body.springs.size(), 2u);
  EXPECT_EQ(built.body.springs[0].a, 1u);
  EXPECT_EQ(built.body.springs[0].b, 0u);
  EXPECT_EQ(built.body.springs[1].a, 2u);
}

TEST(BodyBuilding, ABlueprintThatGrowsToNothingIsRefused) {
  Blueprint blueprint = row({{0, 0}, {1, 0}}, 0);
  blueprint.body.springs = {{0, 1, 0.8, 0}};
  const EncodingContext context{{"bone", "air"}, blueprint.body.materials, 0.2, nullptr};
  EXPECT_NO_THROW(check_blueprint(blueprint, context));
  EXPECT_EQ(build_body(blueprint).body.springs.at(0).first_length, 0.8) << "of springs by the encoding too";
  for (const float growth :
       {0.0f, -1.0f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    blueprint.body.springs[0].growth = growth;
    EXPECT_THROW(check_blueprint(blueprint, context), std::invalid_argument) << growth;
  }
}

TEST(BodyBuilding, AFailureOfTheEncodingIsCleanText) {
  Blueprint blueprint;
  blueprint.failure = "no\x1b[31m\nroom for ü\xff" + std::string(1'000'000, '!');
  const std::string failure = build_body(blueprint).failure;
  EXPECT_THAT(failure, testing::at_place("no body: ", "no\\x1b[31m\\nroom for ü\\xff!!!!"));
  EXPECT_LT(failure.size(), 400u);
}

TEST(BodyBuilding, NeighboursAreThoseOfThePlacesToPairAt) {
  Blueprint blueprint = row({{0, 0}, {1, 0}, {5, 0}, {6, 0}}, 1);
  // masses 0 and 3 are close, and so are 1 and 2; the next closest pair is 0 and 1
  blueprint.paired_at = {{0, 0, 0}, {2, 0, 0}, {3, 0, 0}, {0, 1, 0}};
  blueprint.neighbours = 2;
  const BuiltBody built = build_body(blueprint);
  ASSERT_EQ(built.failure, "");
  std::set<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (const Spring& spring : built.body.springs) {
    pairs.insert({spring.a, spring.b});
    EXPECT_EQ(spring.rest_length, norm(built.body.masses[spring.a].rest - built.body.masses[spring.b].rest));
  }
  EXPECT_EQ(pairs, (std::set<std::pair<std::uint32_t, std::uint32_t>>{{0, 1}, {0, 3}, {1, 2}, {0, 2}, {1, 3}}));

  blueprint.paired_at.back() = {std::numeric_limits<double>::infinity(), 0, 0};
  EXPECT_THAT(build_body(blueprint).failure, testing::at_place("no body: ", "pair", "not finite"));
}

TEST(BodyBuilding, SpringsToNeighboursHaveTheMeanSizeOfTheirMasses) {
  Blueprint blueprint = row({{0, 0}, {1, 0}, {3, 0}}, 1);
  blueprint.body.springs = {{0, 2, 5, 0}};
  blueprint.sizes = {{1.5, 0.5}, {0.5, 1.0}, {0.75, 1.25}};
  const BuiltBody built = build_body(blueprint);
  ASSERT_EQ(built.body.springs.size(), 3u);
  const auto expect_length = [&](std::size_t spring, double start, double end) {
    EXPECT_DOUBLE_EQ(built.body.springs[spring].rest_length, start);
    EXPECT_FLOAT_EQ(built.body.springs[spring].growth, static_cast<float>(end / start));
  };
  expect_length(0, 5, 5);  // a spring that the encoding itself made keeps its rest length
  expect_length(1, 1.0 * 1, 0.75 * 1);
  expect_length(2, 0.625 * 2, 1.125 * 2);
  EXPECT_EQ(norm(built.body.masses[2].rest - built.body.masses[1].rest), 2) << "rest places stay";

  for (const double bad : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), HUGE_VAL}) {
    blueprint.sizes[1] = {1, bad};
    EXPECT_THAT(build_body(blueprint).failure, testing::at_place("no body: ", "size", "not finite", "not above 0"));
    blueprint.sizes[1] = {bad, 1};
    EXPECT_THAT(build_body(blueprint).failure, testing::at_place("no body: ", "size", "not finite", "not above 0"));
  }
}

TEST(BodyBuilding, EachFaultOfABlueprintIsNamed) {
  Blueprint sound = row({{0, no_material}, {1, 0}, {3, 1}}, 0);
  sound.body.springs = {{0, 1, 0, 1}, {1, 2, 2, 0}};
  const EncodingContext context{.materials = sound.body.materials};
  sound.body.materials.push_back({500, 0.1, 1, 0});
  EXPECT_EQ(fault_of(sound, context), "") << "an encoding may add materials";
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const auto fault = [&](const auto& spoil) {
    Blueprint blueprint = sound;
    spoil(blueprint.body);
    return fault_of(blueprint, context);
  };
  const auto material = [&](const auto& spoil) { return fault([&](Body& body) { spoil(body.materials); }); };
  EXPECT_THAT(material([](auto& all) { all[1].stiffness += 1; }), testing::at_place("material 1 ", "context"));
  EXPECT_THAT(material([](auto& all) { all.resize(1); }), testing::at_place("material 1 ", "context"));
  EXPECT_THAT(material([](auto& all) { all.clear(); }), testing::at_place("material 0 ", "context"));
  const auto mass = [&](const auto& spoil) { return fault([&](Body& body) { spoil(body.masses[1]); }); };
  for (const double value : {0.0, -0.1, infinity, std::nan("")})
    EXPECT_THAT(mass([&](Mass& one) { one.mass = value; }), testing::at_place("mass 1 ", "above 0 kg")) << value;
  EXPECT_THAT(mass([](Mass& one) { one.material = no_material - 1; }), testing::at_place("mass 1 ", "negative"));
  EXPECT_THAT(mass([](Mass& one) { one.material = 3; }), testing::at_place("mass 1 ", "material 3", "3 materials"));
  const auto spring = [&](const auto& spoil) { return fault([&](Body& body) { spoil(body.springs[1]); }); };
  EXPECT_THAT(spring([](Spring& one) { one.a = 3; }), testing::at_place("spring 1 ", "mass 3", "3 masses"));
  EXPECT_THAT(spring([](Spring& one) { one.b = 3; }), testing::at_place("spring 1 ", "mass 3", "3 masses"));
  EXPECT_THAT(spring([](Spring& one) { one.a = one.b; }), testing::at_place("spring 1 ", "itself"));
  EXPECT_THAT(spring([](Spring& one) { one.material = 3; }),
              testing::at_place("spring 1 ", "material 3", "3 materials"));
  for (const double value : {-0.1, infinity, std::nan("")})
    EXPECT_THAT(spring([&](Spring& one) { one.rest_length = value; }), testing::at_place("spring 1 ", "rest length"))
        << value;
  for (const double value : {0.0, -0.1, infinity, std::nan("")})
    EXPECT_THAT(spring([&](Spring& one) { one.growth = value; }), testing::at_place("spring 1 ", "growth")) << value;
  for (const double value : {infinity, std::nan("")})
    EXPECT_THAT(spring([&](Spring& one) { one.phase_growth = value; }), testing::at_place("spring 1 ", "phase_growth"))
        << value;
  for (const double value : {0.0, -0.1, infinity, std::nan("")})
    EXPECT_THAT(spring([&](Spring& one) { one.stiffness_factor = value; }),
                testing::at_place("spring 1 ", "stiffness_factor"))
        << value;
}

TEST(BodyBuilding, ListsHoldAnEntryForEachMass) {
  const Blueprint sound = row({{0, 0}, {1, 0}, {3, 0}}, 1);
  const EncodingContext context{.materials = sound.body.materials};
  const auto fault = [&](auto Blueprint::*list, std::size_t entries) -> std::string {
    Blueprint blueprint = sound;
    (blueprint.*list).resize(entries);
    return fault_of(blueprint, context);
  };
  EXPECT_THAT(fault(&Blueprint::sizes, 2), testing::naming("2 ", "sizes", "3 masses"));
  EXPECT_THAT(fault(&Blueprint::paired_at, 4), testing::naming("4 ", "pair", "3 masses"));
  EXPECT_THAT(fault(&Blueprint::origins, 1), testing::naming("1 ", "origin", "3 masses"));
  for (const std::size_t entries : {0u, 3u}) EXPECT_EQ(fault(&Blueprint::sizes, entries), "");
}

TEST(BodyBuilding, NoTwoSpringsJoinOnePair) {
  Blueprint blueprint = row({{0, 0}, {1, 0}, {3, 0}, {7, 0}}, 0);
  const EncodingContext context{.materials = blueprint.body.materials};
  const auto fault = [&](std::vector<Spring> springs) -> std::string {
    blueprint.body.springs = std::move(springs);
    return fault_of(blueprint, context);
  };
  EXPECT_EQ(fault({{0, 1, 1, 0}, {2, 0, 1, 0}, {1, 2, 1, 0}, {3, 1, 1, 0}, {2, 3, 1, 0}}), "");
  EXPECT_THAT(fault({{0, 1, 1, 0}, {3, 2, 1, 0}, {2, 3, 1, 0}, {1, 0, 1, 0}}),
              testing::naming("spring 2 ", "masses 2 and 3", "joined already"));
  EXPECT_THAT(fault({{0, 3, 1, 0}, {1, 3, 1, 0}, {0, 2, 1, 0}, {3, 0, 1, 0}}),
              testing::naming("spring 3 ", "masses 3 and 0", "joined already"));
  blueprint.parallel = true;
  EXPECT_EQ(fault({{0, 3, 1, 0}, {1, 3, 1, 0}, {0, 2, 1, 0}, {3, 0, 1, 0}}), "");
}

TEST(BodyBuilding, NeighboursThatAreJoinedAlreadyAreNotJoinedAgain) {
  Blueprint blueprint = row({{0, 0}, {1, 0}, {3, 0}}, 1);
  blueprint.body.springs = {{1, 0, 0.7, 0}};
  const Body body = build_body(blueprint).body;
  ASSERT_EQ(body.springs.size(), 2u);
  EXPECT_EQ(body.springs[0].rest_length, 0.7) << "the encoding's own stays";
  EXPECT_EQ(body.springs[1].a + body.springs[1].b, 3u) << "of masses 1 and 2";
}

TEST(BodyBuilding, LooseMassesAreThoseOutsideTheLargestPiece) {
  Body body = row({{0, 0}, {1, 0}, {10, 0}, {11, 0}, {12, 0}, {99, 0}}, 0).body;
  body.springs = {{0, 1, 1, 0}, {3, 2, 1, 0}, {4, 3, 1, 0}};
  EXPECT_EQ(loose_masses(body), (std::vector<std::uint32_t>{0, 1, 5}));
  body.springs.push_back({1, 2, 1, 0});
  EXPECT_EQ(loose_masses(body), (std::vector<std::uint32_t>{5}));
  EXPECT_TRUE(loose_masses({}).empty());
}

TEST(BodyBuilding, StandsOnTheFloorOverTheOrigin) {
  const BuiltBody built = build_body(row({{4, 0}, {6, 0}}, 1));
  EXPECT_EQ(built.body.masses[0].rest, (Vec3{-1, 0, 0}));
  EXPECT_EQ(built.body.masses[1].rest, (Vec3{1, 0, 0}));
}

TEST(BodyBuilding, ALoadLiesOnTheTop) {
  Body body;
  for (const Vec3 position : {Vec3{0, 0, 0}, Vec3{2, 0, 0.79}, Vec3{0, 0, 0.81}, Vec3{3, 0, 1}})
    body.masses.push_back({position, 0.2});
  add_payload(body, 1.5, 0.2);
  const double carried[] = {0, 0, 0.6, 0.6};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_DOUBLE_EQ(body.masses[i].payload, carried[i]);
    EXPECT_DOUBLE_EQ(body.masses[i].mass, 0.2 + carried[i]);
  }
  std::vector<Vec3> positions;
  for (const Mass& mass : body.masses) positions.push_back(mass.rest);
  EXPECT_NEAR(centre_of_mass(body, positions).x, 0, 1e-15) << "over the origin with its load";
}

TEST(BodyBuilding, HeldMassesCarryNoLoad) {
  Body body;
  for (const double mass : {0.0, 0.2}) body.masses.push_back({{0, 0, 1}, mass});
  add_payload(body, 1.5, 0.2);
  EXPECT_EQ(body.masses[0].mass, 0);
  EXPECT_DOUBLE_EQ(body.masses[1].payload, 0.3);
}

TEST(BodyBuilding, SaysWhyThereIsNoBody) {
  EXPECT_THAT(build_body(row({}, 3)).failure, testing::at_place("no body: ", "masses"));
  EXPECT_THAT(build_body(row({{0, 0}}, 3)).failure, testing::naming("no springs"));
  EXPECT_THAT(build_body(row({{0, 1}, {1, 1}, {2, 1}}, 2)).failure, testing::naming("no springs")) << "all air";
  EXPECT_THAT(build_body(row({{0, 0}, {std::numeric_limits<double>::quiet_NaN(), 0}}, 1)).failure,
              testing::at_place("no body: ", "position", "not finite"));
  Blueprint failed;
  failed.failure = "nothing but air";
  EXPECT_EQ(build_body(failed).failure, "no body: nothing but air");
}

TEST(BodyBuilding, CoincidentMassesMakeABodyUnlessAllAre) {
  const BuiltBody built = build_body(row({{1, 0}, {1, 0}, {2, 0}}, 2));
  EXPECT_EQ(built.failure, "");
  EXPECT_EQ(built.body.springs.size(), 3u);
  EXPECT_THAT(build_body(row({{1, 0}, {1, 0}, {1, 0}}, 2)).failure, testing::naming("no extent"));
}

TEST(BodyBuilding, APopulationIsBuiltAsEachBodyAlone) {
  std::vector<Blueprint> blueprints{row({{0, 0}, {1, 1}, {3, 0}, {3.5, 0}}, 2), row({}, 3),
                                    row({{0, 1}, {1, 1}, {2, 1}}, 2), row({{0, 0}, {1, 0}, {10, 0}, {10.5, 0}}, 1)};
  // a body whose encoding gives it springs
  blueprints.push_back(row({{0, 0}, {1, 0}, {5, 0}}, 0));
  blueprints.back().body.springs = {{1, 2, 4, 0}};
  blueprints.push_back(blueprints.front());
  blueprints.back().sizes = {{1, 1.25}, {0.75, 1}, {1.25, 0.75}, {1.5, 1}};
  for (const int threads : {1, 3}) {
    Workers workers(threads);
    const std::vector<BuiltBody> together = build_bodies(blueprints, *make_cpu_neighbour_search(), workers);
    ASSERT_EQ(together.size(), blueprints.size());
    for (std::size_t i = 0; i < blueprints.size(); ++i) {
      const BuiltBody alone = build_body(blueprints[i]);
      EXPECT_EQ(together[i].failure, alone.failure) << i;
      EXPECT_EQ(together[i].body.materials, alone.body.materials) << i;
      ASSERT_EQ(together[i].body.masses.size(), alone.body.masses.size()) << i;
      for (std::size_t m = 0; m < alone.body.masses.size(); ++m)
        EXPECT_EQ(together[i].body.masses[m].rest, alone.body.masses[m].rest) << i;
      ASSERT_EQ(together[i].body.springs.size(), alone.body.springs.size()) << i;
      for (std::size_t s = 0; s < alone.body.springs.size(); ++s) {
        const Spring &a = together[i].body.springs[s], &b = alone.body.springs[s];
        EXPECT_EQ(std::tie(a.a, a.b, a.rest_length, a.material, a.growth),
                  std::tie(b.a, b.b, b.rest_length, b.material, b.growth))
            << i;
      }
    }
  }
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
