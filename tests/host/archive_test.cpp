// The archive: data that is written can be read again, no process overwrites the data of another, and where other
// processes use it or storage fails, no data is lost, nobody waits for ever, and every error message names the folder.
#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/stat.h>

#include <chrono>
#include <fstream>
#include <functional>
#include <thread>

#include "archive/archive_writer.hpp"
#include "archive/database.hpp"
#include "archive/recorded_experiment.hpp"
#include "archive/schema.hpp"
#include "support/archives.hpp"
#include "support/experiments.hpp"
#include "support/messages.hpp"
#include "support/refusals.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using testing::commit_one;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::refusal;
using ::testing::StartsWith;

class ArchiveTest : public ::testing::Test {
 protected:
  Archive created(std::optional<Journal> journal = std::nullopt) {
    return Archive::create(folder_, experiment_, "a device", journal);
  }

  std::size_t generations() const { return Archive::read(folder_).generations().size(); }

  testing::Scratch scratch_;
  fs::path folder_ = scratch_ / "a run (ü)";
  fs::path file_ = folder_ / "run.sqlite", log_ = folder_ / "run.sqlite-wal";
  Experiment experiment_ = testing::small();
};

TEST_F(ArchiveTest, GivesBackWhatWasCommitted) {
  const Individual ok{.id = 4,
                      .born = 2,
                      .origin = 1,
                      .parents = {1, 3},
                      .made_by = "two-point",
                      .genome = {0.25f, 3},
                      .result = {.objectives = {0.1 + 0.2, -1e-300}, .spring_evaluations = 12345678901},
                      .measured = 2};
  Individual diverged = ok;
  diverged.id = 5;
  diverged.parents = {};
  diverged.result = {Status::diverged, "non-finite", 1.5, {}, 7};
  const Summary summary{.generation = 2, .evaluations = 6, .best = 0.3, .clones = 2};
  {
    Archive archive = created();
    for (std::uint32_t generation = 0; generation < 2; ++generation)
      archive.commit({.summary = {.generation = generation, .evaluations = 2 + generation}});
    archive.commit({.newborns = {ok, diverged}, .dropped = {5}, .summary = summary});
  }
  const Archive archive = Archive::read(folder_);
  EXPECT_EQ(archive.record("seed"), "7");
  EXPECT_EQ(archive.provenances().front().device, "a device");
  EXPECT_EQ(recorded_experiment(archive).resolved, experiment_.resolved);
  ASSERT_EQ(archive.population().size(), 1u);
  const Individual back = archive.population().front();
  EXPECT_EQ(std::tie(back.id, back.born, back.origin, back.parents, back.made_by),
            std::tie(ok.id, ok.born, ok.origin, ok.parents, ok.made_by));
  EXPECT_EQ(back.genome, ok.genome);
  EXPECT_EQ(back.result.objectives, ok.result.objectives) << "to the last bit";
  EXPECT_EQ(back.result.spring_evaluations, ok.result.spring_evaluations);
  const ArchivedIndividual dead = archive.individual(5).value();
  EXPECT_EQ(std::tie(dead.died, dead.result.status, dead.result.reason, dead.result.ended_at),
            std::tuple(2u, Status::diverged, "non-finite", 1.5));
  EXPECT_TRUE(dead.result.objectives.empty());
  EXPECT_FALSE(archive.individual(6).has_value());
  ASSERT_EQ(archive.generations().size(), 3u);
  EXPECT_EQ(archive.generations()[2].best, 0.3);
  EXPECT_FALSE(archive.generations()[2].median.has_value());
  EXPECT_EQ(archive.generations()[2].clones, 2);
  EXPECT_EQ(archive.best(9), std::vector<std::uint32_t>{4}) << "the diverged one has no place among the best";
  EXPECT_EQ(archive.statuses().at("diverged"), 1);
}

