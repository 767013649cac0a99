// Newborns, clones, which are newborns that are genetically equal to another individual, and how selection treats
// copies.
#include "evolution/breeding.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "evolution/clones.hpp"
#include "support/experiments.hpp"
#include "support/lives.hpp"
#include "support/messages.hpp"
#include "support/refusals.hpp"
#include "support/scratch.hpp"
#include "threads/parallel.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

using ::testing::ElementsAre;

TEST(Breeding, ChildrenKnowTheirParentsAndTheOldestGenesAge) {
  const Experiment experiment = testing::small({"encoding.size=[4, 4, 4]"});
  std::vector<Individual> population = testing::scored_population(experiment, 6);
  ASSERT_EQ(population.size(), 6u);
  for (Individual& individual : population) {
    EXPECT_EQ(individual.made_by, "random");
    individual.origin = individual.id;
  }
  EXPECT_EQ(population[5].id, 5u);
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
  const Experiment experiment = testing::small({"encoding.size=[4, 4, 4]"});
  const auto genome = [&](std::uint32_t generation, std::uint32_t id, std::size_t place) {
    return breed(experiment, {}, generation, id, place + 1)[place].genome;
  };
  for (std::uint32_t i = 0; i < 4; ++i) EXPECT_EQ(genome(2, 7, i), genome(2, 7 + i, 0));
  EXPECT_NE(genome(2, 7, 0), genome(3, 7, 0));
  const Experiment other = testing::small({"encoding.size=[4, 4, 4]", "experiment.seed=8"});
  EXPECT_NE(genome(2, 7, 0), breed(other, {}, 2, 7, 1)[0].genome);
}

/// Robots of few voxels have few genomes, so that many newborns are made again.
TEST(Breeding, OnThreadsMakesTheSameNewborns) {
  const Experiment experiment = testing::small();
  Workers workers(4);
  const std::vector<Individual> population = testing::scored_population(experiment, 300);
  const auto expect_same = [](const std::vector<Individual>& a, const std::vector<Individual>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i)
      EXPECT_TRUE(std::tie(a[i].id, a[i].genome, a[i].parents, a[i].made_by) ==
                  std::tie(b[i].id, b[i].genome, b[i].parents, b[i].made_by))
          << i;
  };
  expect_same(population, breed(experiment, {}, 0, 0, 300, {}, &workers));
  expect_same(breed(experiment, population, 1, 300, 600), breed(experiment, population, 1, 300, 600, {}, &workers));
}

