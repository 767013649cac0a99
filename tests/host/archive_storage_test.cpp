// The file of a run when other processes use it and when storage fails: no data is lost, no process waits for ever, and
// every error message names the folder.
#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/stat.h>

#include <chrono>
#include <fstream>
#include <functional>
#include <thread>

#include "evolution/archive/archive.hpp"
#include "evolution/archive/database.hpp"
#include "support/archives.hpp"
#include "support/experiments.hpp"
#include "support/messages.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

class ArchiveStorage : public ::testing::Test {
 protected:
  template <class Refusal>
  static std::string refusal(const std::function<void()>& call) {
    try {
      call();
    } catch (const Refusal& error) {
      return error.what();
    }
    return "no refusal";
  }

  Archive created(std::optional<Journal> journal = std::nullopt) {
    return Archive::create(folder_, experiment_, "cpu", journal);
  }

  std::size_t generations() const { return Archive::read(folder_).generations().size(); }

  testing::Scratch scratch_;
  fs::path folder_ = scratch_ / "a run (ü)";
  fs::path file_ = folder_ / "run.sqlite", log_ = folder_ / "run.sqlite-wal";
  Experiment experiment_ = testing::read(testing::small_experiment);
};

/// Copies only the file itself, without its journal.
TEST_F(ArchiveStorage, TheFileAloneFollowsTheRun) {
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
    testing::commit_one(archive, generation++);
  } while (generations_alone() == 0 && std::chrono::steady_clock::now() < give_up);
  EXPECT_GT(generations_alone(), 0u) << "and while it goes on";
}

/// An accident that happens to a file while a run has it open.
struct Loss {
  const char* name;
  std::function<void(const fs::path& folder)> happen;
};

class LostFile : public ArchiveStorage, public ::testing::WithParamInterface<Loss> {};

