#include <cmath>
#include <map>
#include <numeric>

#include "regulation.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::Pointwise;

/// Returns what masses feel, by the definitions. The largest number of springs of a mass is 20.
std::map<std::string, std::vector<double>> feelings_of(Life life, const Devo& devo) {
  life.complete_for(devo);
  const std::size_t masses = life.living.body.masses.size();
  const double loads = std::accumulate(life.load.begin(), life.load.end(), 0.0);
  std::map<std::string, std::vector<double>> felt;
  for (std::size_t i = 0; i < masses; ++i) {
    double signals = 0, springs = 0;
    for (const Spring& spring : life.living.body.springs) {
      if (spring.a != i && spring.b != i) continue;
      signals += life.mass_memory()[2 * (spring.a == i ? spring.b : spring.a)];
      ++springs;
    }
    felt["bias"].push_back(1);
    felt["load"].push_back(life.load[i] / (loads / static_cast<double>(masses)));
    felt["contact"].push_back(life.contact[i]);
    felt["age"].push_back(life.age[i] / 100);
    felt["degree"].push_back(springs / 20);
    felt["neighbours"].push_back(signals / springs);
    felt["signal"].push_back(life.mass_memory()[2 * i]);
    felt["memory 1"].push_back(life.mass_memory()[2 * i + 1]);
  }
  return felt;
}

TEST_BOTH_DRAWS(RegulatedGrowth, EveryFeelingReachesEveryOutput) {
  const auto devo = make<Devo>("regulated-growth", one_act);
  Life life = varied_life();
  const auto& springs = life.living.body.springs;
  for (const auto& [feeling, values] : feelings_of(life, *devo)) {
    SCOPED_TRACE(feeling);
    const auto most = static_cast<std::uint32_t>(std::max_element(values.begin(), values.end()) - values.begin());
    const double output = std::tanh(0.5 * values[most]);
    const auto at_most = [&](const auto& spring) { return spring.a == most || spring.b == most; };
    const auto edits_of = [&](const std::string& to) {
      life.own = genes(*devo, {{to, feeling, 0.5f}});
      return develop(*devo, life, 1);
    };
    const auto near_output = ElementsAre(DoubleNear(output, 1e-12));

    const Edits division = edits_of("divide");
    EXPECT_THAT(causes(division.new_masses), near_output);
    const auto partners = static_cast<std::size_t>(std::ranges::count_if(springs, at_most));
    ASSERT_EQ(division.new_springs.size(), 1 + std::min<std::size_t>(5, partners));
    EXPECT_EQ(ordered(division.new_springs[0].a, division.new_springs[0].b), Pair(most, 12)) << "joined to the mother";
    EXPECT_TRUE(division.removed_springs.empty() && division.changed_springs.empty());

    const Edits release = edits_of("let go");
    EXPECT_THAT(causes(release.removed_springs), near_output);
    ASSERT_EQ(release.removed_springs.size(), 1u);
    EXPECT_TRUE(at_most(springs[release.removed_springs[0].index]));
    for (std::size_t s = 0; s < springs.size(); ++s)
      EXPECT_TRUE(!at_most(springs[s]) ||
                  life.living.stress[s] >= life.living.stress[release.removed_springs[0].index]);

    const Edits reaching = edits_of("reach");
    EXPECT_THAT(causes(reaching.new_springs), near_output);
    ASSERT_EQ(reaching.new_springs.size(), 1u);
    EXPECT_TRUE(at_most(reaching.new_springs[0]));
    EXPECT_FALSE(joined(life.living.body).contains(ordered(reaching.new_springs[0].a, reaching.new_springs[0].b)));

    const Edits stiffer = edits_of("stiffen");  // or softer: the largest magnitude counts
    const auto by_magnitude = [](double a, double b) { return std::abs(a) < std::abs(b); };
    const auto strongest = std::max_element(values.begin(), values.end(), by_magnitude);
    const auto mass = static_cast<std::uint32_t>(strongest - values.begin());
    ASSERT_FALSE(stiffer.changed_springs.empty());
    for (const ChangedSpring& change : stiffer.changed_springs)
      EXPECT_TRUE(springs[change.spring].a == mass || springs[change.spring].b == mass);
    for (const ChangedSpring& change : stiffer.changed_springs)
      EXPECT_NEAR(change.cause, std::tanh(0.5 * *strongest), 1e-12);
    EXPECT_TRUE(stiffer.removed_springs.empty() && stiffer.new_springs.empty());

    for (const std::size_t memory : {0, 1}) {
      const Edits edits = edits_of(memory == 0 ? "signal" : "memory 1");
      EXPECT_TRUE(edits.empty());
      const std::vector<double> known = remembered(edits.mass_memory);
      ASSERT_EQ(known.size(), 24u);
      for (std::size_t i = 0; i < 12; ++i) {
        EXPECT_NEAR(known[2 * i + memory], std::tanh(0.5 * values[i]), 1e-12);
        EXPECT_EQ(known[2 * i + 1 - memory], 0);
      }
    }
  }
}

TEST_BOTH_DRAWS(RegulatedGrowth, MassesRememberAsManyNumbersAsAskedFor) {
  const auto devo = make<Devo>("regulated-growth", "memory = 3");
  EXPECT_THAT(devo->mass_memory(), ElementsAre("signal", "memory 1", "memory 2"));
  EXPECT_EQ(devo->layout(context()).first_size(), 7u * 9);
}

