// Clones, which are newborns that are genetically equal to another individual, and how selection treats copies.
#include "evolution/clones.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "evolution/breeding.hpp"
#include "evolution/evolution.hpp"
#include "support/experiments.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

using ::testing::ElementsAre;

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

TEST(Copies, AreTakenOutButForOne) {
  std::vector<Individual> everyone = {individual(0, {1}, {3, 4}), individual(1, {2}, {3, 4}),
                                      individual(5, {1}, {3, 5}), individual(7, {1}, {3, 4}),
                                      individual(9, {1}, {3, 4})};
  EXPECT_THAT(remove_copies(everyone), ElementsAre(7, 9)) << "of equally young ones the first born stays";
  EXPECT_THAT(ids(everyone), ElementsAre(0, 1, 5)) << "others differ in genes or scores";
  EXPECT_THAT(remove_copies(everyone), ElementsAre());
}

TEST(Copies, TheYoungestStays) {
  std::vector<Individual> everyone = {individual(0, {1}, {3}, 0), individual(1, {1}, {3}, 4),
                                      individual(2, {1}, {3}, 2)};
  EXPECT_THAT(remove_copies(everyone), ElementsAre(0, 2));
}

TEST(Copies, WithoutScoresAreEqualInThem) {
  std::vector<Individual> everyone = {individual(0, {1}, {}), individual(1, {1}, {}), individual(2, {2}, {}),
                                      individual(3, {1}, {1})};
  EXPECT_THAT(remove_copies(everyone), ElementsAre(1));
}

/// An experiment with two voxels and mostly crossover, which on its own makes clones in about half of the cases.
Experiment few_genomes(std::vector<Override> overrides = {}) {
  overrides.insert(overrides.begin(), {"mutation.0.probability", "0.3", ""});
  return testing::read(testing::small_experiment, std::move(overrides));
}

TEST(Clones, AreMadeAnewWhereThereAreOtherGenomes) {
  const Experiment experiment = few_genomes({{"encoding.size", "[3, 1, 1]", ""}});
  std::vector<Individual> population = breed(experiment, {}, 0, 0, 6);
  EXPECT_EQ(count_clones({}, population), 0);
  for (Individual& one : population) one.result.objectives = {1.0 + one.id, 1};
  for (std::uint32_t generation = 1; generation <= 20; ++generation)
    EXPECT_EQ(count_clones(population, breed(experiment, population, generation, 100, 7)), 0) << generation;
}

struct NoMutation final : Mutation {
  void mutate(Genome&, const Layout&, Rng&) const override {}
};

TEST(Clones, ThatCannotBeAvoidedAreBorn) {
  Experiment experiment =
      few_genomes({{"crossover.0.probability", "0", ""}, {"experiment.random_individuals", "0", ""}});
  experiment.mutations[0].op = std::make_unique<NoMutation>();
  std::vector<Individual> population = breed(experiment, {}, 0, 0, 6);
  for (Individual& one : population) one.result.objectives = {1, 1};
  const std::vector<Individual> children = breed(experiment, population, 1, 6, 5);
  EXPECT_THAT(ids(children), ElementsAre(6, 7, 8, 9, 10));
  EXPECT_EQ(count_clones(population, children), 5);
}

/// Complete runs with few possible genomes.
class Run : public ::testing::TestWithParam<const char*> {
 protected:
  Experiment experiment(std::vector<Override> overrides = {}) const {
    overrides.insert(overrides.begin(), {{"selection.name", GetParam(), ""}, {"experiment.evaluations", "75", ""}});
    return few_genomes(std::move(overrides));
  }

  /// Starts or resumes the run in a folder; stops it after the given number of generations.
  Archive live(const std::string& folder, const Experiment& experiment, std::size_t generations = 100) const {
    const bool there = std::filesystem::exists(scratch_ / folder);
    Archive archive =
        there ? Archive::resume(scratch_ / folder) : Archive::create(scratch_ / folder, experiment, "test");
    const auto simulator =
        make_cpu_simulator(experiment.scene, experiment.stepping, static_cast<int>(experiment.threads));
    std::atomic<bool> stop = false;
    Observer observer;
    observer.generation_done = [&](const Summary& summary) { stop = summary.generation + 1 >= generations; };
    evolve(experiment, *simulator, archive, stop, observer);
    return archive;
  }