TEST_F(ArchiveTest, TheRefusedLoseTheirScoresWhenTheirGenerationIsCommitted) {
  const Individual elder{.made_by = "random", .genome = {0.25f, 3}, .result = {.objectives = {0.4, 1}}};
  const Individual newborn{.id = 1,
                           .born = 1,
                           .origin = 1,
                           .made_by = "random",
                           .genome = {0.25f, 3},
                           .result = {.objectives = {0.3, 2}},
                           .measured = 1};
  const std::vector<Refusal> refusals{{1, Status::artefact, "quarter-step ends as diverged"},
                                      {0, Status::passive, "no-muscles gives 0.39"}};
  const Verification of_elder{0, 0.4, {{"again", Status::ok, "", 0.4}}};
  {
    Archive archive = created();
    archive.commit({.newborns = {elder}, .summary = {.generation = 0, .evaluations = 1}});
    Archive::annotate(folder_).add_verifications({{0, 0.5, of_elder.trials}});
    EXPECT_FALSE(archive.verification(0).has_value()) << "that was another fitness";
    Archive::annotate(folder_).add_verifications({of_elder});
    EXPECT_TRUE(archive.verification(0).has_value());
    archive.commit({.newborns = {newborn},
                    .summary = {.generation = 1, .evaluations = 2, .artefact = 1, .passive = 1},
                    .refusals = refusals});
    Archive::annotate(folder_).add_verifications({of_elder});  // of a process that chose it before
  }
  const Archive archive = Archive::read(folder_);
  for (const Refusal& refusal : refusals) {
    EXPECT_EQ(archive.individual(refusal.individual)->result.status, refusal.status);
    EXPECT_EQ(archive.individual(refusal.individual)->result.reason, refusal.reason);
  }
  EXPECT_TRUE(archive.best(9).empty());
  EXPECT_FALSE(archive.verification(0).has_value());
  EXPECT_EQ(archive.population().size(), 2u) << "selection alone drops";
  EXPECT_EQ(archive.generations()[1].artefact, 1);
  EXPECT_EQ(archive.generations()[1].passive, 1);
  EXPECT_EQ(archive.statuses().at("artefact"), 1);
  EXPECT_EQ(archive.statuses().at("passive"), 1);
}

/// A generation of so many individuals that writing it takes a while.
FinishedGeneration large_generation(std::uint32_t generation) {
  constexpr std::uint32_t size = 20'000;
  FinishedGeneration large;
  for (std::uint32_t i = 0; i < size; ++i) {
    Individual& one = large.newborns.emplace_back();
    one.id = generation * size + i;
    one.born = one.origin = one.measured = generation;
    one.genome = {static_cast<float>(i), 1};
    one.result.objectives = {static_cast<double>(one.id), 1};
  }
  large.summary = {.generation = generation, .evaluations = (generation + 1) * size, .wall_time = 0.01};
  return large;
}

