// Runs with arbitrary contents from other sources: each command succeeds, or refuses the run in one line that names the
// folder.
#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <random>

#include "archive/archive.hpp"
#include "commands/commands.hpp"
#include "evolution/evolution.hpp"
#include "evolution/resimulation.hpp"
#include "experiment/device.hpp"
#include "report/report.hpp"
#include "support/experiments.hpp"
#include "support/messages.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// Provides a small run that was stopped halfway and can be resumed.
class ForeignRecord : public ::testing::Test {
 protected:
  ForeignRecord() {
    const Experiment experiment = testing::small(
        {"experiment.evaluations=18", "experiment.verify=0", "fitness.0.window=0.05", "fitness.1.window=0.05"});
    const auto simulator = make_simulator(experiment);
    Archive archive = Archive::create(original_, experiment, simulator->device());
    std::atomic<bool> stop = false;
    evolve(experiment, *simulator, archive, stop,
           Observer{.generation_done = [&](std::int64_t, const Summary& summary) { stop = summary.generation == 1; }});
    const ArchivedIndividual best = archive.known_individual(archive.best(1).front());
    archive.add_verifications({{best.id, best.result.objectives[0], {{"again", Status::ok, "", 0.3}}}});
    archive.set_signal({{"champion", "score", "record", "value", 0.3, {}, {}, 1}}, 1);
    for (const std::uint32_t id : archive.best(12))
      if (const auto lives = archive.lives(id); !lives.empty() && !lives[0].empty()) recorded_ = id;
  }

  /// Returns the message with which a command refuses the run, or an empty text if the command succeeds. If the command
  /// ends in any other way, the test fails.
  std::string refusal(const std::function<void()>& command) const {
    ::testing::internal::CaptureStdout();
    ::testing::internal::CaptureStderr();
    std::string said;
    try {
      command();
    } catch (const InputError& error) {
      said = error.what();
    } catch (const std::exception& error) {
      ADD_FAILURE() << "neither taken nor refused: " << error.what();
    }
    std::fflush(stdout);
    ::testing::internal::GetCapturedStdout();
    ::testing::internal::GetCapturedStderr();
    EXPECT_THAT(said, ::testing::AnyOf("", AllOf(HasSubstr(folder_.string()), Not(HasSubstr("\n")))));
    return said;
  }

  std::string refusal_by(const char* command, std::vector<std::string> words = {}) const {
    words.insert(words.begin(), folder_.string());
    return refusal([&] { call(command_named(command), words); });
  }

  /// Calls all commands with the folder; returns how many refuse it.
  int refusals() const {
    const auto report = [&] {
      const Archive archive = Archive::read(folder_);
      const Experiment experiment = experiment_for_resimulation(archive, {});
      reported_run(archive, experiment, *make_simulator(experiment), {.best = 1, .ancestors = 1}, 1'000'000);
    };
    const std::string recorded = std::to_string(recorded_);
    int refused = 0;
    for (const auto& [command, words] : std::vector<std::pair<const char*, std::vector<std::string>>>{
             {"show", {}},
             {"show", {"--json"}},
             {"life", {"--individual", recorded}},
             {"life", {"--json"}},
             {"body", {"--matured", "--individual", recorded}},
             {"body", {}}})
      refused += !refusal_by(command, words).empty();
    refused += !refusal(report).empty();
    return refused + !refusal_by("resume").empty();
  }

  void renew() const {
    fs::remove_all(folder_);
    fs::create_directory(folder_);
    fs::copy_file(original_ / "run.sqlite", folder_ / "run.sqlite");
  }
  SQLite::Database database() const { return {(folder_ / "run.sqlite").string(), SQLite::OPEN_READWRITE}; }

  /// Changes a copy of the run; returns false if the constraints of the tables do not allow the change.
  bool change(const std::string& sql) const {
    renew();
    try {
      database().exec(sql);
      return true;
    } catch (const SQLite::Exception&) {
      return false;
    }
  }

  testing::Scratch scratch_;
  fs::path original_ = scratch_ / "original", folder_ = scratch_ / "a foreign run";
  std::uint32_t recorded_ = 0;  ///< an individual whose life is recorded
};

TEST_F(ForeignRecord, AnUntouchedOneIsTaken) {
  renew();
  EXPECT_EQ(refusals(), 0);
  EXPECT_EQ(Archive::read(folder_).generations().size(), 3u) << "resumed";
  EXPECT_FALSE(Archive::read(folder_).lives(recorded_).at(0).empty());
}

