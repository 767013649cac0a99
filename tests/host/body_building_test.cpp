// Bodies: building them from blueprints, and reading them from JSON files, which restores every bit.
#include "life/body_building.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "analysis/neighbours.hpp"
#include "base/input_error.hpp"
#include "base/philox.hpp"
#include "life/body_json.hpp"
#include "support/bodies.hpp"
#include "support/messages.hpp"
#include "support/refusals.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

using ::testing::ElementsAre;
using ::testing::UnorderedElementsAre;

/// A blueprint of masses at the given positions along x, with material 0 (bone) or 1 (air).
Blueprint row(const std::vector<std::pair<double, std::int32_t>>& masses, std::uint32_t neighbours) {
  Blueprint blueprint;
  blueprint.body.materials = {{10000, 0, 0, 0}, {}};
  for (const auto& [x, material] : masses) blueprint.body.masses.push_back({{x, 0, 3}, 0.2, material, 0});
  blueprint.neighbours = neighbours;
  return blueprint;
}

/// Returns what check_blueprint() says of a blueprint for an encoding whose context has the materials of row().
std::string fault_of(const Blueprint& blueprint) {
  const EncodingContext context{.materials = row({}, 0).body.materials};
  return testing::refusal<std::invalid_argument>([&] { check_blueprint(blueprint, context); });
}

constexpr double infinity = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();

/// Which masses the springs of a body join.
std::vector<std::pair<std::uint32_t, std::uint32_t>> joined(const Body& body) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (const Spring& spring : body.springs) pairs.emplace_back(spring.a, spring.b);
  return pairs;
}

TEST(BodyBuilding, JoinsNeighboursByTheMeanOfTheirMaterialsAndStandsOnTheFloor) {
  const BuiltBody built = build_body(row({{0, 0}, {1, 1}, {3, 0}}, 1));
  ASSERT_EQ(built.failure, "");
  ASSERT_EQ(built.body.springs.size(), 2u);
  EXPECT_EQ(built.body.springs[1].rest_length, 2);
  EXPECT_EQ(built.body.springs[1].first_length, 2);
  EXPECT_EQ(built.body.materials.at(built.body.springs[0].material).stiffness, 5000);
  const BuiltBody other = build_body(row({{4, 0}, {6, 0}}, 1));
  EXPECT_EQ(other.body.masses[0].rest, (Vec3{-1, 0, 0})) << "on the floor, over the origin";
  EXPECT_EQ(other.body.masses[1].rest, (Vec3{1, 0, 0}));
}

TEST(BodyBuilding, AMassThatIsJoinedToItsNeighboursNeedsAMaterial) {
  EXPECT_THAT(fault_of(row({{0, 0}, {1, no_material}}, 1)), testing::naming("mass 1", "no material", "neighbours = 0"));
  EXPECT_EQ(fault_of(row({{0, 0}, {1, no_material}}, 0)), "no refusal");
}

TEST(BodyBuilding, LeavesOutAirAndCountsIt) {
  // masses 1 and 2 are air and neighbours of each other; both are also joined to bone
  const BuiltBody built = build_body(row({{0, 0}, {1, 1}, {2, 1}, {3, 0}}, 3));
  ASSERT_EQ(built.failure, "");
  EXPECT_EQ(built.body.springs.size(), 5u);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(built.body.masses[i].air_contacts, i % 3 == 0 ? 0u : 1u) << i;
}

TEST(BodyBuilding, KeepsTheLargestPieceAndDropsLooseMasses) {
  Blueprint blueprint = row({{0, 0}, {1, 0}, {10, 0}, {11, 0}, {12, 0}, {99, 0}}, 0);
  blueprint.body.springs = {{0, 1, 1, 0}, {3, 2, 1, 0}, {4, 3, 1, 0}};
  EXPECT_THAT(loose_masses(blueprint.body), ElementsAre(0, 1, 5));
  const Body body = build_body(blueprint).body;
  EXPECT_EQ(body.masses.size(), 3u);
  EXPECT_THAT(joined(body), ElementsAre(std::pair(1, 0), std::pair(2, 1)));
  blueprint.body.springs.push_back({1, 2, 1, 0});
  EXPECT_THAT(loose_masses(blueprint.body), ElementsAre(5));
  EXPECT_TRUE(loose_masses({}).empty());
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
  for (const Spring& spring : built.body.springs)
    EXPECT_EQ(spring.rest_length, norm(built.body.masses[spring.a].rest - built.body.masses[spring.b].rest));
  EXPECT_THAT(joined(built.body), UnorderedElementsAre(std::pair(0, 1), std::pair(0, 3), std::pair(1, 2),
                                                       std::pair(0, 2), std::pair(1, 3)));

  blueprint.paired_at.back() = {infinity, 0, 0};
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

  for (const double bad : {0.0, -1.0, nan, infinity})
    for (const Size& size : {Size{1, bad}, Size{bad, 1}}) {
      blueprint.sizes[1] = size;
      EXPECT_THAT(build_body(blueprint).failure, testing::at_place("no body: ", "size", "not finite", "not above 0"));
    }
}