TEST_F(ArchiveTest, AWriterHasWrittenAllAfterItsWait) {
  Archive archive = created();
  {
    ArchiveWriter writer(archive);
    writer.begin(large_generation(0));
    EXPECT_EQ(Archive::read(folder_).generations().size(), 1u) << "it cannot know yet how long writing takes";
    for (const std::uint32_t generation : {1, 2}) writer.begin(large_generation(generation));
    writer.wait();
    EXPECT_GT(writer.seconds(), 0);
    EXPECT_EQ(archive.generations().size(), 3u);
    EXPECT_EQ(archive.individual(59'999)->result.objectives.front(), 59'999);
    writer.begin(large_generation(3));
  }
  EXPECT_EQ(Archive::read(folder_).generations().size(), 4u) << "the destructor waits";
}

TEST_F(ArchiveTest, AWriterThrowsWhatGoesWrong) {
  Archive archive = created();
  ArchiveWriter writer(archive);
  writer.begin(large_generation(0));
  const std::string said = refusal<ArchiveError>([&] {
    writer.begin(large_generation(0));
    writer.wait();
  });
  EXPECT_NE(said, "no refusal");
  EXPECT_EQ(archive.generations().size(), 1u);
}

TEST_F(ArchiveTest, TellsWhatEvaluatedAnIndividual) {
  const Provenance first = this_provenance(experiment_, "a device");
  Provenance elsewhere = first, rebuilt = first, other_operator = first, moved = first;
  elsewhere.device = "another";
  rebuilt.program = "another";
  other_operator.operators.back().hash = "another";
  moved.operators.front().file = "another";
  const std::vector<Provenance> expected{first, elsewhere, rebuilt, other_operator, moved, elsewhere};
  for (std::uint32_t id = 0; id < 6; ++id) {
    Archive archive = id == 0 ? created() : Archive::resume(folder_);
    commit_one(archive, id, archive.add_provenance(expected[id]));
  }
  const Archive archive = Archive::read(folder_);
  ASSERT_EQ(archive.provenances().size(), 4u) << "who comes again, and operators from another place, are nobody new";
  for (std::uint32_t id = 0; id < 6; ++id) {
    const Provenance provenance = archive.provenances().at(archive.individual(id).value().provenance);
    EXPECT_TRUE(are_same(provenance, expected[id])) << id;
    ASSERT_EQ(provenance.operators.size(), experiment_.uses.size()) << id;
    EXPECT_EQ(provenance.operators.back().version, experiment_.uses.back().version);
  }
  EXPECT_THAT(archive.evaluated_by_provenance(), ::testing::ElementsAre(2, 2, 1, 1));
}

TEST_F(ArchiveTest, TakesVerificationsWhileAnotherWrites) {
  Archive writer = created();
  commit_one(writer, 0);
  EXPECT_FALSE(Archive::read(folder_).verification(0).has_value());
  Archive::annotate(folder_).add_verifications({{0, 0.3, {{"again", Status::ok, "", 7}}}});
  const std::vector<Trial> trials{{"settled", Status::diverged, "too wild", std::nullopt},
                                  {"again", Status::ok, "", 0.1 + 0.2}};
  Archive::annotate(folder_).add_verifications({{0, 0.3, trials}});
  const Verification back = Archive::read(folder_).verification(0).value();
  EXPECT_EQ(back.individual, 0u);
  EXPECT_EQ(back.fitness, 0.3);
  ASSERT_EQ(back.trials.size(), 2u) << "the later one took the place of the first";
  EXPECT_EQ(back.trials[0].name, "settled");
  EXPECT_EQ(back.trials[0].status, Status::diverged);
  EXPECT_EQ(back.trials[0].reason, "too wild");
  EXPECT_FALSE(back.trials[0].value.has_value());
  EXPECT_EQ(back.trials[1].value, 0.1 + 0.2);
}

TEST_F(ArchiveTest, NeverWritesOverARunOrOtherThings) {
  const auto expect_refused = [&] {
    EXPECT_THAT(refusal<ArchiveError>([&] { created(); }),
                testing::at_place(folder_.string() + ": ", "not empty", "--out",
                                  "`evodevo resume '" + folder_.string() + "'`"));
  };
  { created(); }
  expect_refused();
  fs::rename(file_, log_);  // a log whose file is gone
  expect_refused();
  std::ofstream(file_) << std::string(5000, 'x');
  expect_refused();
  fs::remove(file_);
  fs::create_directory(file_);
  expect_refused();
  fs::remove_all(folder_);
  fs::create_directories(folder_);
  std::ofstream(folder_ / "thesis.txt") << "years of work";
  expect_refused();
  EXPECT_EQ(fs::file_size(folder_ / "thesis.txt"), 13u);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1) << "nothing was added";
}

TEST_F(ArchiveTest, SaysWhyARunCannotBeOpened) {
  const std::string place = folder_.string() + ": ";
  const auto expect_refused = [&](const auto& message) {
    EXPECT_THAT(refusal<ArchiveError>([&] { Archive::read(folder_); }), message);
    EXPECT_THAT(refusal<ArchiveError>([&] { Archive::annotate(folder_); }), message);
    EXPECT_THAT(refusal<ArchiveError>([&] { Archive::resume(folder_); }), message);
    fs::remove(file_);
  };
  const auto no_run = testing::at_place(place, "no run.sqlite", "`evodevo run`");
  expect_refused(no_run);
  EXPECT_FALSE(fs::exists(folder_)) << "looking leaves nothing behind";

  fs::create_directories(folder_);
  std::ofstream(file_).close();  // the file that is left if the first transaction was not committed
  EXPECT_THAT(refusal<ArchiveError>([&] { Archive::resume(folder_); }),
              AllOf(testing::at_place(folder_.string(), "run.sqlite-wal", "another folder"), Not(HasSubstr("remove"))))
      << "it advises nothing that destroys";
  fs::remove_all(folder_);
  fs::create_directories(folder_);
  ASSERT_EQ(mkfifo(file_.c_str(), 0600), 0);
  expect_refused(no_run);
  fs::create_directory(file_);
  expect_refused(no_run);
  std::ofstream(file_) << std::string(5000, 'x');
  expect_refused(testing::at_place(place + "run.sqlite ", "SQLite database"));
  SQLite::Database(file_.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE).exec("CREATE TABLE mine(a)");
  expect_refused(testing::at_place(place, "lacks"));
  fs::remove_all(folder_);

  { created().set_record("format", "99"); }
  EXPECT_THAT(refusal<ArchiveError>([&] { Archive::read(folder_); }),
              testing::at_place(place, "format 99", std::string("format ") + archive_format, "0.1.0"));
}