class ForeignTable : public ForeignRecord, public ::testing::WithParamInterface<const char*> {};

TEST_P(ForeignTable, MayHoldAnything) {
  const std::string table = GetParam();
  EXPECT_TRUE(change("DELETE FROM " + table));
  refusals();
  std::vector<std::string> columns;
  {
    SQLite::Database database(this->database());
    SQLite::Statement row(database, "SELECT name FROM pragma_table_info('" + table + "')");
    while (row.executeStep()) columns.push_back(row.getColumn(0).getString());
  }
  int taken = 0, changes = 0;
  for (const std::string& column : columns)
    for (const char* value : {"NULL", "-1", "3", "9000000000000000000", "1e308", "-9e999",
                              "'two' || char(10) || 'lines'", "x''", "x'80'", "zeroblob(4000)"}) {
      SCOPED_TRACE(column + " = " + value);
      // changes all rows or, if that would violate uniqueness, one row
      const std::string update = "UPDATE " + table + " SET " + column + " = " + value;
      if (!change(update) &&
          !change(update + " WHERE " + columns.front() + " = (SELECT max(" + columns.front() + ") FROM " + table + ")"))
        continue;
      ++changes;
      taken += refusals() == 0;
    }
  EXPECT_GT(changes, 2 * static_cast<int>(columns.size()));
  EXPECT_LT(taken, changes) << "all is taken, whatever it is";
}

INSTANTIATE_TEST_SUITE_P(Tables, ForeignTable,
                         ::testing::Values("record", "provenances", "operators", "objectives", "sections",
                                           "block_types", "gene_types", "gene_options", "first_blocks", "individuals",
                                           "scores", "lives", "generations", "verifications"),
                         [](const auto& instance) { return std::string(instance.param); });

TEST_F(ForeignRecord, WhatDoesNotFitTogetherIsNamed) {
  const struct {
    const char *change, *named;
  } cases[] = {
      {"UPDATE individuals SET parent = id", "individuals.parent"},
      {"UPDATE individuals SET genes = x'00000000'", "1 genes"},
      {"UPDATE individuals SET genes = replace(hex(zeroblob(length(genes) / 4)), '00', '0000c07f')",
       "individuals.genes"},
      {"DELETE FROM individuals", "0 individuals"},
      {"DELETE FROM scores", "scores"},
      {"DELETE FROM provenances", "provenance"},
      {"DELETE FROM objectives", "objectives"},
      {"UPDATE objectives SET maximise = 1 - maximise", "objective 0"},
      {"DELETE FROM objectives WHERE position = 1", "objective 1 is none"},
      {"INSERT INTO objectives SELECT 2, 'taste', '1', maximise FROM objectives WHERE position = 1",
       "operators measure none"},
      {"UPDATE generations SET evaluations = 3 WHERE generation = 1", "generations.evaluations"},
      {"UPDATE individuals SET provenance = 7", "individuals.provenance"},
      {"UPDATE individuals SET origin = born + 1", "individuals.origin"},
      {"INSERT INTO memory VALUES('survivors', 'ids', 0, 1, x'00')", "memory.generation"},
      {"INSERT INTO memory SELECT 'children', 'ids', max(generation), 1, x'' FROM generations", "memory.role"},
      {"INSERT INTO memory SELECT 'survivors', 'ids', max(generation), -1, x'' FROM generations", "memory.version"},
      {"INSERT INTO memory SELECT 'survivors', value, max(generation), value, x'' FROM generations, (SELECT 1 AS value "
       "UNION SELECT 2) GROUP BY value",
       "memory.version"},
      {"INSERT INTO memory SELECT 'survivors', 'ids', max(generation), 1, x'00' FROM generations", "memory.numbers"},
      {"INSERT INTO memory SELECT 'survivors', 'ids', max(generation), 1, x'000000000000f07f' FROM generations",
       "memory.numbers"},
      {"INSERT INTO memory SELECT 'parents', 'ids', max(generation), 1, x'' FROM generations", "[selection.parents]"},
      {"INSERT INTO record VALUES('journal', 'of travels')", "\"of travels\""},
      {"INSERT INTO record VALUES('seconds', 'many')", "\"seconds\""},
      {"INSERT INTO note_titles VALUES(0, 'novelty', 'm', 0)", "novelty in m"},
      {"INSERT INTO notes VALUES(999, 0, 0, 1)", "notes.individual"},
      {"INSERT INTO measured SELECT id, 0, 1 FROM individuals WHERE died IS NULL", "1 measures"},
      {"INSERT INTO measured SELECT id, 1, 1 FROM individuals WHERE died IS NULL", "measured.measure"},
      {"UPDATE scores SET objective = 7 WHERE objective = 1", "scores.objective"},
      {"UPDATE objectives SET position = 7 WHERE position = 1", "objectives.position"},
      {"UPDATE provenances SET provenance = 7", "provenances.provenance"},
      {"UPDATE individuals SET lives = 2 WHERE died IS NULL", "has had 2 lives"},
      {"UPDATE individuals SET lives = 0", "individuals.lives"},
      {"UPDATE individuals SET measured = 99", "individuals.measured"},
      {"INSERT INTO life_scores SELECT id, 1, 0, 1 FROM individuals WHERE died IS NULL", "incomplete"},
      {"INSERT INTO life_scores SELECT id, 2, 0, 1 FROM individuals WHERE died IS NULL", "life_scores.life"},
      {"INSERT INTO lives SELECT individual, 2, record FROM lives", "records of 2 lives"},
      {"INSERT INTO lives SELECT individual, 3, record FROM lives", "lives.life"},
  };
  ASSERT_TRUE(change("DELETE FROM provenances; DELETE FROM verifications"));
  EXPECT_THAT(refusal_by("show", {"--json"}), HasSubstr("provenances"));
  ASSERT_TRUE(change("DELETE FROM scores; INSERT INTO measures VALUES(0, 'taste', '1', 'flavour', NULL, NULL, NULL)"));
  EXPECT_THAT(refusal_by("show", {"--json"}), testing::naming("measures.role", "\"flavour\"", "\"descriptor\""));
  for (const auto& [sql, named] : cases) {
    ASSERT_TRUE(change(sql)) << sql;
    EXPECT_THAT(refusal_by("resume"), HasSubstr(named)) << sql;
  }
}

