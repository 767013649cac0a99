// The SQLite file of a run: how it is opened, locked and written, and rows of which every value is checked. Whatever
// SQLite objects to leaves here as an ArchiveError or a StorageError that names the folder and the remedy.
#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <boost/interprocess/sync/file_lock.hpp>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "evolution/archive/error.hpp"
#include "evolution/archive/journal.hpp"

namespace evodevo {

/// Throws what `error` means for the run in `folder`.
[[noreturn]] void throw_as_our_own(const SQLite::Exception& error, const std::filesystem::path& folder);

/// The open file and, for the process that makes the run, the lock that keeps others out. The lock goes with the
/// process, however it ends.
class RunDatabase {
 public:
  /// Opens the file in `folder`, or makes it where `flags` say so.
  RunDatabase(std::filesystem::path folder, int flags, std::optional<boost::interprocess::file_lock> lock);
  RunDatabase(const RunDatabase&) = delete;
  RunDatabase& operator=(const RunDatabase&) = delete;
  /// The process that made the run leaves one file behind that can be read from anywhere. Where a reader is at work
  /// there are three.
  ~RunDatabase();

  /// Allows what needs no shared memory alone; to be called before anything else where a rollback journal is asked for.
  void prepare_for_rollback();
  /// Chooses the journal. Without a wish it is the one that works in the folder.
  void set_journal(std::optional<Journal> wish);
  /// Lets all that is read from now on be of one moment, without keeping anyone from writing.
  void take_snapshot();
  /// From now on others are waited for as long as it takes: the file is one of ours, and there is work to keep.
  void start_writing();

  /// Throws StorageError where the file is no longer the one that was opened.
  void require_in_place() const;
  /// Moves what the write-ahead log holds to the file itself, as far as readers allow it. Not more than once a second,
  /// since the disk is waited for.
  void checkpoint_if_due();

  void execute(const char* sql);
  /// Throws ArchiveError: what was read cannot be.
  [[noreturn]] void refuse(const std::string& what) const;

  const std::filesystem::path& folder() const { return folder_; }
  SQLite::Database& sqlite() const { return database_; }

  /// Calls something that SQLite may object to.
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
  std::optional<boost::interprocess::file_lock> lock_;
  mutable SQLite::Database database_;  ///< SQLite's handle says itself what is written
  Journal journal_ = Journal::rollback;
  std::optional<std::chrono::steady_clock::time_point> last_checkpoint_;
};

/// Everything that is written between its beginning and commit(), or nothing of it. It waits for other writers at its
/// beginning, so that it never fails half-way because of one.
class WriteTransaction {
 public:
  explicit WriteTransaction(RunDatabase& run);
  void commit();

 private:
  RunDatabase& run_;
  std::optional<SQLite::Transaction> transaction_;
};

/// A statement, and the rows that it gives. A value that is not of the kind and range that is asked for is refused with
/// its table and column.
class Statement {
 public:
  /// `table` names what is read in messages.
  Statement(const RunDatabase& run, std::string table, const std::string& sql);

  /// Starts anew with values for all positions, in their order.
  template <class... Values>
  void bind(const Values&... values) {
    int position = 0;
    run_.guarded([&] {
      statement_.reset();
      statement_.clearBindings();
      (bind_one(++position, values), ...);
    });
  }
  /// Does the statement with these values.
  template <class... Values>
  void execute(const Values&... values) {
    bind(values...);
    run_.guarded([&] { statement_.exec(), statement_.reset(); });
  }
  /// Goes to the next row; false where there is none.
  bool step();

  bool is_null(int column) const;
  std::int64_t integer(int column, std::int64_t least, std::int64_t most) const;
  /// An id, a place or a number of a generation.
  std::uint32_t index(int column, std::uint32_t most = std::numeric_limits<std::uint32_t>::max()) const;
  /// Finite.
  double number(int column) const;
  std::optional<double> optional_number(int column) const;
  /// Valid UTF-8, whatever there is.
  std::string text(int column) const;
  /// Valid until the next step().
  std::string_view bytes(int column) const;

  /// Throws ArchiveError for the value of a column.
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
  /// Bytes; without any, SQLite would take a null pointer for NULL.
  void bind_one(int position, std::string_view bytes) {
    statement_.bind(position, bytes.empty() ? "" : static_cast<const void*>(bytes.data()),
                    static_cast<int>(bytes.size()));
  }

  const RunDatabase& run_;
  std::string table_;
  SQLite::Statement statement_;
};

}  // namespace evodevo