/// Copies only the file itself, without its journal.
TEST_F(ArchiveTest, TheFileAloneFollowsTheRun) {
  const fs::path copy = scratch_ / "copy";
  fs::create_directory(copy);
  const auto generations_alone = [&] {
    fs::copy_file(file_, copy / "run.sqlite", fs::copy_options::overwrite_existing);
    return Archive::read(copy).generations().size();
  };
  Archive archive = created();
  EXPECT_EQ(generations_alone(), 0u) << "it is a run from the first moment on";
  std::uint32_t generation = 0;
  const auto give_up = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  do {
    commit_one(archive, generation++);
  } while (generations_alone() == 0 && std::chrono::steady_clock::now() < give_up);
  EXPECT_GT(generations_alone(), 0u) << "and while it goes on";
}

/// Accidents that happen to a file while a run has it open.
TEST_F(ArchiveTest, ALostFileEndsTheRunAtTheNextCommit) {
  const std::pair<const char*, std::function<void()>> accidents[] = {
      {"the folder is removed", [&] { fs::remove_all(folder_); }},
      {"the folder is moved", [&] { fs::rename(folder_, folder_.string() + " elsewhere"); }},
      {"the file is removed", [&] { fs::remove(file_); }},
      {"the file is replaced",
       [&] {
         fs::copy_file(file_, folder_ / "copy");
         fs::rename(folder_ / "copy", file_);
       }},
      {"the log is removed", [&] { fs::remove(log_); }}};
  for (const auto& [accident, happen] : accidents)
    for (const Journal journal : {Journal::wal, Journal::rollback}) {
      if (journal == Journal::rollback && std::string_view(accident) == "the log is removed") continue;
      SCOPED_TRACE(std::string(accident) + " with the journal " + name(journal));
      Archive archive = created(journal);
      commit_one(archive, 0);
      happen();
      EXPECT_THAT(refusal<StorageError>([&] { commit_one(archive, 1); }),
                  testing::at_place(folder_.string() + ": run.sqlite", "removed", "moved", "replaced", " resume"));
      EXPECT_FALSE(archive.is_in_place());
      for (const char* end : {"", " elsewhere"}) fs::remove_all(folder_.string() + end);
    }
}

TEST_F(ArchiveTest, AReaderKeepsNobodyFromGoingOn) {
  for (const Journal journal : {Journal::wal, Journal::rollback}) {
    SCOPED_TRACE(name(journal));
    { created(journal); }
    const Archive before = Archive::read(folder_);  // for example, for a report that takes a long time
    EXPECT_EQ(before.generations().size(), 0u);
    Archive archive = Archive::resume(folder_);
    const Archive beside = Archive::read(folder_);
    EXPECT_EQ(beside.generations().size(), 0u);
    commit_one(archive, 0);
    EXPECT_EQ(before.generations().size() + beside.generations().size(), 0u) << "they read of one moment";
    EXPECT_EQ(generations(), 1u);
    fs::remove_all(folder_);
  }
}

