// Bodies in JSON files: reading restores every bit.
#include "life/body_json.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "base/input_error.hpp"
#include "base/philox.hpp"
#include "support/messages.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

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
    given.body.materials.push_back({number.positive(), number.positive(), number.positive(), number.any()});
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

GivenBody read_again(const GivenBody& given) {
  const testing::Scratch scratch;
  return read_body(scratch.write("body.json", body_to_json(given, {"air", "bone"})));
}

void expect_same(const Body& a, const Body& b) {
  EXPECT_EQ(a.materials, b.materials);
  ASSERT_EQ(a.masses.size(), b.masses.size());
  for (std::size_t i = 0; i < a.masses.size(); ++i) {
    EXPECT_EQ(a.masses[i].rest, b.masses[i].rest);
    EXPECT_EQ(a.masses[i].mass, b.masses[i].mass);
    EXPECT_EQ(a.masses[i].material, b.masses[i].material);
  }
  ASSERT_EQ(a.springs.size(), b.springs.size());
  for (std::size_t i = 0; i < a.springs.size(); ++i) {
    EXPECT_EQ(a.springs[i].a, b.springs[i].a);
    EXPECT_EQ(a.springs[i].b, b.springs[i].b);
    EXPECT_EQ(a.springs[i].rest_length, b.springs[i].rest_length);
    EXPECT_EQ(a.springs[i].material, b.springs[i].material);
    EXPECT_EQ(a.springs[i].stiffness_factor, b.springs[i].stiffness_factor);
  }
}

TEST(BodyJson, ANewbornComesBackBitForBit) {
  const GivenBody given = awkward_body(false), back = read_again(given);
  expect_same(given.body, back.body);
  EXPECT_FALSE(back.state.has_value());
  EXPECT_TRUE(std::signbit(back.body.masses[0].rest.x));
}

TEST(BodyJson, ALifeUnderWayComesBackBitForBit) {
  const GivenBody given = awkward_body(true), back = read_again(given);
  expect_same(given.body, back.body);
  ASSERT_TRUE(back.state.has_value());
  EXPECT_EQ(given.state->position, back.state->position);
  EXPECT_EQ(given.state->velocity, back.state->velocity);
  EXPECT_EQ(given.state->time, back.state->time);
  EXPECT_EQ(given.state->start_energy, back.state->start_energy);
}

TEST(BodyJson, APlaceIsWhereTheMassIsNow) {
  GivenBody given = awkward_body(true);
  given.state->position[7] = {1, 2, 3};
  const auto json = nlohmann::json::parse(body_to_json(given, {}));
  EXPECT_EQ(json.at("masses").at(7).at("position"), nlohmann::json({1.0, 2.0, 3.0}));
}

TEST(BodyJson, WhatIsNoNumberIsRefusedWhereOneIsExpected) {
  const testing::Scratch scratch;
  const auto json = nlohmann::json::parse(body_to_json(awkward_body(false), {"air", "bone"}));
  for (const nlohmann::json& value :
       std::vector<nlohmann::json>{true, "1", nullptr, nlohmann::json::array({1}), nlohmann::json::object()}) {
    auto changed = json;
    changed.at("masses").at(3).at("mass") = value;
    EXPECT_THAT([&] { read_body(scratch.write("body.json", changed.dump())); },
                ::testing::ThrowsMessage<ConfigError>(testing::naming("masses[3].mass", "number", value.dump())));
  }
}

TEST(BodyJson, AMessageQuotesUpTo60Bytes) {
  const testing::Scratch scratch;
  const auto complaint = [&](std::size_t letters) {
    try {
      read_body(scratch.write("body.json", '"' + std::string(letters, 'x') + '"'));
    } catch (const ConfigError& error) {
      return std::string(error.what());
    }
    return std::string("none");
  };
  EXPECT_THAT(complaint(58), ::testing::AllOf(::testing::HasSubstr('"' + std::string(58, 'x') + '"'),
                                              ::testing::Not(::testing::HasSubstr("..."))));
  EXPECT_THAT(complaint(59), ::testing::HasSubstr('"' + std::string(59, 'x') + "..."));
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
