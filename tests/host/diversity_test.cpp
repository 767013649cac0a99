// The map of the niches of a run, and what selection notes about the living, against runs whose answer is known.
#include "report/diversity.hpp"

#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "report/run_json.hpp"
#include "support/changed.hpp"
#include "support/messages.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using Json = nlohmann::ordered_json;

/// The table of a descriptor.
std::string descriptor(const std::string& what, const std::string& keys) {
  return "[[fitness]]\nname = 'descriptor'\nwhat = '" + what + "'\nsettle = 0.05\nwindow = 0.1\n" + keys;
}
const std::string height = descriptor("height", "range = [0.0, 2.0]\nbins = 4\n");

/// Makes archives by hand.
class Diversity : public ::testing::Test {
 protected:
  /// Adds an individual to the next generation. It has failed if it has no scores.
  void add(std::vector<double> objectives, std::vector<double> measures) {
    Individual& one = newborns_.emplace_back();
    one.id = next_++;
    one.born = one.origin = one.measured = generation_;
    one.genome = Genome(experiment_.layout.first_size(), 0);
    if (objectives.empty()) one.result = {Status::invalid, "no springs", 0, {}, 0};
    one.result.objectives = std::move(objectives);
    one.result.measures = std::move(measures);
  }
  void commit(const std::vector<std::uint32_t>& dropped, const std::vector<NoteOf>& notes = {}) {
    archive().commit({.newborns = newborns_,
                      .dropped = dropped,
                      .summary = {.generation = generation_++, .evaluations = next_},
                      .remembered = {.memory = {}, .notes = notes}});
    newborns_.clear();
  }
  Archive& archive() {
    if (!archive_) archive_.emplace(Archive::create(scratch_ / "run", experiment_, "test"));
    return *archive_;
  }

  /// Changes the file of the run.
  void alter(const char* sql) {
    SQLite::Database((scratch_ / "run" / "run.sqlite").string(), SQLite::OPEN_READWRITE).exec(sql);
  }

  testing::Scratch scratch_;
  Experiment experiment_ = testing::read(testing::small_experiment + height + descriptor("contact", "bins = 3\n"));

 private:
  std::optional<Archive> archive_;
  std::vector<Individual> newborns_;
  std::uint32_t next_ = 0, generation_ = 0;
};

TEST_F(Diversity, TheBestIndividualOfEachCellIsItsElite) {
  add({0.25, 9}, {0.1, 0.9});   // 0: cell 0, 2
  add({0.5, 9}, {0.4, 0.7});    // 1: the same cell, and better
  add({}, {});                  // 2: has failed
  add({-0.25, 9}, {1.0, 0.5});  // 3: cell 2, 1; on the lower border along the first axis
  commit({0});
  add({0.5, 1}, {0.3, 0.8});   // 4: as good as 1, which is older
  add({0.125, 9}, {5.0, -1});  // 5: outside of both ranges
  commit({1, 3});              // the dead count, too
  const NicheMap map = niche_map(archive());
  EXPECT_EQ(map.cells(), 12u);
  EXPECT_EQ(map_json(map).dump(),
            R"({"objective":"distance","axes":[{"name":"height","unit":"m","low":0.0,"high":2.0,"bins":4},)"
            R"({"name":"contact","unit":"1","low":0.0,"high":1.0,"bins":3}],"cells":12,"elites":[)"
            R"({"cell":[0,2],"individual":1,"value":0.5},{"cell":[2,1],"individual":3,"value":-0.25},)"
            R"({"cell":[3,0],"individual":5,"value":0.125}]})");
  ASSERT_EQ(map.history.size(), 2u);
  EXPECT_EQ(state_json(map, map.history[0]).dump(), R"({"filled":2,"coverage":0.16666666666666666,"qd_score":0.5})");
  EXPECT_EQ(state_json(map, map.history[1]).dump(), R"({"filled":3,"coverage":0.25,"qd_score":0.625})");
  EXPECT_THAT(best_elites(map, 2), ElementsAre(1, 5));
  EXPECT_THAT(best_elites(map, 9), ElementsAre(1, 5, 3));

  const Json run = run_json(archive(), experiment_);
  EXPECT_EQ(run["map"], map_json(map));
  EXPECT_EQ(run["generations"][1]["map"]["filled"], 3);
}

TEST_F(Diversity, AMissingDescriptorIsRefused) {
  add({1, 0}, {0.1, 0.2});
  commit({});
  alter("DELETE FROM measured WHERE measure = 0");
  EXPECT_THAT([&] { niche_map(archive()); },
              ::testing::ThrowsMessage<ArchiveError>(testing::naming("individual 0", "descriptor")));
}