TEST_F(ArchiveTest, WritersTakeTurns) {
  constexpr std::uint32_t rounds = 200;
  Archive run = created();
  commit_one(run, 0);
  std::string failure;
  std::thread verifier([&] {
    failure = refusal<std::exception>([&] {
      Archive archive = Archive::annotate(folder_);
      for (std::uint32_t i = 0; i < rounds; ++i)
        archive.add_verifications({{0, 0.3, {{"trial " + std::to_string(i), Status::ok, "", 0.3}}}});
    });
  });
  for (std::uint32_t generation = 1; generation < rounds; ++generation) commit_one(run, generation);
  verifier.join();
  EXPECT_EQ(failure, "no refusal");
  EXPECT_EQ(generations(), rounds);
  EXPECT_EQ(Archive::read(folder_).verification(0)->trials.size(), rounds);
}

TEST_F(ArchiveTest, AnInterruptedCommitIsUndoneByWhoReads) {
  { created(Journal::rollback); }
  // a process that is killed while it writes leaves a journal, and a file with only some of the changed pages
  SQLite::Database other(file_.string(), SQLite::OPEN_READWRITE);
  other.exec("PRAGMA cache_size = 1; PRAGMA cache_spill = 1; BEGIN IMMEDIATE");
  for (int i = 0; i < 2000; ++i) other.exec("INSERT INTO record VALUES('key " + std::to_string(i) + "', 'value')");
  const fs::path killed = scratch_ / "killed";
  fs::create_directory(killed);
  for (const char* name : {"run.sqlite", "run.sqlite-journal"}) fs::copy_file(folder_ / name, killed / name);
  const Archive archive = Archive::read(killed);
  EXPECT_EQ(archive.record("seed"), "7");
  EXPECT_FALSE(archive.find_record("key 0").has_value());
}

/// Simulates file systems without memory that processes can share.
class WithoutSharedMemory : public ArchiveTest {
 protected:
  WithoutSharedMemory() { sqlite3_vfs_register(sqlite3_vfs_find("unix-dotfile"), 1); }
  ~WithoutSharedMemory() override { sqlite3_vfs_register(sqlite3_vfs_find("unix"), 1); }
};

TEST_F(WithoutSharedMemory, ARunKeepsAnotherJournal) {
  const fs::path other = scratch_ / "other";
  EXPECT_THAT(refusal<ArchiveError>([&] { Archive::create(other, experiment_, "cpu", Journal::wal); }),
              testing::at_place(other.string(), "--journal wal", "--journal delete"));
  {
    Archive archive = created();
    commit_one(archive, 0);
    EXPECT_FALSE(fs::exists(log_));
  }
  {
    Archive archive = Archive::resume(folder_);
    commit_one(archive, 1);
  }
  EXPECT_EQ(generations(), 2u);
}

TEST_F(WithoutSharedMemory, ARunWithALogGoesOnByAnotherJournal) {
  const fs::path killed = scratch_ / "killed";
  fs::create_directory(killed);
  {
    sqlite3_vfs_register(sqlite3_vfs_find("unix"), 1);
    Archive archive = created(Journal::wal);
    commit_one(archive, 0);
    fs::copy_file(file_, killed / "run.sqlite");
    fs::copy_file(log_, killed / "run.sqlite-wal");
  }
  sqlite3_vfs_register(sqlite3_vfs_find("unix-dotfile"), 1);
  EXPECT_THAT(refusal<ArchiveError>([&] { Archive::read(killed); }),
              testing::at_place(killed.string(), "--journal delete"));
  Archive archive = Archive::resume(killed, Journal::rollback);
  commit_one(archive, 1);
  EXPECT_EQ(archive.generations().size(), 2u);
}

TEST(Journals, AreChosenByTheFileSystem) {
  for (const std::uint32_t remote : {0x6969u, 0xff534d42u, 0xfe534d42u, 0x65735546u, 0x01021997u})
    EXPECT_TRUE(is_remote(remote)) << remote;
  for (const std::uint32_t local : {0xef53u, 0x58465342u, 0x9123683eu, 0x01021994u, 0x794c7630u})
    EXPECT_FALSE(is_remote(local)) << local;
  EXPECT_EQ(journal_for("/proc/self"), Journal::wal);
  EXPECT_EQ(journal_for("/no/such/folder"), Journal::wal);
  EXPECT_EQ(journal_named("wal"), Journal::wal);
  EXPECT_EQ(journal_named("delete"), Journal::rollback);
  EXPECT_FALSE(journal_named("memory").has_value());
}

