// The tables of selection operators and what check refuses, what the operators see, and what becomes of what they
// choose and make.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "commands/run/run.hpp"
#include "evodevo/helpers/rows.hpp"
#include "evodevo/plugin.hpp"
#include "evolution/breeding.hpp"
#include "evolution/selection_table.hpp"
#include "support/changed.hpp"
#include "support/experiments.hpp"
#include "support/lives.hpp"
#include "support/messages.hpp"
#include "support/refusals.hpp"
#include "support/scratch.hpp"

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

const std::string scenarios =
    "[[scenario]]\nname = \"flat\"\n[[scenario]]\nname = \"noisy\"\nrepeat = 2\nstart_noise = 0.01\n";

TEST(SelectionTable, TurnsScoresAndCountsAges) {
  const Experiment experiment = testing::read(testing::small_experiment);
  std::vector<Individual> everyone = {scored(3, 0, {2, 5}), scored(8, 4, {})};
  everyone.push_back(scored(9, 0, {1, 1}));
  everyone.push_back(scored(10, 6, {1, 1}));
  everyone[2].born = everyone[3].born = 6;
  everyone[2].parents = {8, 3};
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
  EXPECT_THAT(rows[0].cases, ElementsAre(2, -5)) << "without scenarios, every objective is a case";
  ASSERT_EQ(table.context().cases.size(), 2u);
  EXPECT_EQ(table.context().cases[1].scenario, "");
}