TEST(BodyBuilding, EachFaultOfABlueprintIsNamed) {
  Blueprint sound = row({{0, no_material}, {1, 0}, {3, 1}}, 0);
  sound.body.springs = {{0, 1, 0, 1}, {1, 2, 2, 0}};
  sound.body.materials.push_back({500, 0.1, 1, 0});
  EXPECT_EQ(fault_of(sound), "no refusal") << "an encoding may add materials";
  sound.body.materials.back().amplitude = 0.91;
  EXPECT_THAT(fault_of(sound), testing::naming("material 2", "amplitude", "0.9"));
  sound.body.materials.back().amplitude = 0.9;
  const auto fault = [&](const auto& spoil) {
    Blueprint blueprint = sound;
    spoil(blueprint.body);
    return fault_of(blueprint);
  };
  const auto material = [&](const auto& spoil) { return fault([&](Body& body) { spoil(body.materials); }); };
  EXPECT_THAT(material([](auto& all) { all[1].stiffness += 1; }), testing::at_place("material 1 ", "context"));
  EXPECT_THAT(material([](auto& all) { all.resize(1); }), testing::at_place("material 1 ", "context"));
  EXPECT_THAT(material([](auto& all) { all.clear(); }), testing::at_place("material 0 ", "context"));
  /// Expects that the second item of a list is named if one of its members has this value.
  const auto expect = [&](auto list, auto member, auto value, const std::string& place, const auto&... parts) {
    EXPECT_THAT(fault([&](Body& body) { (body.*list)[1].*member = value; }), testing::at_place(place, parts...))
        << value;
  };
  for (const double value : {0.0, -0.1, infinity, nan})
    expect(&Body::masses, &Mass::mass, value, "mass 1 ", "above 0 kg");
  expect(&Body::masses, &Mass::material, no_material - 1, "mass 1 ", "negative");
  expect(&Body::masses, &Mass::material, 3, "mass 1 ", "material 3", "3 materials");
  expect(&Body::springs, &Spring::a, 3u, "spring 1 ", "mass 3", "3 masses");
  expect(&Body::springs, &Spring::b, 3u, "spring 1 ", "mass 3", "3 masses");
  expect(&Body::springs, &Spring::a, 2u, "spring 1 ", "itself");
  expect(&Body::springs, &Spring::material, 3u, "spring 1 ", "material 3", "3 materials");
  for (const double value : {-0.1, infinity, nan})
    expect(&Body::springs, &Spring::rest_length, value, "spring 1 ", "rest length");
  for (const float value : {0.0f, -0.1f, HUGE_VALF, NAN}) {
    expect(&Body::springs, &Spring::growth, value, "spring 1 ", "growth");
    expect(&Body::springs, &Spring::stiffness_factor, value, "spring 1 ", "stiffness_factor");
  }
  for (const float value : {HUGE_VALF, NAN})
    expect(&Body::springs, &Spring::phase_growth, value, "spring 1 ", "phase_growth");
}

TEST(BodyBuilding, ListsHoldAnEntryForEachMass) {
  const auto fault = [](auto Blueprint::*list, std::size_t entries) {
    Blueprint blueprint = row({{0, 0}, {1, 0}, {3, 0}}, 1);
    (blueprint.*list).resize(entries);
    return fault_of(blueprint);
  };
  EXPECT_THAT(fault(&Blueprint::sizes, 2), testing::naming("2 ", "sizes", "3 masses"));
  EXPECT_THAT(fault(&Blueprint::paired_at, 4), testing::naming("4 ", "pair", "3 masses"));
  EXPECT_THAT(fault(&Blueprint::origins, 1), testing::naming("1 ", "origin", "3 masses"));
  for (const std::size_t entries : {0u, 3u}) EXPECT_EQ(fault(&Blueprint::sizes, entries), "no refusal");
}