TEST_F(Diversity, AMapOfOneRowHasElitesWithTheLeastScoresAndNoQdScore) {
  const std::string distance = "[[fitness]]\nname = \"distance\"\nsettle = 0.05\nwindow = 0.1\n";
  experiment_ = testing::read(testing::small_with({{distance, ""}}) + height);
  add({3}, {0.1});
  add({2}, {0.2});
  add({1}, {0.9});
  commit({});
  const NicheMap map = niche_map(archive());
  EXPECT_EQ(map.cells(), 4u);
  EXPECT_THAT(best_elites(map, 3), ElementsAre(2, 1));
  EXPECT_EQ(state_json(map, map.history[0]).dump(), R"({"filled":2,"coverage":0.5,"qd_score":null})");
}

TEST_F(Diversity, OfExperimentsWithoutAnAxisHasNoMap) {
  experiment_ = testing::small();
  add({1, 0}, {});
  commit({});
  EXPECT_TRUE(map_json(niche_map(archive())).is_null());
  const Json run = run_json(archive(), experiment_);
  EXPECT_TRUE(run["map"].is_null());
  EXPECT_TRUE(run["generations"][0]["map"].is_null());
  EXPECT_THAT(run["notes"], IsEmpty());
}

class Noted : public Diversity {
 protected:
  Noted() {
    experiment_ = testing::small();
    experiment_.notes = {{"species", "1", true}, {"novelty", "m"}};
  }
};

TEST_F(Noted, NotesHoldUntilAnotherIsMadeOrTheIndividualDies) {
  for (int i = 0; i < 3; ++i) add({1, 0}, {});
  commit({2}, {{0, 0, 7}, {1, 0, 7}, {2, 0, 8}, {0, 1, 0.5}, {1, 1, 0.25}, {2, 1, 4}});
  add({1, 0}, {});
  commit({}, {{0, 0, 7}, {1, 0, 9}, {1, 1, 0.25}, {3, 1, 1}});
  commit({0}, {});
  SQLite::Database database((scratch_ / "run" / "run.sqlite").string());
  EXPECT_EQ(database.execAndGet("SELECT count(*) FROM notes WHERE individual = 0").getInt(), 2) << "no note twice";
  const auto histories = archive().note_histories();
  ASSERT_EQ(histories.size(), 2u);
  EXPECT_TRUE(histories[0].title.is_label);
  EXPECT_FALSE(histories[1].title.is_label);
  EXPECT_THAT(histories[0].living, ElementsAre(ElementsAre(7, 7), ElementsAre(7, 9), ElementsAre(9)));
  EXPECT_THAT(histories[1].living,
              ElementsAre(ElementsAre(0.5, 0.25), ElementsAre(0.5, 0.25, 1), ElementsAre(0.25, 1)));
  EXPECT_EQ(archive().notes(1).at(0).value, 9);
  EXPECT_EQ(archive().notes(1).at(1).value, 0.25);
  EXPECT_EQ(archive().notes(2).at(1).value, 4) << "the dead keep their notes";

  const Json run = run_json(archive(), experiment_);
  EXPECT_EQ(run["notes"].dump(), R"([{"name":"species","unit":"1","is_label":true},)"
                                 R"({"name":"novelty","unit":"m","is_label":false}])");
  EXPECT_EQ(run["generations"][1]["notes"].dump(),
            R"({"species":{"groups":2},"novelty":{"greatest":1.0,"median":0.5}})");
}

TEST_F(Noted, NotesOfGenerationsThatTheRunDoesNotHaveAreRefused) {
  add({1, 0}, {});
  commit({}, {{0, 0, 7}});
  archive().commit(
      {.summary = {.generation = 1, .evaluations = 1}, .remembered = {.memory = {}, .notes = {{0, 0, 8}}}});
  alter("UPDATE notes SET generation = 5 WHERE generation = 1");
  EXPECT_THAT([&] { (void)archive().note_histories(); },
              ::testing::ThrowsMessage<ArchiveError>(testing::naming("notes.generation", "5")));
}

TEST(Labels, AreCountedByGeneration) {
  const std::vector<NoteHistory> histories = {{{"species", "1", true}, {{4, 4, 2}, {2, 3, 3, 3}, {3}}},
                                              {{"cell", "1", true}, {{1, 2, 3}, {2, 3}, {}}},
                                              {{"novelty", "1", false}, {{1, 1}, {1}, {1}}}};
  EXPECT_EQ(labels_json(histories).dump(),
            R"([{"name":"species","groups":[{"label":4.0,"counts":[2,0,0]},{"label":2.0,"counts":[1,1,0]},)"
            R"({"label":3.0,"counts":[0,3,1]}],"others":[0,0,0]}])");
  EXPECT_EQ(labels_json(histories, 1).dump(),
            R"([{"name":"species","groups":[{"label":3.0,"counts":[0,3,1]}],"others":[3,1,0]}])");
  const std::vector<NoteHistory> late = {{{"species", "1", true}, {{1, 2}, {5, 5}}}};
  EXPECT_EQ(labels_json(late, 2).dump(),
            R"([{"name":"species","groups":[{"label":1.0,"counts":[1,0]},{"label":5.0,"counts":[0,2]}],)"
            R"("others":[1,0]}])")
      << "a large group that came up late is shown";
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