  static std::vector<ArchivedIndividual> everyone(const Archive& archive) {
    std::vector<ArchivedIndividual> everyone;
    for (std::uint32_t id = 0; const auto one = archive.individual(id); ++id) everyone.push_back(*one);
    return everyone;
  }

  /// Returns the individuals from which the selection of a generation chose.
  static std::vector<ArchivedIndividual> candidates(const std::vector<ArchivedIndividual>& everyone,
                                                    std::uint32_t generation) {
    std::vector<ArchivedIndividual> candidates;
    for (const ArchivedIndividual& one : everyone)
      if (one.born <= generation && one.died.value_or(generation) >= generation) candidates.push_back(one);
    return candidates;
  }

  testing::Scratch scratch_;
};

TEST_P(Run, CountsTheClonesThatItsGenesShow) {
  // with one voxel, all possible genomes soon exist
  const Archive archive = live("run", experiment({{"encoding.size", "[1, 1, 1]", ""}}));
  const std::vector<ArchivedIndividual> all = everyone(archive);
  ASSERT_EQ(all.size(), 75u) << "clones are evaluated";
  std::int64_t sum = 0;
  for (const Summary& summary : archive.generations()) {
    std::multiset<std::vector<float>> living;
    std::int64_t clones = 0;
    for (const ArchivedIndividual& one : candidates(all, summary.generation)) {
      clones += one.born == summary.generation && living.contains(one.genome.genes);
      living.insert(one.genome.genes);
    }
    EXPECT_EQ(summary.clones, clones) << summary.generation;
    sum += summary.clones;
  }
  EXPECT_GT(sum, 20);
}

TEST_P(Run, OfCopiesOneLivesOnAndTakesNoPlaceOnTheFront) {
  const Experiment experiment = this->experiment();
  const Archive archive = live("run", experiment);
  const std::vector<ArchivedIndividual> all = everyone(archive);
  for (const Summary& summary : archive.generations()) {
    const std::uint32_t generation = summary.generation;
    std::set<std::pair<std::vector<float>, std::vector<double>>> living, distinct;
    for (const ArchivedIndividual& one : candidates(all, generation)) {
      const std::pair key(one.genome.genes, one.result.objectives);
      distinct.insert(key);
      if (one.died != generation) {
        EXPECT_TRUE(living.insert(key).second) << one.id << " is a copy that lives on";
      }
    }
    EXPECT_EQ(living.size(), std::min<std::size_t>(distinct.size(), 6)) << "in generation " << generation;
  }
}

TEST_P(Run, IsTheSameInPiecesAndOnAnyNumberOfThreads) {
  const std::vector<ArchivedIndividual> whole = everyone(live("whole", experiment({{"simulation.threads", "1", ""}})));
  for (const std::size_t generations : {2, 5}) live("pieces", experiment(), generations);
  const Archive archive = live("pieces", experiment({{"simulation.threads", "3", ""}}));
  const std::vector<ArchivedIndividual> pieces = everyone(archive);
  ASSERT_EQ(pieces.size(), whole.size());
  for (std::size_t i = 0; i < whole.size(); ++i) {
    EXPECT_EQ(pieces[i].genome, whole[i].genome) << i;
    EXPECT_EQ(pieces[i].made_by, whole[i].made_by) << i;
    EXPECT_EQ(pieces[i].result.objectives, whole[i].result.objectives) << i;
    EXPECT_EQ(pieces[i].died, whole[i].died) << i;
  }
  const auto once = Archive::read(scratch_ / "whole").generations(), again = archive.generations();
  ASSERT_EQ(once.size(), again.size());
  for (std::size_t i = 0; i < once.size(); ++i) EXPECT_EQ(once[i].clones, again[i].clones) << i;
}

INSTANTIATE_TEST_SUITE_P(Clones, Run, ::testing::Values("elitist", "age-fitness-pareto", "pareto-layers"),
                         [](const auto& selection) {
                           std::string name = selection.param;
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
