// What selection operators see, and what becomes of what they choose and make.
#include "evolution/selection_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "evodevo/helpers/rows.hpp"
#include "evolution/breeding.hpp"
#include "support/experiments.hpp"
#include "support/messages.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

using ::testing::ElementsAre;

Individual scored(std::uint32_t id, std::uint32_t origin, std::vector<double> objectives) {
  Individual individual;
  individual.id = id;
  individual.origin = origin;
  individual.genome = {1, 1};
  individual.result.status = objectives.empty() ? Status::diverged : Status::ok;
  individual.result.objectives = std::move(objectives);
  return individual;
}

const std::string scenarios = "[[scenario]]\nname = \"flat\"\n[[scenario]]\nname = \"noisy\"\nrepeat = 2\n";

TEST(SelectionTable, TurnsScoresAndCountsAges) {
  const Experiment experiment = testing::read(testing::small_experiment);
  std::vector<Individual> everyone = {scored(3, 0, {2, 5}), scored(8, 4, {})};
  everyone.push_back(scored(9, 0, {1, 1}));
  everyone.back().born = 6;
  everyone.back().parents = {8, 3};
  everyone.push_back(scored(10, 6, {1, 1}));
  everyone.back().born = 6;
  const SelectionTable table(everyone, experiment, 6);
  const auto rows = table.rows();
  EXPECT_THAT(rows[0].scores, ElementsAre(2, -5)) << "less work is better";
  EXPECT_EQ(rows[0].age, 6u);
  EXPECT_EQ(rows[1].age, 2u);
  EXPECT_FALSE(rows[1].ok());
  EXPECT_EQ(rows[1].status, Status::diverged);
  EXPECT_FALSE(rows[0].challenges.has_value());
  EXPECT_EQ(rows[2].challenges, 1u);
  EXPECT_THAT(rows[2].parents, ElementsAre(8, 3));
  EXPECT_FALSE(rows[3].challenges.has_value()) << "a random individual";
  EXPECT_TRUE(rows[3].is_newborn && !rows[0].is_newborn);
  EXPECT_EQ(rows[3].id, 10u);
  EXPECT_EQ(rows[3].genome, &everyone[3].genome);
  EXPECT_EQ(&table.context().layout, &experiment.layout);
  EXPECT_EQ(table.context().generation, 6u);
}

TEST(SelectionTable, ShowsTheScoresOfEveryTest) {
  const Experiment experiment = testing::read(testing::small_experiment + scenarios);
  ASSERT_EQ(experiment.cases.size(), 6u) << "two objectives in three tests";
  EXPECT_EQ(experiment.cases[2].scenario, "noisy");
  EXPECT_EQ(experiment.cases[2].repeat, 1u);
  EXPECT_EQ(experiment.cases[3].objective, 1u);
  std::vector<Individual> everyone = {scored(0, 0, {2, 5}), scored(1, 0, {})};
  for (const std::size_t objective : {0, 1}) {
    everyone[0].result.tests.push_back({0, 0, objective, 10.0 + double(objective)});
    everyone[0].result.tests.push_back({1, 0, objective, 20.0 + double(objective)});
    everyone[0].result.tests.push_back({1, 1, objective, 30.0 + double(objective)});
  }
  const SelectionTable table(everyone, experiment, 0);
  EXPECT_THAT(table.rows()[0].cases, ElementsAre(10, 20, 30, -11, -21, -31));
  EXPECT_TRUE(table.rows()[1].cases.empty());
}

TEST(SelectionTable, WithoutScenariosEveryObjectiveIsACase) {
  const Experiment experiment = testing::read(testing::small_experiment);
  const std::vector<Individual> everyone = {scored(0, 0, {2, 5})};
  const SelectionTable table(everyone, experiment, 0);
  EXPECT_THAT(table.rows()[0].cases, ElementsAre(2, -5));
  ASSERT_EQ(table.context().cases.size(), 2u);
  EXPECT_EQ(table.context().cases[1].scenario, "");
}

