// A small run whose record inputs change.
#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <filesystem>
#include <string>
#include <vector>

#include "experiment/experiment.hpp"

namespace evodevo {

/// A run of a few small robots in a temporary folder. Every table of its record has rows, except those for islands and
/// for files that parameters name.
class SmallRun {
 public:
  SmallRun();
  SmallRun(const SmallRun&) = delete;
  SmallRun& operator=(const SmallRun&) = delete;
  ~SmallRun();

  const std::filesystem::path& folder() const { return folder_; }
  const Experiment& experiment() const { return experiment_; }

  /// Takes all changes of the record back, and opens it to change it again.
  SQLite::Database renewed() const;

 private:
  std::filesystem::path folder_;
  Experiment& experiment_;  ///< never destroyed, since the program's end comes too late to call operators
  std::string record_;      ///< all bytes of its file
};

/// A column of a table in the record of a run.
struct Column {
  std::string table, name;
  bool is_text = false;
  std::string first;  ///< name of the table's first column, which tells rows apart
};

/// Returns the columns of all tables.
std::vector<Column> columns_of(SQLite::Database& record);

/// Changes a column in a row, or in the rows whose first column is the same. Does nothing if the constraints of the
/// table do not allow that, or if there is no such row. `bind` binds the new value to the statement's parameter 1.
template <class Bind>
void change(SQLite::Database& record, const Column& column, std::size_t row, const Bind& bind) {
  SQLite::Statement update(record, "UPDATE " + column.table + " SET " + column.name + " = ?1 WHERE " + column.first +
                                       " IS (SELECT " + column.first + " FROM " + column.table + " LIMIT 1 OFFSET ?2)");
  update.bind(2, static_cast<std::int64_t>(row));
  bind(update);
  try {
    update.exec();
  } catch (const SQLite::Exception&) {
  }
}

}  // namespace evodevo
