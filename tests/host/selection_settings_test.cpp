// The tables of selection operators, and what check refuses.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "evolution/evolution.hpp"
#include "support/experiments.hpp"
#include "support/messages.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

namespace fs = std::filesystem;

const std::string voxel = "name = \"voxel\"\nsize = [2, 1, 1]\nedge = 0.5\n";
const std::string mutation = "[[mutation]]\nname = \"reset-weight\"\nprobability = 0.8\n\n";
const std::string crossover = "[[crossover]]\nname = \"two-point\"\nprobability = 0.5\n\n";
const std::string selection = "[selection]\nname = \"age-fitness-pareto\"\n";
const std::string descriptor = "[[fitness]]\nname = \"descriptor\"\nsettle = 0.05\nwindow = 0.1\n";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  if (at == std::string::npos) throw std::logic_error("there is no " + from);
  return text.replace(at, from.size(), to);
}

/// The small experiment with another selection.
std::string selecting(const std::string& tables) { return replaced(testing::small_experiment, selection, tables); }

/// An experiment without variation whose genes are real.
std::string sampling(const std::string& tables = "[selection]\nname = \"outside.cross-entropy\"\n") {
  std::string text = replaced(selecting(tables), voxel, "name = \"neural\"\npoints = 12\nneighbours = 4\n");
  for (const std::string& table : {mutation, crossover, std::string("random_individuals = 1\n")})
    text = replaced(text, table, "");
  return text;
}

Experiment read(const std::string& text) {
  const fs::path folder = EVODEVO_FAULTY_PLUGINS;
  return read_experiment(text, {"test.toml", {}, {folder / "special", folder / "novelty", folder / "cross_entropy"}});
}

