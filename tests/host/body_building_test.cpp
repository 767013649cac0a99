// Bodies: building them from blueprints, and reading them from JSON files, which restores every bit.
#include "life/body_building.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
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

/// Returns what check_blueprint() says of a blueprint for an encoding whose context has the materials of row(), and
/// which declares these names of what springs remember.
std::string fault_of(const Blueprint& blueprint, const std::vector<std::string>& names = {}) {
  const EncodingContext context{.materials = row({}, 0).body.materials};
  return testing::refusal<std::invalid_argument>([&] { check_blueprint(blueprint, context, names); });
}

/// An encoding that completes blueprints as a test says. Springs may remember their growth and their turns.
struct Completing final : Encoding {
  std::function<void(Blueprint&)> then;

  explicit Completing(std::function<void(Blueprint&)> what) : then(std::move(what)) {}
  Layout layout(const EncodingContext&) const override { return {}; }
  Blueprint decode(const Genome&, const Layout&, const EncodingContext&) const override { return {}; }
  void joined(Blueprint& blueprint) const override { then(blueprint); }
  std::vector<std::string> spring_memory() const override { return {"growth", "turn"}; }
};

/// The body of a blueprint, which an encoding completes as a test says.
BuiltBody completed(Blueprint blueprint, const std::function<void(Blueprint&)>& then) {
  const Completing encoding(then);
  const EncodingContext context{.materials = row({}, 0).body.materials};
  return build_body(std::move(blueprint), [&](std::size_t, Blueprint& joined) { complete(encoding, context, joined); });
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

TEST(BodyBuilding, TheEncodingCompletesWhatIsJoinedAndMemoryFollowsTheSpringsThatStay) {
  // two pieces, of five and of three masses, in each of which masses of air are neighbours
  Blueprint blueprint = row({{0, 0}, {1, 1}, {60, 0}, {2, 1}, {3, 1}, {61, 1}, {99, 1}, {4, 0}}, 2);
  blueprint.body.springs = {{2, 5, 0.3, 0}, {7, 0, 0.7, 0}, {6, 5, 0.4, 1}};  // of the encoding itself
  /// An awkward number that tells a spring apart by its masses in the blueprint.
  const auto sign = [](std::uint32_t a, std::uint32_t b) {
    return (100.0 * std::min(a, b) + std::max(a, b)) / 7 + 0.1;
  };
  for (const Spring& spring : blueprint.body.springs) {
    blueprint.spring_memory["growth"].push_back(-sign(spring.a, spring.b));
    blueprint.spring_memory["turn"].push_back(1 / sign(spring.a, spring.b));
  }
  EXPECT_EQ(fault_of(blueprint, {"turn", "growth"}), "no refusal");
  std::size_t all = 0;
  const BuiltBody built = completed(blueprint, [&](Blueprint& joined) {
    std::vector<Spring>& springs = joined.body.springs;
    all = springs.size();
    for (std::size_t s = 3; s < all; ++s) {
      const Vec3 way = joined.body.masses[springs[s].a].rest - joined.body.masses[springs[s].b].rest;
      EXPECT_EQ(springs[s].rest_length, norm(way)) << "at first, the distance";
      springs[s].rest_length = sign(springs[s].a, springs[s].b);
      EXPECT_EQ(joined.spring_memory["growth"].at(s), 0) << "at first, too";
      joined.spring_memory["growth"][s] = -sign(springs[s].a, springs[s].b);
      joined.spring_memory["turn"].at(s) = 1 / sign(springs[s].a, springs[s].b);
    }
  });
  ASSERT_EQ(built.failure, "");
  EXPECT_THAT(built.kept, ElementsAre(0, 1, 3, 4, 7));
  const std::vector<Spring>& springs = built.body.springs;
  ASSERT_GT(springs.size(), 4u);
  EXPECT_GT(all, springs.size() + 4) << "several are of air, and several belong to the other piece";
  ASSERT_EQ(built.spring_memory.at("growth").size(), springs.size());
  ASSERT_EQ(built.spring_memory.at("turn").size(), springs.size());
  for (std::size_t s = 0; s < springs.size(); ++s) {
    const double own = sign(built.kept[springs[s].a], built.kept[springs[s].b]);
    EXPECT_EQ(built.spring_memory.at("growth")[s], -own) << s;
    EXPECT_EQ(built.spring_memory.at("turn")[s], 1 / own) << s;
    EXPECT_EQ(springs[s].rest_length, s == 0 ? 0.7 : own) << s;
    EXPECT_EQ(springs[s].first_length, springs[s].rest_length) << s;
  }

  EXPECT_THAT(completed(blueprint, [](Blueprint& joined) { joined.failure = "too long"; }).failure,
              testing::at_place("no body: ", "too long"));
  blueprint.neighbours = 0;
  completed(blueprint, [](Blueprint&) { ADD_FAILURE() << "nothing has been joined"; });
}

TEST(BodyBuilding, FaultsOfWhatTheEncodingCompletesAreNamed) {
  const Blueprint three = row({{0, 0}, {1, 0}, {3, 0}}, 1);  // two springs
  const auto fault = [&](const std::function<void(Blueprint&)>& then) {
    return testing::refusal<std::invalid_argument>([&] { completed(three, then); });
  };
  const auto remembering = [&](const std::string& name, const std::vector<double>& numbers) {
    Blueprint own = three;  // the same, from decode()
    own.neighbours = 0;
    own.body.springs = {{0, 1, 1, 0}, {1, 2, 2, 0}};
    own.spring_memory[name] = numbers;
    const std::string of_decode = fault_of(own, {"growth", "turn"});
    EXPECT_EQ(fault([&](Blueprint& joined) { joined.spring_memory[name] = numbers; }), of_decode);
    return of_decode;
  };
  EXPECT_EQ(remembering("turn", {0.5, -3}), "no refusal");
  EXPECT_THAT(remembering("turn", {0.5}), testing::naming("spring_memory[\"turn\"]", "1 numbers", "2 springs"));
  EXPECT_THAT(remembering("growth", {1, 2, 3}), testing::naming("spring_memory[\"growth\"]", "3 numbers", "2 springs"));
  EXPECT_THAT(remembering("growth", {0, nan}),
              testing::naming("spring_memory[\"growth\"]", "spring 1", "not a number", "finite"));
  EXPECT_THAT(remembering("growth", {-infinity, 0}),
              testing::naming("spring_memory[\"growth\"]", "spring 0", "-infinity", "finite"));
  EXPECT_THAT(remembering("colour", {1, 2}),
              testing::naming("spring_memory[\"colour\"]", "not declared", "Encoding::spring_memory()"));

  EXPECT_EQ(fault([](Blueprint&) {}), "no refusal");
  EXPECT_THAT(fault([](Blueprint& joined) {
                joined.body.springs.push_back({0, 2, 1, 0});
              }),
              testing::naming("joined()", "3 springs", "3 and 2"));
  EXPECT_THAT(fault([](Blueprint& joined) { joined.body.springs.pop_back(); }),
              testing::naming("joined()", "1 springs", "3 and 2"));
  EXPECT_THAT(fault([](Blueprint& joined) { joined.body.masses.push_back(joined.body.masses[0]); }),
              testing::naming("joined()", "4 masses", "3 and 2"));
  for (const double length : {-0.1, nan, infinity})
    EXPECT_THAT(fault([&](Blueprint& joined) { joined.body.springs[1].rest_length = length; }),
                testing::at_place("spring 1 ", "rest length"));
  EXPECT_THAT(fault([](Blueprint& joined) { joined.body.springs[1].material = 99; }),
              testing::at_place("spring 1 ", "material 99"));
  EXPECT_THAT(fault([](Blueprint& joined) { joined.body.masses[2].mass = nan; }), testing::at_place("mass 2 ", "kg"));
  EXPECT_THAT(fault([](Blueprint& joined) { joined.body.springs[1] = joined.body.springs[0]; }),
              testing::at_place("spring 1 ", "masses 0 and 1", "joined already"));
  EXPECT_THAT(fault([](Blueprint& joined) {
                joined.mass_memory["stem"] = {1, 2};
              }),
              testing::naming("mass_memory[\"stem\"]", "2 numbers", "3 masses"));
  EXPECT_THAT(completed(three, [](Blueprint& joined) { joined.body.masses[1].rest.x = nan; }).failure,
              testing::at_place("no body: ", "position", "not finite"));
  Blueprint uncompleted = row({{0, 0}, {1, 0}, {3, 0}, {9, 0}}, 1);
  uncompleted.body.springs = {{0, 1, 1, 0}};
  uncompleted.spring_memory["turn"] = {5};
  EXPECT_EQ(build_body(uncompleted).spring_memory.at("turn"), (std::vector<double>{5, 0, 0}));
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
  for (const float value : {0.0f, -0.1f, HUGE_VALF, NAN})
    expect(&Body::springs, &Spring::stiffness_factor, value, "spring 1 ", "stiffness_factor");
}

TEST(BodyBuilding, ListsHoldAnEntryForEachMass) {
  const auto fault = [](auto Blueprint::*list, std::size_t entries) {
    Blueprint blueprint = row({{0, 0}, {1, 0}, {3, 0}}, 1);
    (blueprint.*list).resize(entries);
    return fault_of(blueprint);
  };
  EXPECT_THAT(fault(&Blueprint::paired_at, 4), testing::naming("4 ", "pair", "3 masses"));
  EXPECT_THAT(fault(&Blueprint::origins, 1), testing::naming("1 ", "origin", "3 masses"));
  for (const std::size_t entries : {0u, 3u}) EXPECT_EQ(fault(&Blueprint::origins, entries), "no refusal");
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
  blueprints.back().body.springs = {{1, 2, 4, 0}};  // from the encoding
  const auto after_joining = [](std::size_t number, Blueprint& joined) {
    EXPECT_GT(joined.neighbours, 0u) << "there are others to complete";
    for (Spring& spring : joined.body.springs) {
      spring.rest_length *= 1 + 0.25 * static_cast<double>(number);
      joined.spring_memory["growth"].push_back(spring.rest_length + static_cast<double>(number));
    }
  };
  for (const int threads : {1, 3}) {
    Workers workers(threads);
    const std::vector<BuiltBody> together =
        build_bodies(blueprints, *make_cpu_neighbour_search(), workers, after_joining);
    ASSERT_EQ(together.size(), blueprints.size());
    for (std::size_t i = 0; i < blueprints.size(); ++i) {
      const BuiltBody alone =
          build_body(blueprints[i], [&](std::size_t, Blueprint& joined) { after_joining(i, joined); });
      SCOPED_TRACE(i);
      EXPECT_EQ(together[i].spring_memory, alone.spring_memory);
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
