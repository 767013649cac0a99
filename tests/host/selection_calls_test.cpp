// The tables of selection operators and what check refuses, what the operators see, and what becomes of what they
// choose, make, note and remember: their memory is committed with the generation, and given back when a run is resumed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "archive/record_check.hpp"
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

/// Remembers how often it was called, and notes that about the first row. It could also note a sum.
struct Counting final : Selection {
  std::vector<NoteTitle> notes() const override { return {{"calls"}, {"sum", "ids"}}; }
  std::vector<std::string> memory() const override { return {"calls"}; }
  std::vector<Couple> parents(const SelectionContext& context, std::uint32_t count, Rng& rng) const override {
    EXPECT_EQ(calls_in(context.memory), apart ? 0 : context.generation) << "parents are chosen with the memory";
    return draw_pairs(context.rows, count, rng, draw_any);
  }
  Survival survivors(const SelectionContext& context, std::uint32_t population, Rng&) const override {
    Survival survival = first_rows(best_first(context.rows), population);
    const double calls = calls_in(context.memory) + 1;
    EXPECT_EQ(calls, context.generation + 1u);
    survival.memory = SelectionMemory{.lists = {{"calls", {calls}}}};
    survival.notes = {{0, 0, calls}};
    if (fault) fault(survival);
    return survival;
  }
  static double calls_in(const SelectionMemory& memory) { return memory.empty() ? 0 : memory.list("calls").at(0); }

  bool apart = false;
  std::function<void(Survival&)> fault;
};

/// The best survive. It returns no memory, or forgets what it had.
struct Best final : Selection {
  std::vector<Couple> parents(const SelectionContext& context, std::uint32_t count, Rng& rng) const override {
    return draw_pairs(context.rows, count, rng, draw_any);
  }
  Survival survivors(const SelectionContext& context, std::uint32_t population, Rng&) const override {
    Survival survival = first_rows(best_first(context.rows), population);
    if (forgets) survival.memory = SelectionMemory();
    return survival;
  }
  bool forgets = false;
};

class Remembering : public ::testing::Test {
 protected:
  Remembering() {
    experiment_.selection.reset(counting_);
    experiment_.notes = counting_->notes();
  }
  /// Evolves until so many generations have been committed.
  void evolve_to(Archive& archive, std::size_t generations) { testing::evolve_to(generations, experiment_, archive); }
  Archive evolved(std::size_t generations) {
    Archive archive = Archive::create(scratch_ / "run", experiment_, "test");
    evolve_to(archive, generations);
    return archive;
  }
  std::string fault_of(const std::function<void(Survival&)>& fault) {
    counting_->fault = fault;
    Archive archive = Archive::create(scratch_ / ("fault" + std::to_string(faults_++)), experiment_, "test");
    const std::string said = testing::refusal<std::runtime_error>([&] { evolve_to(archive, 1); });
    EXPECT_TRUE(archive.generations().empty());
    return said;
  }

  testing::Scratch scratch_;
  Experiment experiment_ = testing::read(testing::small_experiment);
  Counting* counting_ = new Counting;
  int faults_ = 0;
};

TEST_F(Remembering, IsCommittedWithTheGenerationAndGivenBack) {
  EXPECT_TRUE(Archive::create(scratch_ / "new", experiment_, "test").memory().survivors.empty());
  EXPECT_EQ(Counting::calls_in(evolved(2).memory().survivors), 2);
  Archive archive = Archive::resume(scratch_ / "run");
  check_resumable(archive, experiment_);
  evolve_to(archive, 4);
  EXPECT_EQ(Counting::calls_in(archive.memory().survivors), 4);
  EXPECT_TRUE(archive.memory().parents.empty());
}

TEST_F(Remembering, WithoutANewMemoryTheOldOneStaysAndAnEmptyOneForgets) {
  const SelectionMemory version_3{.version = 3, .lists = {{"calls", {0.1, -0.0, 1e300}}}};
  counting_->fault = [&](Survival& survival) { survival.memory = version_3; };
  Archive archive = evolved(1);
  EXPECT_EQ(archive.memory().survivors, version_3);
  EXPECT_TRUE(std::signbit(archive.memory().survivors.lists.at("calls").at(1)));
  experiment_.selection = std::make_unique<Best>();
  evolve_to(archive, 2);
  EXPECT_EQ(archive.memory().survivors, version_3) << "of the last generation, though nothing was returned";
  auto forgetting = std::make_unique<Best>();
  forgetting->forgets = true;
  experiment_.selection = std::move(forgetting);
  evolve_to(archive, 3);
  EXPECT_TRUE(archive.memory().survivors.empty());
}

