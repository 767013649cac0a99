#include "archive/database.hpp"

#include <SQLiteCpp/Backup.h>
#include <sqlite3.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/text.hpp"

namespace evodevo {
namespace {

namespace fs = std::filesystem;

constexpr int opening_ms = 5'000;   ///< longest wait for other processes when a file is opened, ms
constexpr int writing_ms = 60'000;  ///< longest wait while a run is written, ms; somebody may be copying it
constexpr std::chrono::seconds between_checkpoints{1};
constexpr int most_bytes = 256 << 20;        ///< largest size of a row, bytes; far more than any genome or life needs
constexpr std::size_t most_shown = 40;       ///< largest number of bytes of a text that a message shows
constexpr std::size_t most_of_sqlite = 100;  ///< the same for a SQLite message, which may quote the file

/// What a SQLite error means for the user.
struct Meaning {
  int code;
  bool of_storage;  ///< true: the storage failed; false: the input is wrong
  const char* what;
  const char* remedy;
};

constexpr Meaning meanings[] = {
    {SQLITE_NOTADB, false, "is not a SQLite database", "give a folder that `evodevo run` has written"},
    {SQLITE_CORRUPT, false, "is damaged", "put back an undamaged copy of it"},
    {SQLITE_BUSY, false, "is locked by another process", "wait until it is done, or stop it, and try again"},
    {SQLITE_LOCKED, false, "is locked by another process", "wait until it is done, or stop it, and try again"},
    {SQLITE_READONLY, false, "cannot be written", "make the folder and its files writable, or work on a copy of it"},
    {SQLITE_PERM, false, "may not be opened", "make the folder and its files readable and writable"},
    {SQLITE_CANTOPEN, false, "or a file beside it cannot be opened",
     "make the folder and its files readable and writable; if it lies on another machine, give --journal delete to "
     "`run` or `resume`, or work on a copy"},
    {SQLITE_TOOBIG, false, "has a value of more than 256 MiB, or would get one", "put back an undamaged copy of it"},
    {SQLITE_CONSTRAINT, false, "is inconsistent: new rows contradict those that it has",
     "put back an undamaged copy of it"},
    {SQLITE_FULL, true, "cannot be written: the disk, or that of temporary files, is full",
     "free some space, or set TMPDIR to a folder on a larger disk"},
    {SQLITE_IOERR, true, "cannot be read or written: the storage fails",
     "check that its disk is sound, connected and not full"},
    {SQLITE_NOMEM, true, "needs more memory than is free", "close other programs, then try again"},
};

constexpr Meaning unknown{0, false, "cannot be used", "put back an undamaged copy of it"};

Meaning meaning_of(int code) {
  for (const Meaning& meaning : meanings)
    if (meaning.code == code) return meaning;
  return unknown;
}

std::string database_file(const fs::path& folder) { return (folder / database_name).string(); }

SQLite::Database open(const fs::path& folder, int flags) {
  try {
    return {database_file(folder), flags, opening_ms};
  } catch (const SQLite::Exception& error) {
    throw_as_our_own(error, folder);
  }
}

}  // namespace

void throw_as_our_own(const SQLite::Exception& error, const fs::path& folder) {
  const Meaning meaning = meaning_of(error.getErrorCode() & 0xff);
  const std::string whole = error.what(), line = whole.substr(0, std::min(whole.find('\n'), most_of_sqlite));
  const std::string text =
      folder.string() + ": " + database_name + " " + meaning.what + " (" + line + "); " + meaning.remedy;
  if (meaning.of_storage) throw StorageError(text);
  throw ArchiveError(text);
}

RunDatabase::RunDatabase(fs::path folder, int flags, std::optional<FileLock> lock)
    : folder_(std::move(folder)), lock_(std::move(lock)), database_(open(folder_, flags)) {
  limit();
}

/// Prevents a file from an untrusted source from executing code (triggers, views) and from filling the memory.
void RunDatabase::limit() const {
  sqlite3* const handle = database_.getHandle();
  sqlite3_limit(handle, SQLITE_LIMIT_LENGTH, most_bytes);
  for (const int feature :
       {SQLITE_DBCONFIG_ENABLE_TRIGGER, SQLITE_DBCONFIG_ENABLE_VIEW, SQLITE_DBCONFIG_TRUSTED_SCHEMA})
    sqlite3_db_config(handle, feature, 0, nullptr);
}

RunDatabase::~RunDatabase() {
  if (!lock_) return;
  try {
    database_.setBusyTimeout(0);
    database_.exec("PRAGMA journal_mode = DELETE");
  } catch (const SQLite::Exception&) {
    // another process is reading, or the file is gone
  }
}

void RunDatabase::prepare_for_rollback() {
  execute("PRAGMA locking_mode = EXCLUSIVE");
  is_exclusive_ = true;
}

/// Tries to switch to a write-ahead log. If that does not work in the folder, throws an exception if `must`, and
/// otherwise returns false. In both cases, throws if another process uses the file or the disk is full.
bool RunDatabase::try_wal(bool must) {
  try {
    if (database_.execAndGet("PRAGMA journal_mode = WAL").getString() == "wal") return true;
  } catch (const SQLite::Exception& error) {
    const int code = error.getErrorCode() & 0xff;
    if (must || code == SQLITE_BUSY || code == SQLITE_FULL) throw;
  }
  if (must)
    throw ArchiveError(folder_.string() + ": --journal wal: does not work on its file system; give --journal delete");
  return false;
}

void RunDatabase::set_journal(std::optional<Journal> wish) {
  guarded([&] {
    const auto leave_wal = [&] {
      // in exclusive mode, SQLite needs no shared memory to merge a write-ahead log that was left behind
      database_.exec("PRAGMA locking_mode = EXCLUSIVE");
      database_.execAndGet("PRAGMA journal_mode = DELETE");
      database_.exec("PRAGMA locking_mode = NORMAL");
      is_exclusive_ = false;
    };
    const bool wants_wal = wish.value_or(journal_for(folder_)) == Journal::wal;
    if (wants_wal && is_exclusive_) leave_wal();  // a log that is begun in exclusive mode locks readers out
    const bool wal = wants_wal && try_wal(wish == Journal::wal);
    if (!wal) leave_wal();
    journal_ = wal ? Journal::wal : Journal::rollback;
  });
}

Journal RunDatabase::journal_in_use() const {
  return guarded([&] {
    return database_.execAndGet("PRAGMA journal_mode").getString() == "wal" ? Journal::wal : Journal::rollback;
  });
}

void RunDatabase::take_snapshot() {
  if (journal_in_use() == Journal::wal) {
    execute("PRAGMA query_only = ON");
    return execute("BEGIN");
  }
  // With a rollback journal, a reader keeps others from writing, so the file is copied and the copy is read.
  guarded([&] {
    SQLite::Database copy("", SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);  // a temporary file
    if (SQLite::Backup(copy, database_).executeStep() != SQLITE_DONE)
      throw SQLite::Exception("it could not be copied, because it was being written all the time", SQLITE_BUSY);
    database_ = std::move(copy);
  });
  limit();
}

void RunDatabase::start_writing() {
  database_.setBusyTimeout(writing_ms);
  journal_ = journal_in_use();
  execute("PRAGMA synchronous = EXTRA");   // what was committed stays after a loss of power, with either journal
  execute("SELECT 1 FROM sqlite_master");  // makes SQLite create the log, which require_in_place() looks for
}

void RunDatabase::require_in_place() const {
  int moved = 0;
  sqlite3_file_control(database_.getHandle(), "main", SQLITE_FCNTL_HAS_MOVED, &moved);
  std::error_code error;
  const bool log_is_gone = journal_ == Journal::wal && !fs::exists(database_file(folder_) + "-wal", error);
  if (moved == 0 && !log_is_gone) return;
  throw StorageError(folder_.string() + ": " + database_name + (moved != 0 ? "" : "-wal") +
                     " was removed, moved or replaced by another file while it was in use, so nothing more can be "
                     "stored; if it was moved, put it back, or give the folder where it is now to `" +
                     program_name() + " resume`");
}

void RunDatabase::checkpoint_if_due() {
  const auto now = std::chrono::steady_clock::now();
  if (journal_ != Journal::wal || (last_checkpoint_ && now - *last_checkpoint_ < between_checkpoints)) return;
  last_checkpoint_ = now;
  guarded([&] {
    database_.setBusyTimeout(0);  // does not wait for readers: a later checkpoint moves what they hold back now
    database_.exec("PRAGMA wal_checkpoint(TRUNCATE)");
    database_.setBusyTimeout(writing_ms);
  });
}

void RunDatabase::execute(const char* sql) {
  guarded([&] { database_.exec(sql); });
}

void RunDatabase::refuse(const std::string& what) const {
  throw ArchiveError(folder_.string() + ": the record of the run is inconsistent: " + what +
                     "; put back an undamaged copy of " + database_name);
}

WriteTransaction::WriteTransaction(RunDatabase& run) : run_(run) {
  run_.require_in_place();
  run_.guarded([&] { transaction_.emplace(run_.sqlite(), SQLite::TransactionBehavior::IMMEDIATE); });
}

void WriteTransaction::commit() {
  run_.guarded([&] { transaction_->commit(); });
  run_.checkpoint_if_due();
  run_.require_in_place();
}

Statement::Statement(const RunDatabase& run, std::string table, const std::string& sql)
    : run_(run),
      table_(std::move(table)),
      statement_(run.guarded([&] { return SQLite::Statement(run.sqlite(), sql); })) {}

bool Statement::step() {
  return run_.guarded([&] { return statement_.executeStep(); });
}

bool Statement::is_null(int column) const { return statement_.isColumnNull(column); }

std::int64_t Statement::integer(int column, std::int64_t least, std::int64_t most) const {
  const SQLite::Column value = statement_.getColumn(column);
  if (!value.isInteger() || value.getInt64() < least || value.getInt64() > most)
    refuse(column, least == most ? std::to_string(least)
                                 : "a whole number from " + std::to_string(least) + " to " + std::to_string(most));
  return value.getInt64();
}

std::uint32_t Statement::index(int column, std::uint32_t most) const {
  return static_cast<std::uint32_t>(integer(column, 0, most));
}

double Statement::number(int column) const {
  const SQLite::Column value = statement_.getColumn(column);
  if (!value.isFloat() || !std::isfinite(value.getDouble())) refuse(column, "a finite number");
  return value.getDouble();
}

std::optional<double> Statement::optional_number(int column) const {
  return is_null(column) ? std::nullopt : std::optional(number(column));
}

std::string Statement::text(int column) const {
  const SQLite::Column value = statement_.getColumn(column);
  if (!value.isText()) refuse(column, "a text");
  using Json = nlohmann::json;
  return Json::parse(Json(value.getString()).dump(-1, ' ', false, Json::error_handler_t::replace)).get<std::string>();
}

std::string Statement::line(int column) const {
  constexpr std::size_t longest = 5000;  // bytes, longer than any path
  return printable(text(column), longest);
}

std::string_view Statement::bytes(int column) const {
  const SQLite::Column value = statement_.getColumn(column);
  if (!value.isBlob()) refuse(column, "bytes");
  return {static_cast<const char*>(value.getBlob()), static_cast<std::size_t>(value.getBytes())};
}

void Statement::refuse(int column, const std::string& expected) const {
  const SQLite::Column value = statement_.getColumn(column);
  std::string shown = "NULL";
  if (value.isInteger()) shown = std::to_string(value.getInt64());
  if (value.isFloat()) shown = to_text(value.getDouble());
  if (value.isText()) shown = "\"" + value.getString().substr(0, most_shown) + "\"";
  if (value.isBlob()) shown = std::to_string(value.getBytes()) + " bytes";
  run_.refuse(table_ + "." + value.getName() + " = " + shown + ", expected " + expected);
}

}  // namespace evodevo