TEST(SelectionTable, ShowsDescriptorsAndHowFarAnIndividualIsFromFeasible) {
  Experiment experiment = testing::read(testing::small_experiment);
  experiment.measures = {{"limit", "N", true, Role::constraint},
                         {"place", "m", true, Role::descriptor, -1, 3},
                         {"note", "s", true, Role::measure},
                         {"weight", "kg", true, Role::constraint}};
  std::vector<Individual> everyone = {scored(0, 0, {1, 1}), scored(1, 0, {}), scored(2, 0, {})};
  everyone[0].result.measures = {-1, 0.5, 7, 0};
  everyone[1].result.status = Status::invalid;
  everyone[1].result.measures = {0.25, 0.5, 7, 2};
  const SelectionTable table(everyone, experiment, 0);
  const auto rows = table.rows();
  EXPECT_THAT(rows[0].descriptors, ElementsAre(0.5));
  EXPECT_EQ(rows[0].violation, 0);
  EXPECT_TRUE(rows[1].descriptors.empty());
  EXPECT_EQ(rows[1].violation, 2.25) << "both constraints";
  EXPECT_EQ(rows[2].violation, std::numeric_limits<double>::infinity()) << "it diverged";
  ASSERT_EQ(table.context().descriptors.size(), 1u);
  EXPECT_EQ(table.context().descriptors[0].high, 3);
}

TEST(Rows, OfThoseThatFailedTheLeastInfeasibleComeFirst) {
  const std::vector<double> score = {-100};
  std::vector<Candidate> rows(4);
  rows[0].violation = std::numeric_limits<double>::infinity();
  rows[1].violation = 3;
  rows[2].scores = score;
  rows[3].violation = 0.5;
  EXPECT_THAT(best_first(rows), ElementsAre(2, 3, 1, 0));
}

/// Makes children with gene values that say what it saw; the last child has a parent and a mate.
struct Maker final : Selection {
  std::vector<Child> children(const SelectionContext& context, std::uint32_t count, Rng&) const override {
    std::vector<Child> children(count + excess, Child{Genome(context.layout.first_size(), value)});
    if (context.rows.size() > 2) children.back().parents = parents;
    return children;
  }
  std::uint32_t excess = 0;
  float value = 1;
  std::vector<std::uint32_t> parents = {2, 1};
};

struct Making : ::testing::Test {
  Making() {
    auto op = std::make_unique<Maker>();
    maker = op.get();
    experiment.selection = std::move(op);
    experiment.child_maker = "maker";
  }
  std::string fault() {
    try {
      breed(experiment, population, 9, 100, 4);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "none";
  }
  Experiment experiment = testing::read(testing::small_experiment);
  Maker* maker;
  std::vector<Individual> population = {scored(4, 7, {1, 1}), scored(5, 2, {1, 1}), scored(6, 3, {1, 1})};
};

TEST_F(Making, ASelectionMakesTheChildrenItself) {
  experiment.random_individuals = 1;
  const std::vector<Individual> newborns = breed(experiment, population, 9, 100, 4);
  ASSERT_EQ(newborns.size(), 4u);
  EXPECT_EQ(newborns[0].made_by, "maker");
  EXPECT_EQ(newborns[0].id, 100u);
  EXPECT_EQ(newborns[0].genome, newborns[1].genome) << "clones stay as they are";
  EXPECT_TRUE(newborns[0].parents.empty());
  EXPECT_EQ(newborns[0].origin, 9u) << "the age of a child without parents counts from its birth";
  EXPECT_THAT(newborns[2].parents, ElementsAre(6, 5));
  EXPECT_EQ(newborns[2].origin, 2u) << "that of a child with parents from their oldest genes";
  EXPECT_EQ(newborns[3].made_by, "random");
}

TEST_F(Making, ItAlsoMakesTheFirstGeneration) {
  experiment.random_individuals = 0;
  for (const Individual& newborn : breed(experiment, {}, 0, 0, 4)) EXPECT_EQ(newborn.made_by, "maker");
}

TEST_F(Making, FaultsOfTheOperatorAreNamed) {
  experiment.random_individuals = 0;
  const auto says = [](const auto&... parts) { return testing::naming("selection operator", parts...); };
  maker->excess = 2;
  EXPECT_THAT(fault(), says("6 children", "4"));
  maker->excess = 0;
  maker->value = 1000;
  EXPECT_THAT(fault(), says("1000"));
  maker->value = 1;
  maker->parents = {0, 3};
  EXPECT_THAT(fault(), says("row 3", "3 rows"));
  maker->parents = {0, 1, 2};
  EXPECT_THAT(fault(), says("3 parents", "0 to 2"));
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