TEST_F(Remembering, NotesOfAnIndividualAreTheLastOnes) {
  const Archive archive = evolved(3);
  std::size_t noted = 0;
  double last = 0;
  for (std::uint32_t id = 0; id < 18; ++id)
    for (const ArchivedNote& note : archive.notes(id)) {
      ++noted;
      EXPECT_EQ(note.name, "calls");
      last = std::max(last, note.value);
    }
  EXPECT_EQ(last, 3);
  EXPECT_LE(noted, 3u);
  EXPECT_EQ(archive.note_titles().at(1).unit, "ids");
}

TEST_F(Remembering, AnotherOperatorForParentsHasNoMemory) {
  auto parents = std::make_unique<Counting>();
  parents->apart = true;
  experiment_.parent_selection = std::move(parents);
  EXPECT_EQ(Counting::calls_in(evolved(3).memory().survivors), 3);
}

TEST_F(Remembering, FaultsAreNamedBeforeAnythingIsCommitted) {
  EXPECT_THAT(fault_of([](Survival& s) {
                s.notes.push_back({0, 1, NAN});
              }),
              testing::naming("selection operator", "sum", "finite"));
  EXPECT_THAT(fault_of([](Survival& s) { s.notes.push_back({0, 2, 1}); }), testing::naming("number 2", "2 numbers"));
  EXPECT_THAT(fault_of([](Survival& s) { s.notes.push_back({0, 0, 2}); }), testing::naming("calls", "twice", "row 0"));
  EXPECT_THAT(fault_of([](Survival& s) { s.notes.push_back({99, 0, 1}); }), testing::naming("row 99", "6 rows"));
  EXPECT_THAT(fault_of([](Survival& s) { s.rows = {2, 2}; }), testing::naming("twice", "different"));
  EXPECT_THAT(fault_of([](Survival& s) { s.rows = {999}; }), testing::naming("row 999", "1 to 6", "of 6"));
  EXPECT_THAT(fault_of([](Survival& s) { s.rows.clear(); }), testing::naming("0 survivors", "1 to 6"));
  const auto remembers = [&](const std::string& list, const std::vector<double>& numbers) {
    return fault_of([&](Survival& s) { s.memory = SelectionMemory{.lists = {{"calls", {}}, {list, numbers}}}; });
  };
  EXPECT_THAT(remembers("sum", {1}), testing::naming("\"sum\"", "memory()"));
  for (const double wrong : {NAN, INFINITY})
    EXPECT_THAT(fault_of([&](Survival& s) {
                  s.memory->lists["calls"] = {1, wrong};
                }),
                testing::naming("\"calls\"", "number 1", "finite"));
  EXPECT_THAT(fault_of([&](Survival& s) { s.memory->lists["calls"].resize((std::size_t{16} << 20) + 1); }),
              testing::naming("134217736", "134217728"));
}

TEST_F(Remembering, TheRecordOfAnotherOperatorIsRefused) {
  const Archive archive = evolved(1);
  experiment_.notes = {{"calls"}};
  EXPECT_THAT(testing::refusal<ArchiveError>([&] { check_resumable(archive, experiment_); }),
              testing::naming("sum in ids", "calls in 1"));
}