TEST(Breeding, OperatorsAreDrawnWithTheirProbabilities) {
  const std::string text = testing::small_experiment + "[[mutation]]\nname = \"gaussian\"\n";
  // hardly any genome of real genes comes twice
  const Experiment experiment = testing::read(
      text,
      testing::overrides({"encoding={name = 'neural'}", "mutation.0.probability=0.6", "mutation.1.probability=0.2",
                          "crossover.0.probability=0", "experiment.random_individuals=0"}));
  const std::vector<Individual> population = testing::scored_population(experiment, 2);
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

/// Operators that write down what they see, and change nothing.
struct Seen {
  std::vector<std::uint32_t> generations;
  std::vector<Layout> layouts;

  void see(const VariationContext& context) {
    generations.push_back(context.generation);
    layouts.push_back(context.layout);
  }
};

struct SeeingMutation final : Mutation {
  explicit SeeingMutation(Seen& by) : seen(by) {}
  void mutate(Genome&, const VariationContext& context, Rng&) const override { seen.see(context); }
  Seen& seen;
};

struct SeeingCrossover final : Crossover {
  explicit SeeingCrossover(Seen& by) : seen(by) {}
  Genome cross(const Parents& parents, const VariationContext& context, Rng&) const override {
    seen.see(context);
    return parents.first;
  }
  Seen& seen;
};

TEST(Breeding, OperatorsSeeTheGenerationOfTheChildAndTheirLayout) {
  Experiment experiment =
      testing::small({"crossover.0.probability=1", "mutation.0.probability=1", "experiment.random_individuals=0"});
  Seen mutation, crossover;
  experiment.mutations[0].op = std::make_unique<SeeingMutation>(mutation);
  experiment.crossovers[0].op = std::make_unique<SeeingCrossover>(crossover);
  const std::vector<Individual> population = testing::scored_population(experiment, 3);
  breed(experiment, population, 9, 100, 2);
  const Couple couple{0, 1};
  children_of(experiment, population, {&couple, 1}, 31, 200);
  for (const auto& [seen, layout] :
       {std::pair(mutation, experiment.mutations[0].layout), {crossover, experiment.crossovers[0].layout}}) {
    // each child, as a clone of its parent, is made again 16 times
    EXPECT_EQ(std::ranges::count(seen.generations, 9u), 2 * 17);
    EXPECT_EQ(std::ranges::count(seen.generations, 31u), 17);
    EXPECT_EQ(seen.generations.size(), 3u * 17);
    for (const Layout& one : seen.layouts) ASSERT_EQ(one, layout);
  }
}

/// A mutation that sets a gene to NaN.
struct Poison final : Mutation {
  void mutate(Genome& genome, const VariationContext&, Rng&) const override {
    genome[0] = std::numeric_limits<float>::quiet_NaN();
  }
};

TEST(Breeding, AnOperatorThatLeavesTheLayoutIsNamed) {
  Experiment experiment = testing::small({"crossover.0.probability=0", "mutation.0.probability=1"});
  experiment.mutations[0].op = std::make_unique<Poison>();
  const std::vector<Individual> population = testing::scored_population(experiment, 2);
  EXPECT_THAT(testing::refusal<std::runtime_error>([&] { breed(experiment, population, 1, 2, 2); }),
              testing::at_place("mutation operator \"reset-weight\" of " + experiment.uses[2].file.string() +
                                    ", individual 2, seed 7: ",
                                "gene 0 = not a number", "correct the operator", "new run"));
}

Individual individual(std::uint32_t id, Genome genome, std::vector<double> objectives, std::uint32_t origin = 0) {
  Individual one;
  one.id = id;
  one.origin = origin;
  one.genome = std::move(genome);
  one.result.status = objectives.empty() ? Status::invalid : Status::ok;
  one.result.objectives = std::move(objectives);
  return one;
}

std::vector<std::uint32_t> ids(const std::vector<Individual>& individuals) {
  std::vector<std::uint32_t> ids;
  for (const Individual& one : individuals) ids.push_back(one.id);
  return ids;
}

TEST(Clones, AreThoseWithEqualGenes) {
  const std::vector<Individual> population = {individual(0, {1, 0.25F}, {3}), individual(1, {1, 0.5F}, {3})};
  EXPECT_EQ(count_clones(population, {}), 0);
  EXPECT_EQ(count_clones(population, {individual(2, {1, 0.75F}, {3}), individual(3, {1}, {3})}), 0);
  EXPECT_EQ(count_clones(population, {individual(2, {1, 0.5F}, {7})}), 1) << "whatever it scores";
  EXPECT_EQ(count_clones({}, {individual(2, {2}, {}), individual(3, {2}, {}), individual(4, {2}, {})}), 2);
  EXPECT_EQ(count_clones({individual(0, {0.0F}, {})}, {individual(1, {-0.0F}, {})}), 1) << "zeros are equal";
}

TEST(Copies, AreTakenOutButForTheYoungest) {
  std::vector<Individual> everyone = {individual(0, {1}, {3, 4}), individual(1, {2}, {3, 4}),
                                      individual(5, {1}, {3, 5}), individual(7, {1}, {3, 4}),
                                      individual(9, {1}, {3, 4})};
  EXPECT_THAT(remove_copies(everyone), ElementsAre(7, 9)) << "of equally young ones the first born stays";
  EXPECT_THAT(ids(everyone), ElementsAre(0, 1, 5)) << "others differ in genes or scores";
  EXPECT_THAT(remove_copies(everyone), ElementsAre());
  everyone = {individual(0, {1}, {3}, 0), individual(1, {1}, {3}, 4), individual(2, {1}, {3}, 2)};
  EXPECT_THAT(remove_copies(everyone), ElementsAre(0, 2));
  everyone = {individual(0, {1}, {}), individual(1, {1}, {}), individual(2, {2}, {}), individual(3, {1}, {1})};
  EXPECT_THAT(remove_copies(everyone), ElementsAre(1)) << "those without scores are equal in them";
}

/// An experiment with two voxels and mostly crossover, which on its own makes clones in about half of the cases.
Experiment few_genomes(std::vector<std::string> values) {
  values.push_back("mutation.0.probability=0.3");
  return testing::small(values);
}

TEST(Clones, AreMadeAnewWhereThereAreOtherGenomes) {
  const Experiment experiment = few_genomes({"encoding.size=[3, 1, 1]"});
  const std::vector<Individual> population = testing::scored_population(experiment, 6);
  EXPECT_EQ(count_clones({}, population), 0);
  for (std::uint32_t generation = 1; generation <= 20; ++generation)
    EXPECT_EQ(count_clones(population, breed(experiment, population, generation, 100, 7)), 0) << generation;
}

struct NoMutation final : Mutation {
  void mutate(Genome&, const VariationContext&, Rng&) const override {}
};

TEST(Clones, ThatCannotBeAvoidedAreBorn) {
  Experiment experiment = few_genomes({"crossover.0.probability=0", "experiment.random_individuals=0"});
  experiment.mutations[0].op = std::make_unique<NoMutation>();
  const std::vector<Individual> population = testing::scored_population(experiment, 6);
  const std::vector<Individual> children = breed(experiment, population, 1, 6, 5);
  EXPECT_THAT(ids(children), ElementsAre(6, 7, 8, 9, 10));
  EXPECT_EQ(count_clones(population, children), 5);
}

/// Complete runs with few possible genomes.
class Run : public ::testing::TestWithParam<const char*> {
 protected:
  /// Lives a run in robots of this size.
  void live(const std::string& size) {
    const Experiment experiment = few_genomes(
        {"encoding.size=" + size, std::string("selection.name=") + GetParam(), "experiment.evaluations=75"});
    archive_.emplace(Archive::create(scratch_ / "run", experiment, "test"));
    testing::evolve_to(100, experiment, *archive_, 2);
    while (const auto one = archive_->individual(static_cast<std::uint32_t>(everyone_.size())))
      everyone_.push_back(*one);
  }

  /// Returns the individuals from which the selection of a generation chose.
  std::vector<ArchivedIndividual> candidates(std::uint32_t generation) const {
    std::vector<ArchivedIndividual> candidates;
    for (const ArchivedIndividual& one : everyone_)
      if (one.born <= generation && one.died.value_or(generation) >= generation) candidates.push_back(one);
    return candidates;
  }

  testing::Scratch scratch_;
  std::optional<Archive> archive_;
  std::vector<ArchivedIndividual> everyone_;
};

TEST_P(Run, CountsTheClonesThatItsGenesShow) {
  live("[1, 1, 1]");  // all possible genomes soon exist
  ASSERT_EQ(everyone_.size(), 75u) << "clones are evaluated";
  std::int64_t sum = 0;
  for (const Summary& summary : archive_->generations()) {
    std::multiset<std::vector<float>> living;
    std::int64_t clones = 0;
    for (const ArchivedIndividual& one : candidates(summary.generation)) {
      clones += one.born == summary.generation && living.contains(one.genome.genes);
      living.insert(one.genome.genes);
    }
    EXPECT_EQ(summary.clones, clones) << summary.generation;
    sum += summary.clones;
  }
  EXPECT_GT(sum, 20);
}

TEST_P(Run, OfCopiesOneLivesOnAndTakesNoPlaceOnTheFront) {
  live("[2, 1, 1]");
  for (const Summary& summary : archive_->generations()) {
    std::set<std::pair<std::vector<float>, std::vector<double>>> living, distinct;
    for (const ArchivedIndividual& one : candidates(summary.generation)) {
      const std::pair key(one.genome.genes, one.result.objectives);
      distinct.insert(key);
      if (one.died != summary.generation) {
        EXPECT_TRUE(living.insert(key).second) << one.id << " is a copy that lives on";
      }
    }
    EXPECT_EQ(living.size(), std::min<std::size_t>(distinct.size(), 6)) << "in generation " << summary.generation;
  }
}

INSTANTIATE_TEST_SUITE_P(Clones, Run, ::testing::Values("elitist", "age-fitness-pareto", "pareto-layers"),
                         [](const auto& selection) {
                           std::string name = selection.param;
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
