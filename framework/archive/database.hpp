// The SQLite file of a run: opens, locks and writes it, and checks every value that it reads. Every SQLite error
// becomes an ArchiveError or a StorageError, whose message names the folder and the remedy.
#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "archive/error.hpp"
#include "archive/file_lock.hpp"
#include "archive/journal.hpp"

namespace evodevo {

/// Throws the ArchiveError or StorageError that corresponds to `error`, for the run in `folder`.
[[noreturn]] void throw_as_our_own(const SQLite::Exception& error, const std::filesystem::path& folder);

/// The open file of a run and, in the process that makes the run, the lock that keeps other processes from resuming it.
/// The operating system releases the lock when the process ends, even if it is killed.
class RunDatabase {
 public:
  /// Opens the file in `folder`, or creates it if `flags` has SQLite::OPEN_CREATE.
  RunDatabase(std::filesystem::path folder, int flags, std::optional<FileLock> lock);
  RunDatabase(const RunDatabase&) = delete;
  RunDatabase& operator=(const RunDatabase&) = delete;
  /// In the process that makes the run, merges the write-ahead log into the database file, so that the run is one file,
  /// which can be read on any file system. While another process reads the run, the log and its index file stay.
  ~RunDatabase();

  /// Makes SQLite work without shared memory. Must be called before all other functions if the run is to have a
  /// rollback journal.
  void prepare_for_rollback();
  /// Sets the journal to `wish` or, if that is nullopt, to the kind of journal that works in the folder.
  void set_journal(std::optional<Journal> wish);
  /// Makes all later reads see the same state of the run, without keeping other processes from writing.
  void take_snapshot();
  /// Prepares for writing: from now on, waits longer for other processes that use the file.
  void start_writing();

  /// Throws StorageError if the file was moved, removed or replaced since it was opened, or its log is gone.
  void require_in_place() const;
  /// Moves the content of the write-ahead log to the database file, as far as readers allow it. Does nothing if less
  /// than a second has passed since the last call that moved it, because each such call waits for the disk.
  void checkpoint_if_due();

  void execute(const char* sql);
  /// Throws an ArchiveError which says that the record of the run is inconsistent. `what` describes how.
  [[noreturn]] void refuse(const std::string& what) const;

  const std::filesystem::path& folder() const { return folder_; }
  SQLite::Database& sqlite() const { return database_; }

  /// Returns the result of `call()`, and turns SQLite's exceptions into ArchiveError and StorageError.
  template <class Call>
  decltype(auto) guarded(const Call& call) const {
    try {
      return call();
    } catch (const SQLite::Exception& error) {
      throw_as_our_own(error, folder_);
    }
  }

 private:
  void limit() const;
  Journal journal_in_use() const;
  bool try_wal(bool must);

  std::filesystem::path folder_;
  std::optional<FileLock> lock_;
  mutable SQLite::Database database_;  ///< mutable because SQLite has no const interface, not even for reading
  Journal journal_ = Journal::rollback;
  bool is_exclusive_ = false;  ///< since prepare_for_rollback()
  std::optional<std::chrono::steady_clock::time_point> last_checkpoint_;
};

/// A transaction: either everything that is written from its construction to commit() is kept, or nothing. The
/// constructor waits for other writers, so that later writes do not fail because of them.
class WriteTransaction {
 public:
  explicit WriteTransaction(RunDatabase& run);
  void commit();

 private:
  RunDatabase& run_;
  std::optional<SQLite::Transaction> transaction_;
};

/// An SQL statement and its result rows. Reading a value that does not have the expected type or range throws an
/// ArchiveError that names the table and the column.
class Statement {
 public:
  /// `table` is the name of the table in messages.
  Statement(const RunDatabase& run, std::string table, const std::string& sql);

  /// Resets the statement and binds the values to its parameters, in order.
  template <class... Values>
  void bind(const Values&... values) {
    int position = 0;
    run_.guarded([&] {
      statement_.reset();
      statement_.clearBindings();
      (bind_one(++position, values), ...);
    });
  }
  /// Executes the statement with these values.
  template <class... Values>
  void execute(const Values&... values) {
    bind(values...);
    run_.guarded([&] { statement_.exec(), statement_.reset(); });
  }
  /// Goes to the next row; returns false if there is none.
  bool step();

  bool is_null(int column) const;
  /// Reads a whole number from `least` to `most`.
  std::int64_t integer(int column, std::int64_t least, std::int64_t most) const;
  /// Reads an id, a position or the number of a generation: a whole number from 0 to `most`.
  std::uint32_t index(int column, std::uint32_t most = std::numeric_limits<std::uint32_t>::max()) const;
  /// Reads a finite number.
  double number(int column) const;
  /// Reads a finite number, or NULL.
  std::optional<double> optional_number(int column) const;
  /// Reads a text; replaces what is not valid UTF-8.
  std::string text(int column) const;
  /// Reads a text and makes it safe to print: escapes control characters and cuts it if it is too long.
  std::string line(int column) const;
  /// Reads bytes; they are valid until the next step().
  std::string_view bytes(int column) const;

  /// Throws an ArchiveError which says that the value of a column is not the expected one.
  [[noreturn]] void refuse(int column, const std::string& expected) const;

 private:
  template <class T>
  void bind_one(int position, const T& value) {
    statement_.bind(position, value);
  }
  template <class T>
  void bind_one(int position, const std::optional<T>& value) {
    if (value) bind_one(position, *value);
  }
  /// Binds bytes. Passes a valid pointer even if there are none, because SQLite would take a null pointer for NULL.
  void bind_one(int position, std::string_view bytes) {
    statement_.bind(position, bytes.empty() ? "" : static_cast<const void*>(bytes.data()),
                    static_cast<int>(bytes.size()));
  }

  const RunDatabase& run_;
  std::string table_;
  SQLite::Statement statement_;
};

}  // namespace evodevo