TEST_F(ArchiveTest, ALogLocksNobodyOutWhereItIsNotTheDefault) {
  { created(Journal::wal); }
  RunDatabase run(folder_, SQLite::OPEN_READWRITE, std::nullopt);
  run.prepare_for_rollback();  // as where the folder's file system has no shared memory
  run.execute("UPDATE record SET value = '8' WHERE key = 'seed'");
  run.set_journal(Journal::wal);
  run.execute("UPDATE record SET value = '9' WHERE key = 'seed'");
  EXPECT_TRUE(fs::exists(log_));
  EXPECT_EQ(Archive::read(folder_).record("seed"), "9");
}

TEST_F(ArchiveTest, AWishForAJournalIsRemembered) {
  { created(Journal::rollback); }
  Archive archive = Archive::resume(folder_);
  commit_one(archive, 0);
  EXPECT_FALSE(fs::exists(log_));
}

TEST_F(ArchiveTest, EveryErrorOfSQLiteNamesTheFolderAndARemedy) {
  int failures = 0;
  for (int code = SQLITE_ERROR; code <= SQLITE_NOTADB; ++code) {
    const auto fail = [&] { throw_as_our_own(SQLite::Exception("what SQLite says", code), folder_); };
    const std::string of_input = refusal<ArchiveError>([&] {
      try {
        fail();
      } catch (const StorageError&) {
      }
    });
    const bool is_failure = of_input == "no refusal";
    failures += is_failure;
    const std::string said = is_failure ? refusal<StorageError>(fail) : of_input;
    EXPECT_THAT(said, AllOf(StartsWith(folder_.string() + ": run.sqlite "), HasSubstr("(what SQLite says); ")));
    EXPECT_THAT(said, AllOf(Not(HasSubstr("\n")), Not(HasSubstr("remove")))) << code;
  }
  EXPECT_EQ(failures, 3) << "a full disk, errors of storage, and memory";
}

/// What a process leaves that is killed while it creates an archive.
TEST_F(ArchiveTest, ARunThatStoredNothingCanBeBegunAgain) {
  for (const Journal journal : {Journal::wal, Journal::rollback}) {
    SCOPED_TRACE(name(journal));
    fs::create_directories(folder_);
    for (const char* left : {"lock", "run.sqlite", "run.sqlite-journal", "run.sqlite-wal"})
      std::ofstream(folder_ / left) << "";
    EXPECT_FALSE(is_begun(folder_));
    Archive archive = created(journal);
    EXPECT_TRUE(is_begun(folder_));
    commit_one(archive, 0);
    EXPECT_EQ(generations(), 1u);
    fs::remove_all(folder_);
  }
}

TEST_F(ArchiveTest, WhatStandsInTheTablesPlaceIsNotRun) {
  const std::string endless = "CREATE VIEW individuals AS WITH RECURSIVE n(i) AS (SELECT 0 UNION ALL SELECT i FROM n) ";
  for (const std::string& change : {"DROP TABLE individuals; " + endless + "SELECT i AS id FROM n",
                                    std::string("ALTER TABLE scores ADD COLUMN more GENERATED ALWAYS AS (value)"),
                                    std::string("ALTER TABLE generations RENAME COLUMN wall_time TO other")}) {
    { created(); }
    SQLite::Database(file_.string(), SQLite::OPEN_READWRITE).exec("DROP VIEW members; " + change);
    EXPECT_THAT(refusal<ArchiveError>([&] { Archive::read(folder_); }),
                testing::at_place(folder_.string(), "run.sqlite"))
        << change;
    fs::remove_all(folder_);
  }
  { created(); }
  SQLite::Database(file_.string(), SQLite::OPEN_READWRITE)
      .exec("CREATE TRIGGER spoil AFTER INSERT ON generations BEGIN DELETE FROM individuals; END");
  {
    Archive archive = Archive::resume(folder_);
    commit_one(archive, 0);
  }
  EXPECT_TRUE(Archive::read(folder_).individual(0).has_value()) << "triggers of others do nothing";
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