TEST_F(ForeignRecord, GenesThatAreNoNumbersBlameNoOperator) {
  ASSERT_TRUE(change(
      "UPDATE individuals SET genes = CAST(replace(hex(zeroblob(length(genes) / 4)), '00', x'ffffffff') AS BLOB)"));
  for (const char* command : {"resume", "body"}) EXPECT_THAT(refusal_by(command), HasSubstr("gene 0 = "));
}

/// Returns bytes with up to `changes` others, or with the end cut off.
std::string damaged(std::string bytes, unsigned changes, bool is_cut, std::mt19937& random) {
  for (unsigned j = 0; j <= random() % changes; ++j) bytes[random() % bytes.size()] = static_cast<char>(random());
  if (is_cut) bytes.resize(random() % bytes.size());
  return bytes;
}

TEST_F(ForeignRecord, RecordsOfLivesMayHoldAnyBytes) {
  const std::string bytes = Archive::read(original_).lives(recorded_).at(0).bytes();
  std::mt19937 random(5);
  int taken = 0, refused = 0;
  for (int i = 0; i < 150; ++i) {
    const std::string other = damaged(bytes, 3, i % 10 == 0, random);
    renew();
    {
      SQLite::Database database(this->database());
      SQLite::Statement update(database, "UPDATE lives SET record = ? WHERE individual = ?");
      update.bind(1, other.data(), static_cast<int>(other.size()));
      update.bind(2, recorded_);
      update.exec();
    }
    const std::string said = refusal_by("life", {"--json", "--individual", std::to_string(recorded_)});
    ++(said.empty() ? taken : refused);
  }
  EXPECT_GT(taken, 0);
  EXPECT_GT(refused, 30);
}

TEST_F(ForeignRecord, TheFileMayHoldAnyBytes) {
  const std::string bytes = testing::content_of(original_ / "run.sqlite");
  std::mt19937 random(7);
  for (int i = 0; i < 150; ++i) {
    renew();
    std::ofstream(folder_ / "run.sqlite", std::ios::binary) << damaged(bytes, 20, i % 10 == 0, random);
    refusal_by("show");
    refusal_by("life");
  }
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