/// Makes children that are all equal, and counts those that it sees again.
struct Twins : Selection {
  std::vector<std::string> memory() const override { return {"newborns", "broods"}; }
  std::vector<NoteTitle> notes() const override { return {{"brood"}}; }
  Offspring children(const SelectionContext& context, std::uint32_t count, Rng&) const override {
    const double broods = context.memory.empty() ? 1 : context.memory.list("broods").at(0) + 1;
    Offspring made = std::vector<Child>(count, {Genome(context.layout.first_size(), 1), {}, {{0, broods}}});
    made.memory = SelectionMemory{.lists = {{"newborns", {}}, {"broods", {broods}}}};
    return made;
  }
  Survival survivors(const SelectionContext& context, std::uint32_t, Rng&) const override {
    const auto broods = context.memory.empty() ? std::vector<double>() : context.memory.list("broods");
    EXPECT_EQ(broods, apart ? std::vector<double>() : std::vector{context.generation + 1.0})
        << "what children() has remembered in this generation";
    const auto newborns =
        std::count_if(context.rows.begin(), context.rows.end(), [](const Candidate& row) { return row.is_newborn; });
    Survival survival = std::vector<std::uint32_t>{0};
    survival.memory = SelectionMemory{.lists = {{"newborns", {static_cast<double>(newborns)}}, {"broods", broods}}};
    if (context.rows[0].is_newborn) survival.notes = {{0, 0, -1}};
    return survival;
  }

  bool apart = false;
};

struct Twinning : Remembering {
  Twinning() {
    experiment_.selection.reset(twins_);
    experiment_.notes = twins_->notes();
    experiment_.child_maker = "twins";
    experiment_.random_individuals = 0;
    experiment_.children = 4;
    experiment_.development.cycles = 0;  // equal genes have equal scores, because development draws no random numbers
  }
  /// Lets another operator make the children.
  void part() {
    twins_->apart = true;
    experiment_.parent_selection = std::make_unique<Twins>();
    experiment_.child_notes = {{"litter"}};
  }
  /// Returns the value of each note about an individual.
  static std::map<std::string, double> notes_of(const Archive& archive, std::uint32_t id) {
    std::map<std::string, double> values;
    for (const ArchivedNote& note : archive.notes(id)) values[note.name] = note.value;
    return values;
  }

  Twins* twins_ = new Twins;
};

TEST_F(Twinning, AnOperatorSeesAllChildrenThatItHasMadeItself) {
  const auto seen = [&](const char* folder) {
    Archive archive = Archive::create(scratch_ / folder, experiment_, "test");
    evolve_to(archive, 2);
    EXPECT_EQ(archive.generations().back().evaluations, 8) << "four in each generation, the first included";
    EXPECT_EQ(archive.generations().back().clones, 4);
    return archive.memory().survivors.list("newborns").at(0);
  };
  EXPECT_EQ(seen("own"), 4);
  part();
  EXPECT_EQ(seen("apart"), 1) << "copies are removed if another operator chooses the survivors";
}

TEST_F(Twinning, WhatChildrenRemembersAndNotesIsCommittedAndGivenBack) {
  for (const bool apart : {false, true}) {
    if (apart) part();
    const auto folder = scratch_ / (apart ? "apart" : "own");
    {
      Archive begun = Archive::create(folder, experiment_, "test");
      evolve_to(begun, 1);
    }
    Archive archive = Archive::resume(folder);
    check_resumable(archive, experiment_);
    evolve_to(archive, 3);
    const Memories memory = archive.memory();
    EXPECT_THAT((apart ? memory.parents : memory.survivors).list("broods"), ElementsAre(3)) << "one per generation";
    EXPECT_EQ(memory.parents.empty(), !apart);
    using Notes = std::map<std::string, double>;
    EXPECT_EQ(notes_of(archive, 5), (apart ? Notes{{"litter", 2}} : Notes{{"brood", 2}}));
    // survivors() has noted another number about one child of the first brood
    std::multiset<Notes> first;
    for (std::uint32_t id = 0; id < 4; ++id) first.insert(notes_of(archive, id));
    const Notes noted = apart ? Notes{{"brood", -1}, {"litter", 1}} : Notes{{"brood", -1}},
                other = apart ? Notes{{"litter", 1}} : Notes{{"brood", 1}};
    EXPECT_EQ(first, (std::multiset<Notes>{noted, other, other, other}));
  }
}

TEST_F(Twinning, AMemoryOfAnOperatorThatTheExperimentLacksIsRefused) {
  part();
  const Archive archive = [&] {
    Archive created = Archive::create(scratch_ / "apart", experiment_, "test");
    evolve_to(created, 1);
    return created;
  }();
  experiment_.parent_selection.reset();
  EXPECT_THAT(testing::refusal<ArchiveError>([&] { check_resumable(archive, experiment_); }),
              testing::naming("[selection.parents]", "remembers"));
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
  struct Derived final : Twins {};
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