TEST(BodyBuilding, NoTwoSpringsJoinOnePair) {
  Blueprint blueprint = row({{0, 0}, {1, 0}, {3, 0}, {7, 0}}, 0);
  const auto fault = [&](const std::vector<Spring>& springs) {
    blueprint.body.springs = springs;
    return fault_of(blueprint);
  };
  EXPECT_EQ(fault({{0, 1, 1, 0}, {2, 0, 1, 0}, {1, 2, 1, 0}, {3, 1, 1, 0}, {2, 3, 1, 0}}), "no refusal");
  EXPECT_THAT(fault({{0, 1, 1, 0}, {3, 2, 1, 0}, {2, 3, 1, 0}, {1, 0, 1, 0}}),
              testing::naming("spring 2 ", "masses 2 and 3", "joined already"));
  const std::vector<Spring> twice{{0, 3, 1, 0}, {1, 3, 1, 0}, {0, 2, 1, 0}, {3, 0, 1, 0}};
  EXPECT_THAT(fault(twice), testing::naming("spring 3 ", "masses 3 and 0", "joined already"));
  blueprint.parallel = true;
  EXPECT_EQ(fault(twice), "no refusal");
}

TEST(BodyBuilding, NeighboursThatAreJoinedAlreadyAreNotJoinedAgain) {
  Blueprint blueprint = row({{0, 0}, {1, 0}, {3, 0}}, 1);
  blueprint.body.springs = {{1, 0, 0.7, 0}};
  const Body body = build_body(blueprint).body;
  EXPECT_THAT(joined(body), ElementsAre(std::pair(1, 0), ::testing::AnyOf(std::pair(1, 2), std::pair(2, 1))));
  EXPECT_EQ(body.springs[0].rest_length, 0.7) << "the encoding's own stays";
  EXPECT_EQ(body.springs[0].first_length, 0.7);
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

  body = {};
  for (const double mass : {0.0, 0.2}) body.masses.push_back({{0, 0, 1}, mass});
  add_payload(body, 1.5, 0.2);
  EXPECT_EQ(body.masses[0].mass, 0) << "held masses carry none";
  EXPECT_DOUBLE_EQ(body.masses[1].payload, 0.3);
}

TEST(BodyBuilding, SaysWhyThereIsNoBody) {
  EXPECT_THAT(build_body(row({{1, 0}, {1, 0}, {1, 0}}, 2)).failure, testing::naming("no extent"));
  const BuiltBody coincident = build_body(row({{1, 0}, {1, 0}, {2, 0}}, 2));
  EXPECT_EQ(coincident.failure, "");
  EXPECT_EQ(coincident.body.springs.size(), 3u);
  EXPECT_THAT(build_body(row({}, 3)).failure, testing::at_place("no body: ", "masses"));
  EXPECT_THAT(build_body(row({{0, 0}}, 3)).failure, testing::naming("no springs"));
  EXPECT_THAT(build_body(row({{0, 1}, {1, 1}, {2, 1}}, 2)).failure, testing::naming("no springs")) << "all air";
  EXPECT_THAT(build_body(row({{0, 0}, {nan, 0}}, 1)).failure, testing::at_place("no body: ", "position", "not finite"));
}

TEST(BodyBuilding, APopulationIsBuiltAsEachBodyAlone) {
  const auto four = row({{0, 0}, {1, 1}, {3, 0}, {3.5, 0}}, 2);
  std::vector<Blueprint> blueprints{four,
                                    four,
                                    row({}, 3),
                                    row({{0, 1}, {1, 1}, {2, 1}}, 2),
                                    row({{0, 0}, {1, 0}, {10, 0}, {10.5, 0}}, 1),
                                    row({{0, 0}, {1, 0}, {5, 0}}, 0)};
  blueprints[0].sizes = {{1, 1.25}, {0.75, 1}, {1.25, 0.75}, {1.5, 1}};
  blueprints.back().body.springs = {{1, 2, 4, 0}};  // from the encoding
  for (const int threads : {1, 3}) {
    Workers workers(threads);
    const std::vector<BuiltBody> together = build_bodies(blueprints, *make_cpu_neighbour_search(), workers);
    ASSERT_EQ(together.size(), blueprints.size());
    for (std::size_t i = 0; i < blueprints.size(); ++i) {
      const BuiltBody alone = build_body(blueprints[i]);
      SCOPED_TRACE(i);
      EXPECT_EQ(together[i].failure, alone.failure);
      testing::expect_same_body(together[i].body, alone.body);
    }
  }
}