TEST_BOTH_DRAWS(RegulatedGrowth, DaughtersTakeTheMothersMemory) {
  const auto devo = make<Devo>("regulated-growth", "actions = 3\nmin_distance = 0.0");
  Life life = varied_life();
  life.own = genes(*devo, {{"divide", "load", 1}, {"signal", "contact", 1}, {"memory 1", "signal", 2}});
  const Edits edits = develop(*devo, life, 1);
  ASSERT_EQ(edits.new_masses.size(), 3u);
  const std::vector<double> known = remembered(edits.mass_memory);
  ASSERT_EQ(known.size(), 2u * 15);
  std::size_t daughters = 0;
  for (const NewSpring& spring : edits.new_springs) {
    if (spring.b != 12 + daughters) continue;
    const std::size_t mother = spring.a, daughter = 12 + daughters;  // the first spring joins her to her mother
    EXPECT_EQ(edits.new_masses[daughters++].mother, mother);
    for (const std::size_t m : {0, 1}) {
      EXPECT_EQ(known[2 * daughter + m], known[2 * mother + m]);
      EXPECT_NE(known[2 * daughter + m], 0);
    }
  }
  EXPECT_EQ(daughters, 3u);
}

TEST_BOTH_DRAWS(RegulatedGrowth, SignalsSpreadFromMassToMass) {
  const auto devo = make<Devo>("regulated-growth");
  Life life = life_of_masses(4, false);
  for (std::uint32_t i = 0; i < 3; ++i) life.add_spring(i, i + 1, bone, 1);
  life.own = genes(*devo, {{"signal", "neighbours", 2}});
  life.mass_memory() = {0.5, 9, 0, 9, 0, 9, 0, 9};  // the second number has no effect
  const auto step = [&] {
    const std::vector<double>& known = life.mass_memory() = remembered(develop(*devo, life, 1).mass_memory);
    return std::vector{known[0], known[2], known[4], known[6]};
  };
  // twice the mean of the masses on both sides; the ends have one only
  const double first = std::tanh(0.5), second = std::tanh(2 * first), third = std::tanh(first);
  const auto near = [](std::vector<double> values) { return Pointwise(DoubleNear(1e-12), std::move(values)); };
  EXPECT_THAT(step(), near({0, first, 0, 0}));
  EXPECT_THAT(step(), near({second, 0, third, 0}));
  EXPECT_THAT(step(), near({0, std::tanh(second + third), 0, std::tanh(2 * third)}));
}

/// Returns a life in which mass i is the former mass order[i].
Life permuted(Life life, const std::vector<std::uint32_t>& order) {
  Life before = life;
  std::vector<std::uint32_t> place(order.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    place[order[i]] = i;
    life.living.body.masses[i] = before.living.body.masses[order[i]];
    life.living.state.position[i] = before.living.state.position[order[i]];
    life.contact[i] = before.contact[order[i]];
    life.age[i] = before.age[order[i]];
    for (const std::size_t m : {0, 1}) life.mass_memory()[2 * i + m] = before.mass_memory()[2 * order[i] + m];
  }
  life.living.numbers = MassNumbers(std::vector<std::uint64_t>(order.begin(), order.end()));
  for (Spring& spring : life.living.body.springs) {
    spring.a = place[spring.a];
    spring.b = place[spring.b];
  }
  return life;
}

TEST_BOTH_DRAWS(RegulatedGrowth, PermutedMassesGiveThePermutedEdits) {
  const auto devo = make<Devo>("regulated-growth", "actions = 4\nmin_distance = 0.0\nleast_springs = 1\nlow = 1.0");
  std::vector<std::uint32_t> order(12);
  std::iota(order.begin(), order.end(), 0u);
  Rng rng = stream(8);
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    Life life = varied_life();
    life.own = devo->random(devo->layout(context()), rng);
    for (float& gene : life.own) gene *= 0.3f;  // so that no outputs are tied at 1
    rng.shuffle(order);
    const Edits one = develop(*devo, life, seed);
    Edits other = develop(*devo, permuted(life, order), seed);
    for (NewSpring& spring : other.new_springs)
      for (std::uint32_t* end : {&spring.a, &spring.b})
        if (*end < 12) *end = order[*end];
    for (NewMass& mass : other.new_masses) mass.mother = order[mass.mother.value()];
    const std::vector<double> known = remembered(other.mass_memory);
    std::vector<double> memory = known;
    for (std::size_t i = 0; i < 12; ++i)
      for (const std::size_t m : {0, 1}) memory[2 * order[i] + m] = known[2 * i + m];
    other.mass_memory = {};
    for (std::uint32_t i = 0; i < memory.size() / 2; ++i)
      other.mass_memory.set(i, std::span(memory).subspan(std::size_t{2} * i, 2));
    EXPECT_FALSE(one.empty());
    EXPECT_EQ(digest(other), digest(one));
  }
}

TEST_BOTH_DRAWS(RegulatedGrowth, RecordsThatAreNotFiniteCountAsZero) {
  const auto devo = make<Devo>("regulated-growth");
  Life life = two_chains();
  life.contact = {NAN, 0.5, 0, 0, 0, 0};
  life.living.stress[3] = NAN;
  life.own = genes(*devo, {{"signal", "contact", 1}, {"memory 1", "load", 1}});
  const Edits edits = develop(*devo, life, 1);
  const std::vector<double> known = remembered(edits.mass_memory);
  for (const double value : known) EXPECT_TRUE(std::isfinite(value));
  EXPECT_EQ(known.at(0), 0);
  EXPECT_EQ(known.at(2), std::tanh(0.5));
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