TEST_P(LostFile, EndsTheRunAtTheNextCommit) {
  for (const Journal journal : {Journal::wal, Journal::rollback}) {
    if (journal == Journal::rollback && std::string(GetParam().name) == "LogRemoved") continue;
    SCOPED_TRACE(name(journal));
    Archive archive = created(journal);
    testing::commit_one(archive, 0);
    GetParam().happen(folder_);
    EXPECT_THAT(refusal<StorageError>([&] { testing::commit_one(archive, 1); }),
                testing::at_place(folder_.string() + ": run.sqlite", "removed", "moved", "replaced", " resume"));
    EXPECT_FALSE(archive.is_in_place());
    for (const char* end : {"", " elsewhere"}) fs::remove_all(folder_.string() + end);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Storage, LostFile,
    ::testing::Values(Loss{"FolderRemoved", [](const fs::path& folder) { fs::remove_all(folder); }},
                      Loss{"FileRemoved", [](const fs::path& folder) { fs::remove(folder / "run.sqlite"); }},
                      Loss{"LogRemoved", [](const fs::path& folder) { fs::remove(folder / "run.sqlite-wal"); }},
                      Loss{"FolderMoved",
                           [](const fs::path& folder) { fs::rename(folder, folder.string() + " elsewhere"); }},
                      Loss{"FileReplaced",
                           [](const fs::path& folder) {
                             fs::copy_file(folder / "run.sqlite", folder / "copy");
                             fs::rename(folder / "copy", folder / "run.sqlite");
                           }}),
    [](const auto& instance) { return instance.param.name; });

TEST_F(ArchiveStorage, AReaderKeepsNobodyFromGoingOn) {
  for (const Journal journal : {Journal::wal, Journal::rollback}) {
    SCOPED_TRACE(name(journal));
    { created(journal); }
    const Archive before = Archive::read(folder_);  // for example, for a report that takes a long time
    EXPECT_EQ(before.generations().size(), 0u);
    Archive archive = Archive::resume(folder_);
    const Archive beside = Archive::read(folder_);
    EXPECT_EQ(beside.generations().size(), 0u);
    testing::commit_one(archive, 0);
    EXPECT_EQ(before.generations().size() + beside.generations().size(), 0u) << "they read of one moment";
    EXPECT_EQ(generations(), 1u);
    fs::remove_all(folder_);
  }
}

TEST_F(ArchiveStorage, WritersTakeTurns) {
  constexpr std::uint32_t rounds = 200;
  Archive run = created();
  testing::commit_one(run, 0);
  std::string failure = "none";
  std::thread verifier([&] {
    try {
      Archive archive = Archive::annotate(folder_);
      for (std::uint32_t i = 0; i < rounds; ++i)
        archive.add_verifications({{0, 0.3, {{"trial " + std::to_string(i), Status::ok, "", 0.3}}}});
    } catch (const std::exception& error) {
      failure = error.what();
    }
  });
  for (std::uint32_t generation = 1; generation < rounds; ++generation) testing::commit_one(run, generation);
  verifier.join();
  EXPECT_EQ(failure, "none");
  EXPECT_EQ(generations(), rounds);
  EXPECT_EQ(Archive::read(folder_).verification(0)->trials.size(), rounds);
}

TEST_F(ArchiveStorage, AnInterruptedCommitIsUndoneByWhoReads) {
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
class WithoutSharedMemory : public ArchiveStorage {
 protected:
  WithoutSharedMemory() { sqlite3_vfs_register(sqlite3_vfs_find("unix-dotfile"), 1); }
  ~WithoutSharedMemory() override { sqlite3_vfs_register(sqlite3_vfs_find("unix"), 1); }
};

TEST_F(WithoutSharedMemory, ARunKeepsAnotherJournal) {
  {
    Archive archive = created();
    testing::commit_one(archive, 0);
    EXPECT_FALSE(fs::exists(log_));
  }
  {
    Archive archive = Archive::resume(folder_);
    testing::commit_one(archive, 1);
  }
  EXPECT_EQ(generations(), 2u);
}

TEST_F(WithoutSharedMemory, AWishForALogIsRefusedWithTheRemedy) {
  EXPECT_THAT(refusal<ArchiveError>([&] { created(Journal::wal); }),
              AllOf(StartsWith(folder_.string()), HasSubstr("--journal wal"), HasSubstr("--journal delete")));
}

TEST_F(WithoutSharedMemory, ARunWithALogGoesOnByAnotherJournal) {
  const fs::path killed = scratch_ / "killed";
  fs::create_directory(killed);
  {
    sqlite3_vfs_register(sqlite3_vfs_find("unix"), 1);
    Archive archive = created(Journal::wal);
    testing::commit_one(archive, 0);
    fs::copy_file(file_, killed / "run.sqlite");
    fs::copy_file(log_, killed / "run.sqlite-wal");
  }
  sqlite3_vfs_register(sqlite3_vfs_find("unix-dotfile"), 1);
  EXPECT_THAT(refusal<ArchiveError>([&] { Archive::read(killed); }),
              AllOf(StartsWith(killed.string()), HasSubstr("--journal delete")));
  Archive archive = Archive::resume(killed, Journal::rollback);
  testing::commit_one(archive, 1);
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

TEST_F(ArchiveStorage, ALogLocksNobodyOutWhereItIsNotTheDefault) {
  { created(Journal::wal); }
  RunDatabase run(folder_, SQLite::OPEN_READWRITE, std::nullopt);
  run.prepare_for_rollback();  // as where the folder's file system has no shared memory
  run.execute("UPDATE record SET value = '8' WHERE key = 'seed'");
  run.set_journal(Journal::wal);
  run.execute("UPDATE record SET value = '9' WHERE key = 'seed'");
  EXPECT_TRUE(fs::exists(log_));
  EXPECT_EQ(Archive::read(folder_).record("seed"), "9");
}

TEST_F(ArchiveStorage, AWishForAJournalIsRemembered) {
  { created(Journal::rollback); }
  Archive archive = Archive::resume(folder_);
  testing::commit_one(archive, 0);
  EXPECT_FALSE(fs::exists(log_));
}

TEST_F(ArchiveStorage, EveryErrorOfSQLiteNamesTheFolderAndARemedy) {
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
TEST_F(ArchiveStorage, ARunThatStoredNothingCanBeBegunAgain) {
  for (const Journal journal : {Journal::wal, Journal::rollback}) {
    SCOPED_TRACE(name(journal));
    fs::create_directories(folder_);
    for (const char* left : {"lock", "run.sqlite", "run.sqlite-journal", "run.sqlite-wal"})
      std::ofstream(folder_ / left) << "";
    EXPECT_FALSE(is_begun(folder_));
    Archive archive = created(journal);
    EXPECT_TRUE(is_begun(folder_));
    testing::commit_one(archive, 0);
    EXPECT_EQ(generations(), 1u);
    fs::remove_all(folder_);
  }
}

TEST_F(ArchiveStorage, WhatMayHoldGenerationsIsNotBegunAgain) {
  const auto refused = [&] {
    EXPECT_THAT(refusal<ArchiveError>([&] { created(); }), testing::at_place(folder_.string() + ": ", "--out"));
  };
  { created(); }
  refused();
  fs::rename(file_, log_);  // a log whose file is gone
  refused();
  std::ofstream(file_) << std::string(5000, 'x');
  refused();
  fs::remove(file_);
  fs::create_directory(file_);
  refused();
}

TEST_F(ArchiveStorage, WhatIsNoRunIsRefusedWithTheFolder) {
  const auto refused = [&] {
    std::vector<std::string> said;
    for (const auto open : {&Archive::read, &Archive::annotate})
      said.push_back(refusal<ArchiveError>([&] { (*open)(folder_); }));
    said.push_back(refusal<ArchiveError>([&] { Archive::resume(folder_); }));
    return said;
  };
  fs::create_directories(folder_);
  ASSERT_EQ(mkfifo(file_.c_str(), 0600), 0);
  for (const std::string& said : refused())
    EXPECT_THAT(said, testing::at_place(folder_.string() + ": ", "no run", "`evodevo run`"));
  fs::remove(file_);
  fs::create_directory(file_);
  for (const std::string& said : refused())
    EXPECT_THAT(said, testing::at_place(folder_.string() + ": ", "no run", "`evodevo run`"));
  fs::remove(file_);
  std::ofstream(file_) << std::string(5000, 'x');
  for (const std::string& said : refused())
    EXPECT_THAT(said, testing::at_place(folder_.string() + ": run.sqlite ", "SQLite database"));
  fs::remove(file_);
  SQLite::Database(file_.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE).exec("CREATE TABLE mine(a)");
  for (const std::string& said : refused()) EXPECT_THAT(said, testing::at_place(folder_.string() + ": ", "lacks"));
}

TEST_F(ArchiveStorage, WhatStandsInTheTablesPlaceIsNotRun) {
  const std::string endless = "CREATE VIEW individuals AS WITH RECURSIVE n(i) AS (SELECT 0 UNION ALL SELECT i FROM n) ";
  for (const std::string& change : {"DROP TABLE individuals; " + endless + "SELECT i AS id FROM n",
                                    std::string("ALTER TABLE scores ADD COLUMN more GENERATED ALWAYS AS (value)"),
                                    std::string("ALTER TABLE generations RENAME COLUMN wall_time TO other")}) {
    { created(); }
    SQLite::Database(file_.string(), SQLite::OPEN_READWRITE).exec("DROP VIEW members; " + change);
    EXPECT_THAT(refusal<ArchiveError>([&] { Archive::read(folder_); }),
                AllOf(StartsWith(folder_.string()), HasSubstr("run.sqlite")))
        << change;
    fs::remove_all(folder_);
  }
  { created(); }
  SQLite::Database(file_.string(), SQLite::OPEN_READWRITE)
      .exec("CREATE TRIGGER spoil AFTER INSERT ON generations BEGIN DELETE FROM individuals; END");
  {
    Archive archive = Archive::resume(folder_);
    testing::commit_one(archive, 0);
  }
  EXPECT_TRUE(Archive::read(folder_).individual(0).has_value()) << "triggers of others do nothing";
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