/// Random numbers of all magnitudes, with all their digits.
class Awkward {
 public:
  double any() {
    const double size = std::pow(10, 40 * (rng_.uniform() - 0.5));
    return (rng_.uniform() - 0.5) * size / 3;
  }
  double positive() { return std::abs(any()) + std::numeric_limits<double>::min(); }
  Vec3 position() {
    const double x = any(), y = any(), z = any();
    return {x, y, z};
  }

 private:
  Rng rng_{philox, {1, 2, 3, 4}};
};

GivenBody awkward_body(bool lives) {
  Awkward number;
  GivenBody given;
  for (int i = 0; i < 3; ++i)
    given.body.materials.push_back({number.positive(), std::min(number.positive(), largest_amplitude),
                                    number.positive(), number.any(), i == 0 ? 0.25 : number.positive()});
  for (int i = 0; i < 50; ++i) given.body.masses.push_back({number.position(), number.positive(), i % 4 - 1});
  for (std::uint32_t i = 1; i < 50; ++i) given.body.springs.push_back({i - 1, i, number.positive(), i % 3});
  for (std::size_t i = 0; i < 40; ++i) given.body.springs[i].stiffness_factor = number.positive();
  given.body.masses[0].rest = {-0.0, 5e-324, std::numeric_limits<double>::max()};
  if (!lives) return given;
  State& state = given.state.emplace();
  for (const Mass& mass : given.body.masses) {
    state.position.push_back(mass.rest);
    state.velocity.push_back(number.position());
  }
  state.time = number.positive();
  state.start_energy = number.any();
  return given;
}

/// Reads a body from a file with this text.
GivenBody body_from(const std::string& text) {
  const testing::Scratch scratch;
  return read_body(scratch.write("body.json", text));
}

TEST(BodyJson, ComesBackBitForBit) {
  for (const bool lives : {false, true}) {
    SCOPED_TRACE(lives ? "a life under way" : "a newborn");
    const GivenBody given = awkward_body(lives);
    const GivenBody back = body_from(body_to_json(given, {"air", "bone"}));
    testing::expect_same_body(given.body, back.body);
    EXPECT_TRUE(lives || std::signbit(back.body.masses[0].rest.x));
    ASSERT_EQ(back.state.has_value(), lives);
    if (!lives) continue;
    EXPECT_EQ(given.state->position, back.state->position);
    EXPECT_EQ(given.state->velocity, back.state->velocity);
    EXPECT_EQ(std::pair(given.state->time, given.state->start_energy),
              std::pair(back.state->time, back.state->start_energy));
  }
}

TEST(BodyJson, APlaceIsWhereTheMassIsNow) {
  GivenBody given = awkward_body(true);
  given.state->position[7] = {1, 2, 3};
  const auto json = nlohmann::json::parse(body_to_json(given, {}));
  EXPECT_EQ(json.at("masses").at(7).at("position"), nlohmann::json({1.0, 2.0, 3.0}));
}

TEST(BodyJson, WhatIsNoNumberIsRefusedWhereOneIsExpected) {
  const auto json = nlohmann::json::parse(body_to_json(awkward_body(false), {"air", "bone"}));
  for (const nlohmann::json& value :
       std::vector<nlohmann::json>{true, "1", nullptr, nlohmann::json::array({1}), nlohmann::json::object()}) {
    auto changed = json;
    changed.at("masses").at(3).at("mass") = value;
    EXPECT_THAT([&] { body_from(changed.dump()); },
                ::testing::ThrowsMessage<ConfigError>(testing::naming("masses[3].mass", "number", value.dump())));
  }
}

TEST(BodyJson, AMessageQuotesUpTo60Bytes) {
  const auto complaint = [](std::size_t letters) {
    return testing::refusal<ConfigError>([&] { body_from('"' + std::string(letters, 'x') + '"'); });
  };
  EXPECT_THAT(complaint(58), ::testing::AllOf(::testing::HasSubstr('"' + std::string(58, 'x') + '"'),
                                              ::testing::Not(::testing::HasSubstr("..."))));
  EXPECT_THAT(complaint(59), ::testing::HasSubstr('"' + std::string(59, 'x') + "..."));
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
