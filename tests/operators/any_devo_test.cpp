// Properties of every devo operator, alone and in any order with others.
#include <algorithm>
#include <cmath>

#include "life.hpp"
#include "life/body_building.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

/// Operators with parameters; each operator occurs at least once.
const std::vector<std::pair<const char*, const char*>> uses = {
    {"spring-turnover", "springs = 40\nwhere = 'by-stress'"},
    {"spring-turnover", "springs = 40\nwhere = 'most-stressed'"},
    {"mass-turnover", "threshold = 16\nsprings = 12\nwhere = 'by-stress'\njoin = 'nearest'"},
    {"mass-growth", "springs = 12\njoin = 'nearest'"},
    {"length-adaptation", "springs = 60"},
    {"stiffness-adaptation", "springs = 60"},
    {"amplitude-adaptation", "springs = 60"},
    {"ballistic-growth", ""},
    {"regulated-growth", "min_distance = 0.0\nsprings = 4"},
    {"hebbian", ""},
    {"ballistic-phase", ""},
};

/// A life of 60 masses and 400 springs with random stress and growth.
Life busy_life() {
  Life life = life_of_masses(60);
  for (auto& mass : life.living.body.masses)
    if (mass.material == air) mass.material = tissue;
  Rng rng = stream(7);
  std::set<Pair> pairs;
  while (pairs.size() < 400) {
    const std::uint32_t a = rng.below(60), b = rng.below(60);
    if (a == b || !pairs.insert(ordered(a, b)).second) continue;
    life.add_spring(a, b, static_cast<std::uint32_t>(bone + pairs.size() % 4), rng.uniform(0, 100));
    life.living.body.springs.back().growth = static_cast<float>(rng.uniform(0.8, 1.2));
    life.living.body.springs.back().phase_growth = static_cast<float>(rng.uniform(-1, 1));
    life.living.tension.push_back(rng.uniform(-50, 100));
    life.living.muscle_work.push_back(rng.uniform(0, 10));
  }
  life.application = 1;  // at which every operator changes something
  life.applications = 5;
  return life;
}

TEST(AnyDevo, EveryOperatorIsUsedHere) {
  std::set<std::string> used;
  for (const auto& [name, toml] : uses) used.insert(name);
  const auto names = registry().names("devo");
  EXPECT_EQ(std::vector<std::string>(used.begin(), used.end()), std::vector<std::string>(names.begin(), names.end()));
}

TEST(AnyDevo, DependsOnItsKeyAlone) {
  for (const auto& [name, toml] : uses) {
    SCOPED_TRACE(name);
    const auto devo = make<Devo>(name, toml);
    const Life life = busy_life();
    const auto edits = from_eight_threads([&] { return digest(develop(*devo, life, 1)); });
    EXPECT_FALSE(edits.empty());
  }
}

/// Expects that the host accepts all edits of operators in the given order, and that the result is a valid body.
void expect_a_life(const std::vector<std::size_t>& order, std::uint64_t seed) {
  Life life = busy_life();
  for (life.application = 1; life.application <= life.applications; ++life.application)
    for (const std::size_t use : order) {
      const Edits edits = develop(*make<Devo>(uses[use].first, uses[use].second), life, seed++);
      ASSERT_NO_THROW(life.living = after(life, edits)) << uses[use].first;
    }
  const Body& body = life.living.body;
  EXPECT_EQ(body.springs.size(), joined(body).size()) << "two springs join one pair";
  EXPECT_EQ(life.living.stress.size(), body.springs.size());
  EXPECT_EQ(life.living.state.position.size(), body.masses.size());
  EXPECT_GE(body.masses.size(), 60u);
  for (const Spring& spring : body.springs) {
    EXPECT_TRUE(std::isfinite(spring.rest_length) && spring.rest_length > 0);
    EXPECT_GT(body.materials.at(spring.material).stiffness, 0);
  }
}

TEST(AnyDevo, WorksWithOthersInAnyOrder) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < uses.size(); ++i) order.push_back(i);
  Rng rng = stream(3);
  for (std::uint64_t trial = 0; trial < 20; ++trial) {
    rng.shuffle(order);
    expect_a_life(order, 1000 * trial);
  }
}

TEST(AnyDevo, OperatorsThatChangeDifferentThingsDoNotDependOnTheirOrder) {
  const auto lives = [](std::vector<std::size_t> order) {
    Life life = busy_life();
    for (const std::size_t use : order)
      life.living = after(life, develop(*make<Devo>(uses[use].first, uses[use].second), life, use));
    std::vector<double> springs;
    for (const Spring& spring : life.living.body.springs) {
      const Material& material = life.living.body.materials[spring.material];
      springs.insert(springs.end(), {spring.rest_length, life.living.body.stiffness(spring), material.amplitude});
    }
    return springs;
  };
  std::vector<std::size_t> order = {4, 5, 6, 7};
  const auto first = lives(order);
  while (std::next_permutation(order.begin(), order.end())) {
    const auto other = lives(order);
    ASSERT_EQ(other.size(), first.size());
    for (std::size_t i = 0; i < first.size(); ++i) EXPECT_NEAR(other[i], first[i], 1e-9 * first[i]);
  }
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
