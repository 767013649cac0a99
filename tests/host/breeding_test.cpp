// Newborns.
#include "evolution/breeding.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "support/experiments.hpp"
#include "support/messages.hpp"
#include "threads/parallel.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

TEST(Breeding, TheFirstGenerationIsRandom) {
  const Experiment experiment = testing::read(testing::small_experiment);
  const std::vector<Individual> newborns = breed(experiment, {}, 0, 0, 6);
  ASSERT_EQ(newborns.size(), 6u);
  for (const Individual& individual : newborns) EXPECT_EQ(individual.made_by, "random");
  EXPECT_EQ(newborns[5].id, 5u);
}

TEST(Breeding, ChildrenKnowTheirParentsAndTheOldestGenesAge) {
  const Experiment experiment = testing::read(testing::small_experiment, {{"encoding.size", "[4, 4, 4]", ""}});
  std::vector<Individual> population = breed(experiment, {}, 0, 0, 6);
  for (Individual& individual : population) {
    individual.result.objectives = {1.0 + individual.id, 1};
    individual.origin = individual.id;
  }
  const std::vector<Individual> newborns = breed(experiment, population, 9, 100, 40);
  ASSERT_EQ(newborns.size(), 40u);
  std::set<std::string> made_by;
  for (const Individual& child : newborns) {
    made_by.insert(child.made_by);
    EXPECT_EQ(child.born, 9u);
    if (child.parents.empty()) {
      EXPECT_EQ(child.made_by, "random");
      EXPECT_EQ(child.origin, 9u);
      continue;
    }
    const bool crossed = child.made_by.find("two-point") != std::string::npos;
    ASSERT_EQ(child.parents.size(), crossed ? 2u : 1u);
    EXPECT_EQ(child.origin, *std::min_element(child.parents.begin(), child.parents.end()));
  }
  EXPECT_EQ(newborns.back().parents.size(), 0u) << "one random individual, as the experiment asks";
  EXPECT_EQ(made_by, (std::set<std::string>{"random", "reset-weight", "two-point", "two-point+reset-weight"}));
}

TEST(Breeding, DependsOnSeedGenerationAndIdAlone) {
  const Experiment experiment = testing::read(testing::small_experiment, {{"encoding.size", "[4, 4, 4]", ""}});
  const auto genomes = [](const std::vector<Individual>& individuals) {
    std::vector<Genome> list;
    for (const Individual& individual : individuals) list.push_back(individual.genome);
    return list;
  };
  EXPECT_EQ(genomes(breed(experiment, {}, 2, 7, 4)), genomes(breed(experiment, {}, 2, 7, 4)));
  EXPECT_EQ(breed(experiment, {}, 2, 7, 4)[3].genome, breed(experiment, {}, 2, 10, 1)[0].genome);
  EXPECT_NE(breed(experiment, {}, 2, 7, 1)[0].genome, breed(experiment, {}, 3, 7, 1)[0].genome);
  const Experiment other =
      testing::read(testing::small_experiment, {{"encoding.size", "[4, 4, 4]", ""}, {"experiment.seed", "8", ""}});
  EXPECT_NE(breed(experiment, {}, 2, 7, 1)[0].genome, breed(other, {}, 2, 7, 1)[0].genome);
}

/// Robots of few voxels have few genomes, so that many newborns are made again.
TEST(Breeding, OnThreadsMakesTheSameNewborns) {
  const Experiment experiment = testing::read(testing::small_experiment);
  Workers workers(4);
  std::vector<Individual> population = breed(experiment, {}, 0, 0, 300);
  for (Individual& individual : population) individual.result.objectives = {1.0 + individual.id, 1};
  const auto expect_same = [](const std::vector<Individual>& a, const std::vector<Individual>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      EXPECT_EQ(a[i].id, b[i].id);
      EXPECT_EQ(a[i].genome, b[i].genome) << i;
      EXPECT_EQ(a[i].parents, b[i].parents) << i;
      EXPECT_EQ(a[i].made_by, b[i].made_by) << i;
    }
  };
  expect_same(population, breed(experiment, {}, 0, 0, 300, {}, &workers));
  expect_same(breed(experiment, population, 1, 300, 600), breed(experiment, population, 1, 300, 600, {}, &workers));
}

TEST(Breeding, WithSmallProbabilitiesAChildStillGoesThroughOneOperator) {
  const Experiment experiment = testing::read(
      testing::small_experiment, {{"mutation.0.probability", "1e-9", ""}, {"crossover.0.probability", "0", ""}});
  std::vector<Individual> population = breed(experiment, {}, 0, 0, 2);
  for (Individual& individual : population) individual.result.objectives = {1, 1};
  for (const Individual& child : breed(experiment, population, 1, 2, 6)) {
    if (!child.parents.empty()) {
      EXPECT_EQ(child.made_by, "reset-weight") << "the only one with a chance";
    }
  }
}

TEST(Breeding, OperatorsAreDrawnWithTheirProbabilities) {
  const std::string text = testing::small_experiment + "[[mutation]]\nname = \"gaussian\"\n";
  // hardly any genome of real genes comes twice
  const Experiment experiment = testing::read(text, {{"encoding", "{name = 'neural'}", ""},
                                                     {"mutation.0.probability", "0.6", ""},
                                                     {"mutation.1.probability", "0.2", ""},
                                                     {"crossover.0.probability", "0", ""},
                                                     {"experiment.random_individuals", "0", ""}});
  std::vector<Individual> population = breed(experiment, {}, 0, 0, 2);
  for (Individual& individual : population) individual.result.objectives = {1, 1};
  constexpr std::size_t count = 20'000;
  std::map<std::string, double> share;
  for (const Individual& child : breed(experiment, population, 1, 2, count)) share[child.made_by] += 1.0 / count;
  // If none is drawn, which is so for 0.4 * 0.8 of the children, one of them is used, in the proportion of 3 to 1.
  const double none = 0.4 * 0.8, five_deviations = 5 * 0.5 / std::sqrt(static_cast<double>(count));
  EXPECT_NEAR(share["reset-weight"], 0.6 * 0.8 + none * 0.75, five_deviations);
  EXPECT_NEAR(share["gaussian"], 0.4 * 0.2 + none * 0.25, five_deviations);
  EXPECT_NEAR(share["reset-weight+gaussian"], 0.6 * 0.2, five_deviations);
  EXPECT_EQ(share.size(), 3u);
}

/// A mutation that sets a gene to NaN.
struct Poison final : Mutation {
  void mutate(Genome& genome, const Layout&, Rng&) const override {
    genome[0] = std::numeric_limits<float>::quiet_NaN();
  }
};

TEST(Breeding, AnOperatorThatLeavesTheLayoutIsNamed) {
  Experiment experiment = testing::read(testing::small_experiment,
                                        {{"crossover.0.probability", "0", ""}, {"mutation.0.probability", "1", ""}});
  experiment.mutations[0].op = std::make_unique<Poison>();
  std::vector<Individual> population = breed(experiment, {}, 0, 0, 2);
  for (Individual& individual : population) individual.result.objectives = {1, 1};
  try {
    breed(experiment, population, 1, 2, 2);
    FAIL() << "the fault went unnoticed";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), testing::at_place("mutation operator \"reset-weight\" of " +
                                                    experiment.uses[2].file.string() + ", individual 2, seed 7: ",
                                                "gene 0 = not a number", "correct the operator", "new run"));
  }
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
