// What selection operators remember and note, also about children that they make: it is committed with the generation,
// and given back when a run is resumed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "archive/record_check.hpp"
#include "commands/run/run.hpp"
#include "evodevo/helpers/rows.hpp"
#include "support/experiments.hpp"
#include "support/lives.hpp"
#include "support/messages.hpp"
#include "support/refusals.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

using ::testing::ElementsAre;

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

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