std::string complaint(const std::string& text) {
  try {
    read(text);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "no complaint";
}

TEST(SelectionSettings, ParentsAndSurvivorsCanHaveOperatorsOfTheirOwn) {
  const std::string tables = "[selection.parents]\nname = \"lottery\"\n[selection.survivors]\nname = \"best\"\n";
  const Experiment experiment = read(selecting(tables));
  ASSERT_TRUE(experiment.selection && experiment.parent_selection);
  EXPECT_EQ(&experiment.breeder(), experiment.parent_selection.get());
  EXPECT_THAT(experiment.call_of(Selection::kind, experiment.breeder_index()).title->whole,
              ::testing::HasSubstr("lottery"));
  const Experiment again = testing::read(experiment.resolved);
  EXPECT_EQ(again.resolved, experiment.resolved);
  const Experiment both = read(selecting(selection));
  EXPECT_EQ(&both.breeder(), both.selection.get());
}

TEST(SelectionSettings, BothTablesAreNeeded) {
  EXPECT_THAT(complaint(selecting("[selection.parents]\nname = \"lottery\"\n")),
              testing::at_place("test.toml:", "selection.survivors", "[selection.survivors]"));
  EXPECT_THAT(complaint(selecting("[selection.survivors]\nname = \"best\"\n")),
              testing::at_place("test.toml:", "selection.parents", "[selection.parents]"));
  EXPECT_THAT(complaint(selecting("[selection]\nname = \"elitist\"\n[selection.parents]\nname = \"lottery\"\n"
                                  "[selection.survivors]\nname = \"best\"\n")),
              testing::naming("selection.name"));
}

TEST(SelectionSettings, AnOperatorOfOneHalfIsNotTakenForBoth) {
  EXPECT_THAT(complaint(selecting("[selection]\nname = \"lottery\"\n")),
              testing::naming("selection.name = \"lottery\"", "chooses_survivors", "[selection.parents]"));
  EXPECT_THAT(complaint(selecting("[selection]\nname = \"best\"\n")),
              testing::naming("selection.name = \"best\"", "chooses_parents", "[selection.survivors]"));
}

TEST(SelectionSettings, AnOperatorThatNeedsAMemoryCannotChooseParentsAlone) {
  const std::string survivors = "[selection.survivors]\nname = \"best\"\n";
  EXPECT_THAT(complaint(selecting("[selection.parents]\nname = \"species\"\n" + survivors)),
              testing::naming("selection.parents.name = \"species\"", "needs_memory", "[selection]"));
  EXPECT_THAT(complaint(sampling("[selection.parents]\nname = \"cma-es\"\n" + survivors)),
              testing::naming("selection.parents.name = \"cma-es\"", "needs_memory", "[selection]"));
  EXPECT_TRUE(read(selecting("[selection.parents]\nname = \"lottery\"\n"
                             "[selection.survivors]\nname = \"species\"\n"))
                  .parent_selection);
}

TEST(SelectionSettings, AnOperatorThatNeedsMoreIndividualsIsRefused) {
  const auto with = [](const std::string& name, const std::string& keys) {
    return replaced(sampling("[selection]\nname = \"" + name + "\"\n"), "population = 6\n", keys);
  };
  EXPECT_THAT(complaint(with("differential", "population = 3\nchildren = 9\n")),
              testing::naming("selection.name = \"differential\"", "population = 4", "has 3", "[experiment]"));
  EXPECT_EQ(read(with("differential", "population = 4\nchildren = 1\n")).population, 4);
  EXPECT_THAT(complaint(with("cma-es", "population = 9\nchildren = 1\n")),
              testing::naming("selection.name = \"cma-es\"", "children = 2", "has 1", "[experiment]"));
  EXPECT_THAT(complaint(with("cma-es", "population = 1\n")), testing::naming("population = 2", "has 1"));
  EXPECT_EQ(read(with("cma-es", "population = 1\nchildren = 2\n")).newborns(), 2);
}

TEST(SelectionSettings, AnOperatorThatNeedsMoreScoresIsRefused) {
  EXPECT_THAT(complaint(selecting("[selection]\nname = \"outside.novelty\"\n")),
              testing::naming("selection.name = \"outside.novelty\"", "1 descriptor", "give 0", "[[fitness]]"));
  const Experiment novelty = read(selecting(descriptor + "[selection]\nname = \"outside.novelty\"\n"));
  ASSERT_EQ(novelty.notes.size(), 1u);
  EXPECT_EQ(novelty.notes[0].name, "novelty");
  EXPECT_THAT(complaint(selecting("[selection.parents]\nname = \"three-goals\"\n"
                                  "[selection.survivors]\nname = \"best\"\n")),
              testing::naming("selection.parents.name = \"three-goals\"", "3 objective", "give 2"));
}

TEST(SelectionSettings, AnOperatorThatMakesTheChildrenNeedsNoVariationAndRealGenes) {
  const Experiment experiment = read(sampling());
  EXPECT_TRUE(experiment.makes_children());
  EXPECT_EQ(experiment.random_individuals, 0) << "unless the experiment asks for them";
  EXPECT_EQ(read(experiment.resolved).random_individuals, 0);
  EXPECT_EQ(read(replaced(sampling(), "population = 6", "population = 6\nrandom_individuals = 2")).random_individuals,
            2);
  EXPECT_THAT(complaint(sampling() + mutation), testing::naming("mutation", "outside.cross-entropy", "remove"));
  EXPECT_THAT(complaint(sampling() + crossover), testing::naming("crossover", "outside.cross-entropy", "remove"));
  EXPECT_THAT(complaint(replaced(sampling(), "name = \"neural\"\npoints = 12\nneighbours = 4\n", voxel)),
              testing::naming("selection.name", "\"voxel\"", "needs_real_genes", "encoding"));
  EXPECT_THAT(complaint(replaced(replaced(testing::small_experiment, mutation, ""), crossover, "")),
              testing::naming("mutation", "[[mutation]]"));
}

TEST(SelectionSettings, GenerationsHaveAsManyChildrenAsAsked) {
  const auto with = [](const std::string& keys) {
    return replaced(testing::small_experiment, "random_individuals = 1\n", keys);
  };
  EXPECT_EQ(read(testing::small_experiment).newborns(), 6) << "as many as the population";
  EXPECT_EQ(read(with("children = 9\n")).newborns(), 9);
  EXPECT_EQ(read(with("children = 9\nrandom_individuals = 9\n")).random_individuals, 9);
  EXPECT_THAT(complaint(with("children = 3\nrandom_individuals = 4\n")),
              testing::at_place("test.toml:7:22: experiment.random_individuals = 4: ", "children", "3"));
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
