// Properties of every devo operator, alone and in any order with others.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "life.hpp"

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

/// A life of 60 masses and 400 springs with random stress. Springs that can grow or turn do so at random; each of the
/// uses remembers what it does.
Life busy_life() {
  Life life = life_of_masses(60);
  for (auto& mass : life.living.body.masses)
    if (mass.material == air) mass.material = tissue;
  Rng rng = stream(7);
  std::set<Pair> pairs;
  std::vector<double> growth, turns;
  while (pairs.size() < 400) {
    const std::uint32_t a = rng.below(60), b = rng.below(60);
    if (a == b || !pairs.insert(ordered(a, b)).second) continue;
    life.add_spring(a, b, static_cast<std::uint32_t>(bone + pairs.size() % 4), rng.uniform(0, 100));
    growth.push_back(rng.uniform(-0.2, 0.2));
    turns.push_back(rng.uniform(-1, 1));
    life.living.tension.push_back(rng.uniform(-50, 100));
    life.living.muscle_work.push_back(rng.uniform(0, 10));
  }
  for (life.op = 0; life.op < uses.size(); ++life.op) {
    const auto devo = make<Devo>(uses[life.op].first, uses[life.op].second);
    const std::vector<std::string> needed = devo->traits().needs_at_birth;
    if (needed == std::vector<std::string>{"growth"}) life.spring_memory() = growth;
    if (needed == std::vector<std::string>{"turn"}) life.spring_memory() = turns;
    life.remember_as_many(memory_names(*devo));
  }
  life.application = 1;  // at which every operator changes something
  life.applications = 5;
  return life;
}

TEST(AnyDevo, LeavesBodiesWithoutSpringsAsTheyAre) {
  for (const auto& [name, toml] : uses) {
    SCOPED_TRACE(name);
    const auto devo = make<Devo>(name, toml);
    std::vector<Life> lives = {Life{}, life_of_masses(1), life_of_masses(5, false)};
    if (name != std::string("regulated-growth")) lives.push_back(life_of_masses(5));  // which reaches for others
    for (const Life& life : lives)
      EXPECT_TRUE(develop(*devo, life, 1).empty()) << life.living.body.masses.size() << " masses";
  }
}

TEST(AnyDevo, WorksWithOthersInAnyOrder) {
  std::set<std::string> names;
  for (const auto& [name, toml] : uses) names.insert(name);
  EXPECT_THAT(registry().names("devo"), ::testing::ElementsAreArray(names)) << "each has a use here";
  std::vector<std::size_t> order(uses.size());  // among the uses
  std::iota(order.begin(), order.end(), 0u);
  Rng rng = stream(3);
  for (std::uint64_t trial = 0; trial < 20; ++trial) {
    rng.shuffle(order);
    Life life = busy_life();
    std::uint64_t seed = 1000 * trial;
    for (life.application = 1; life.application <= life.applications; ++life.application)
      for (const std::size_t use : order) {
        const auto& [name, toml] = uses[use];
        life.op = use;
        const Edits edits = develop(*make<Devo>(name, toml), life, seed++);
        ASSERT_NO_THROW(life.living = after(life, edits)) << name;
      }
    const Body& body = life.living.body;
    EXPECT_EQ(body.springs.size(), joined(body).size()) << "two springs join one pair";
    EXPECT_EQ(life.living.stress.size(), body.springs.size());
    for (const OperatorMemory& memory : life.living.memory) {
      EXPECT_EQ(memory.masses.values.size(), memory.masses.width * body.masses.size());
      EXPECT_EQ(memory.springs.values.size(), memory.springs.width * body.springs.size());
    }
    EXPECT_EQ(life.living.state.position.size(), body.masses.size());
    EXPECT_GE(body.masses.size(), 60u);
    for (const Spring& spring : body.springs) {
      EXPECT_TRUE(std::isfinite(spring.rest_length) && spring.rest_length > 0);
      EXPECT_GT(body.materials.at(spring.material).stiffness, 0);
    }
  }
}

std::vector<double> lengths(const Body& body) {
  std::vector<double> all;
  for (const Spring& spring : body.springs) all.push_back(spring.rest_length);
  return all;
}

TEST(AnyDevo, OperatorsThatChangeDifferentThingsDoNotDependOnTheirOrder) {
  std::vector<std::size_t> order;  // among the uses
  for (std::size_t i = 0; i < uses.size(); ++i)
    for (const char* name : {"length-adaptation", "stiffness-adaptation", "amplitude-adaptation", "ballistic-growth"})
      if (uses[i].first == std::string(name)) order.push_back(i);
  ASSERT_EQ(order.size(), 4u);
  std::vector<double> first;
  do {
    Life life = busy_life();
    const std::vector<double> first_lengths = lengths(life.living.body);
    for (const std::size_t use : order) {
      life.op = use;
      life.living = after(life, develop(*make<Devo>(uses[use].first, uses[use].second), life, use));
    }
    EXPECT_NE(lengths(life.living.body), first_lengths) << "they grow";
    std::vector<double> springs;
    for (const Spring& spring : life.living.body.springs) {
      const Material& material = life.living.body.materials[spring.material];
      springs.insert(springs.end(), {spring.rest_length, life.living.body.stiffness(spring), material.amplitude});
    }
    if (first.empty()) first = springs;
    ASSERT_EQ(springs.size(), first.size());
    for (std::size_t i = 0; i < first.size(); ++i) EXPECT_NEAR(springs[i], first[i], 1e-9 * first[i]);
  } while (std::next_permutation(order.begin(), order.end()));
  EXPECT_FALSE(first.empty());
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