TEST(SelectionTable, ShowsTheScoresOfEveryTest) {
  const Experiment experiment = testing::read(testing::small_experiment + scenarios);
  ASSERT_EQ(experiment.cases.size(), 6u) << "two objectives in three tests";
  EXPECT_EQ(experiment.cases[2].scenario, "noisy");
  EXPECT_EQ(experiment.cases[2].repeat, 1u);
  EXPECT_EQ(experiment.cases[3].objective, 1u);
  std::vector<Individual> everyone = {scored(0, 0, {2, 5}), scored(1, 0, {})};
  for (const std::size_t objective : {0, 1}) {
    everyone[0].result.tests.push_back({1, 0, 0, objective, 10.0 + double(objective)});
    everyone[0].result.tests.push_back({1, 1, 0, objective, 20.0 + double(objective)});
    everyone[0].result.tests.push_back({1, 1, 1, objective, 30.0 + double(objective)});
  }
  const SelectionTable table(everyone, experiment, 0);
  EXPECT_THAT(table.rows()[0].cases, ElementsAre(10, 20, 30, -11, -21, -31));
  EXPECT_TRUE(table.rows()[1].cases.empty());
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

TEST(Rows, TiesAreBrokenByIdWhateverTheOrderOfTheRows) {
  const std::vector<double> score = {1};
  std::vector<Candidate> rows(6);
  const std::uint32_t ids[] = {9, 3, 7, 2, 8, 5};
  for (std::size_t i = 0; i < 6; ++i) rows[i].id = ids[i];
  for (const std::size_t i : {0, 1, 2, 3}) rows[i].scores = score;
  rows[3].age = 1;
  EXPECT_THAT(best_first(rows), ElementsAre(1, 2, 0, 3, 5, 4)) << "by score, youth and id; then who failed, by id";
}

/// Makes children with gene values that say what it saw; the last child has a parent and a mate. It remembers how often
/// it has made children, and notes that and its place about each of them.
struct Maker final : Selection {
  std::vector<NoteTitle> notes() const override { return {{"brood"}, {"place", "places"}}; }
  std::vector<std::string> memory() const override { return {"broods"}; }
  Offspring children(const SelectionContext& context, std::uint32_t count, Rng&) const override {
    Offspring made = std::vector<Child>(count + excess, Child{Genome(context.layout.first_size(), value)});
    if (context.rows.size() > 2) made.children.back().parents = parents;
    const double broods = context.memory.empty() ? 1 : context.memory.list("broods").at(0) + 1;
    for (std::size_t i = 0; i < made.children.size(); ++i)
      made.children[i].notes = {{1, static_cast<double>(i)}, {0, broods}};
    made.memory = SelectionMemory{.lists = {{"broods", {broods}}}};
    if (fault) fault(made);
    return made;
  }
  std::uint32_t excess = 0;
  float value = 1;
  std::vector<std::uint32_t> parents = {2, 1};
  std::function<void(Offspring&)> fault;
};

struct Making : ::testing::Test {
  Making() {
    experiment.selection.reset(maker);
    experiment.notes = maker->notes();
    experiment.child_maker = "maker";
  }
  std::string fault() {
    return testing::refusal<std::runtime_error>([&] { breed(experiment, population, 9, 100, 4); });
  }
  Experiment experiment = testing::read(testing::small_experiment);
  Maker* maker = new Maker;
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
  experiment.random_individuals = 0;
  for (const Individual& newborn : breed(experiment, {}, 0, 0, 4))
    EXPECT_EQ(newborn.made_by, "maker") << "in the first generation too";
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
  maker->parents = {0, 1};
  const auto fault_of = [&](const std::function<void(Offspring&)>& change) {
    maker->fault = change;
    return fault();
  };
  EXPECT_THAT(fault_of([](Offspring& made) {
                made.children[3].notes = {{2, 1}};
              }),
              says("number 2", "child 3", "2 numbers"));
  EXPECT_THAT(fault_of([](Offspring& made) {
                made.children[3].notes = {{1, NAN}};
              }),
              says("place = not a number", "child 3", "finite"));
  EXPECT_THAT(fault_of([](Offspring& made) {
                made.children[3].notes = {{1, 1}, {1, 2}};
              }),
              says("place twice", "child 3"));
  EXPECT_THAT(fault_of([](Offspring& made) { made.memory->lists["litters"] = {1}; }), says("\"litters\"", "memory()"));
}

TEST_F(Making, WhatIsRememberedAndNotedBelongsToTheOperatorThatMakesTheChildren) {
  experiment.random_individuals = 1;
  Remembered remembered;
  breed(experiment, population, 9, 100, 4, &remembered);
  breed(experiment, population, 10, 104, 4, &remembered);
  EXPECT_THAT(remembered.memory.survivors.list("broods"), ElementsAre(2));
  EXPECT_TRUE(remembered.memory.parents.empty());
  ASSERT_EQ(remembered.notes.size(), 12u) << "two about each of six children, and none about who is random";
  EXPECT_EQ(remembered.notes[11].individual, 106u);
  EXPECT_EQ(remembered.notes[11].title, 0u);
  EXPECT_EQ(remembered.notes[11].value, 2);

  auto maker_alone = std::make_unique<Maker>();
  experiment.child_notes = maker_alone->notes();
  experiment.parent_selection = std::move(maker_alone);
  experiment.notes = {{"novelty"}};
  remembered = {};
  breed(experiment, population, 9, 100, 4, &remembered);
  EXPECT_TRUE(remembered.memory.survivors.empty());
  EXPECT_THAT(remembered.memory.parents.list("broods"), ElementsAre(1));
  EXPECT_EQ(remembered.notes.at(1).title, 1u) << "after the title of the other operator";
  EXPECT_EQ(experiment.note_titles().at(1).name, "brood");
}

namespace fs = std::filesystem;

const std::string voxel = "name = \"voxel\"\nsize = [2, 1, 1]\nedge = 0.5\n";
const std::string mutation = "[[mutation]]\nname = \"reset-weight\"\nprobability = 0.8\n\n";
const std::string crossover = "[[crossover]]\nname = \"two-point\"\nprobability = 0.5\n\n";
const std::string selection = "[selection]\nname = \"age-fitness-pareto\"\n";
const std::string descriptor = "[[fitness]]\nname = \"descriptor\"\nsettle = 0.05\nwindow = 0.1\n";

/// A table of selection, such as `[selection.parents]`, with the operator of this name.
std::string table(const std::string& kind, const std::string& name) {
  return "[" + kind + "]\nname = \"" + name + "\"\n";
}
std::string apart(const std::string& parents, const std::string& survivors) {
  return table("selection.parents", parents) + table("selection.survivors", survivors);
}

using Changes = std::vector<std::pair<std::string, std::string>>;

/// The small experiment with another selection.
std::string selecting(const std::string& tables) { return testing::small_with({{selection, tables}}); }

/// An experiment without variation whose genes are real.
std::string sampling(const std::string& tables, Changes changes = {}) {
  changes.insert(changes.end(), {{selection, tables},
                                 {mutation, ""},
                                 {crossover, ""},
                                 {"random_individuals = 1\n", ""},
                                 {voxel, "name = \"neural\"\npoints = 12\nneighbours = 4\n"}});
  return testing::small_with(changes);
}

Experiment read(const std::string& text) {
  const fs::path folder = EVODEVO_FAULTY_PLUGINS;
  return read_experiment(text, {"test.toml", {}, {folder / "special", folder / "novelty", folder / "cross_entropy"}});
}

std::string complaint(const std::string& text) {
  return testing::refusal<ConfigError>([&] { read(text); });
}

TEST(SelectionSettings, ParentsAndSurvivorsCanHaveOperatorsOfTheirOwn) {
  const Experiment experiment = read(selecting(apart("lottery", "best")));
  ASSERT_TRUE(experiment.selection && experiment.parent_selection);
  EXPECT_EQ(&experiment.breeder(), experiment.parent_selection.get());
  EXPECT_THAT(experiment.call_of(Selection::kind, experiment.breeder_index()).title->whole,
              ::testing::HasSubstr("lottery"));
  EXPECT_EQ(testing::read(experiment.resolved).resolved, experiment.resolved);
  const Experiment both = read(selecting(selection));
  EXPECT_EQ(&both.breeder(), both.selection.get());
}

TEST(SelectionSettings, WhatAnOperatorOverridesIsFoundWhenItIsCompiled) {
  const auto found = [](const Selection& op) {
    return std::string(op.overrides.parents ? "p" : "") + (op.overrides.survivors ? "s" : "") +
           (op.overrides.children ? "c" : "");
  };
  const Experiment experiment = read(selecting(apart("lottery", "best")));
  EXPECT_EQ(found(*experiment.parent_selection), "p");
  EXPECT_EQ(found(*experiment.selection), "s");
  EXPECT_EQ(found(*read(sampling(table("selection", "cma-es"))).selection), "sc");
  EXPECT_EQ(found(*read(selecting(selection)).selection), "ps");
  struct Base : Selection {
    Offspring children(const SelectionContext&, std::uint32_t, Rng&) const override { return {}; }
  };
  struct Derived final : Base {};
  static_assert(overrides_of<Derived>().children && !overrides_of<Derived>().parents, "of its base class");
}

TEST(SelectionSettings, OperatorsForBothHalvesAreNeeded) {
  EXPECT_THAT(complaint(selecting(table("selection.parents", "lottery"))),
              testing::at_place("test.toml:", "selection.survivors", "[selection.survivors]"));
  EXPECT_THAT(complaint(selecting(table("selection.survivors", "best"))),
              testing::at_place("test.toml:", "selection.parents", "[selection.parents]"));
  EXPECT_THAT(complaint(selecting(table("selection", "elitist") + apart("lottery", "best"))),
              testing::naming("selection.name"));
  EXPECT_THAT(complaint(selecting(table("selection", "lottery"))),
              testing::naming("selection.name = \"lottery\"", "overrides no survivors()", "[selection.parents]"));
  EXPECT_THAT(complaint(selecting(table("selection", "best"))),
              testing::naming("selection.name = \"best\"", "parents()", "[selection.survivors]"));
}

TEST(SelectionSettings, AnOperatorThatRemembersWhenItChoosesSurvivorsCannotChooseParentsAlone) {
  EXPECT_THAT(complaint(selecting(apart("species", "best"))),
              testing::naming("selection.parents.name = \"species\"", "memory()", "[selection]"));
  EXPECT_THAT(complaint(sampling(apart("cma-es", "best"))),
              testing::naming("selection.parents.name = \"cma-es\"", "memory()", "[selection]"));
  EXPECT_TRUE(read(selecting(apart("lottery", "species"))).parent_selection);
}

TEST(SelectionSettings, AnOperatorThatNeedsMoreIndividualsIsRefused) {
  const auto with = [](const std::string& name, const std::string& keys) {
    return sampling(table("selection", name), {{"population = 6\n", keys}});
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
  EXPECT_THAT(complaint(selecting(table("selection", "outside.novelty"))),
              testing::naming("selection.name = \"outside.novelty\"", "1 descriptor", "give 0", "[[fitness]]"));
  const Experiment novelty = read(selecting(descriptor + table("selection", "outside.novelty")));
  ASSERT_EQ(novelty.notes.size(), 1u);
  EXPECT_EQ(novelty.notes[0].name, "novelty");
  EXPECT_THAT(complaint(selecting(apart("three-goals", "best"))),
              testing::naming("selection.parents.name = \"three-goals\"", "3 objective", "give 2"));
}

TEST(SelectionSettings, AnOperatorThatMakesTheChildrenNeedsNoVariationAndRealGenes) {
  const std::string sampler = table("selection", "outside.cross-entropy");
  const Experiment experiment = read(sampling(sampler));
  EXPECT_TRUE(experiment.makes_children());
  EXPECT_EQ(experiment.random_individuals, 0) << "unless the experiment asks for them";
  EXPECT_EQ(read(experiment.resolved).random_individuals, 0);
  EXPECT_EQ(read(sampling(sampler, {{"seed = 7", "seed = 7\nrandom_individuals = 2"}})).random_individuals, 2);
  EXPECT_THAT(complaint(sampling(sampler) + mutation), testing::naming("mutation", "outside.cross-entropy", "remove"));
  EXPECT_THAT(complaint(sampling(sampler) + crossover),
              testing::naming("crossover", "outside.cross-entropy", "remove"));
  EXPECT_THAT(complaint(testing::small_with({{selection, sampler}, {mutation, ""}, {crossover, ""}})),
              testing::naming("selection.name", "\"voxel\"", "needs_real_genes", "encoding"));
  EXPECT_THAT(complaint(testing::small_with({{mutation, ""}, {crossover, ""}})),
              testing::naming("mutation", "[[mutation]]"));
}

TEST(SelectionSettings, WhereOnlyOneIsBornItHasParentsAndTheFirstGenerationFillsThePopulation) {
  for (const auto& [keys, first] : {std::pair{"population = 1\n", 1}, {"population = 5\nchildren = 1\n", 5}}) {
    const std::string text = testing::small_with(
        {{"population = 6\nrandom_individuals = 1\n", keys}, {"evaluations = 24", "evaluations = 12"}});
    const Experiment experiment = read(text);
    EXPECT_EQ(experiment.random_individuals, 0);
    EXPECT_EQ(read(experiment.resolved).random_individuals, 0);
    EXPECT_TRUE(experiment.warnings.empty());
    const testing::FinishedRun run(read(text));
    for (std::uint32_t id = 0; id < 12; ++id) {
      const auto individual = run.archive.individual(id);
      EXPECT_EQ(individual->made_by == "random", id < static_cast<std::uint32_t>(first)) << id;
      EXPECT_EQ(individual->parents.empty(), id < static_cast<std::uint32_t>(first)) << id;
    }
    EXPECT_EQ(run.archive.generations().front().evaluations, first);
  }
  const auto warned = [](const std::string& keys) {
    return read(testing::small_with({{"population = 6\nrandom_individuals = 1\n", keys}})).warnings;
  };
  EXPECT_THAT(warned("population = 6\nchildren = 1\nrandom_individuals = 1\n"),
              ::testing::ElementsAre(testing::naming("experiment.random_individuals = 1", "random", "set 0")));
  EXPECT_THAT(warned("population = 6\nchildren = 3\nrandom_individuals = 3\n"),
              ::testing::ElementsAre(testing::naming("experiment.random_individuals = 3", "less than 3")));
  EXPECT_THAT(warned("population = 6\nchildren = 3\nrandom_individuals = 2\n"), ::testing::IsEmpty());
}

TEST(SelectionSettings, GenerationsHaveAsManyChildrenAsAsked) {
  const auto with = [](const std::string& keys) { return testing::small_with({{"random_individuals = 1\n", keys}}); };
  EXPECT_EQ(read(testing::small_experiment).newborns(), 6) << "as many as the population";
  EXPECT_EQ(read(with("children = 9\n")).newborns(), 9);
  EXPECT_EQ(read(with("children = 9\nrandom_individuals = 9\n")).random_individuals, 9);
  EXPECT_THAT(complaint(with("children = 3\nrandom_individuals = 4\n")),
              testing::at_place("test.toml:7:22: experiment.random_individuals = 4: ", "children", "3"));
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
