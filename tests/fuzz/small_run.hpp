// A small run whose record inputs change.
#pragma once

#include <SQLiteCpp/SQLiteCpp.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "archive/archive.hpp"
#include "evolution/evolution.hpp"
#include "experiment/device.hpp"
#include "experiment/experiment.hpp"
#include "fuzz/target.hpp"

namespace evodevo {

/// Has genomes whose blocks come and go, recorded lives, descriptors, scenarios, and a selection operator that notes
/// and remembers.
inline constexpr const char* small_experiment = R"(
[experiment]
evaluations = 12
population = 4

[encoding]
name = "neat"
points = 16
neighbours = 5

[[mutation]]
name = "reset-weight"

[[mutation]]
name = "add-node"

[scene.gravity]

[simulation]
device = "cpu"
threads = 1

[development]
cycles = 1
cycle_time = 0.01

[[development.operator]]
name = "spring-turnover"
springs = 2

[[scenario]]
name = "still"

[[fitness]]
name = "distance"
settle = 0.01
window = 0.01

[[fitness]]
name = "descriptor"
settle = 0.01
window = 0.01
rate = 100

[selection]
name = "novelty"
)";

inline std::filesystem::path new_folder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "evodevo-fuzz-XXXXXX").string();
  require(mkdtemp(pattern.data()) != nullptr, "no folder for a run");
  return pattern;
}

inline std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// A run of a few small robots in a temporary folder. Every table of its record has rows, except those for islands and
/// for files that parameters name.
class SmallRun {
 public:
  SmallRun() {
    {
      const auto simulator = make_simulator(experiment_);
      Archive archive = Archive::create(folder_, experiment_, simulator->device(), Journal::rollback);
      const std::atomic<bool> stop = false;
      const TimeSpent time = evolve(experiment_, *simulator, archive, stop, {});
      record_time_spent(archive, time);
      const ArchivedIndividual best = archive.known_individual(archive.best(1).front());
      archive.add_verifications({{best.id, best.result.objectives[0], {{"again", Status::ok, "", 0.3}}}});
    }
    record_ = bytes_of(folder_ / "run.sqlite");
  }
  SmallRun(const SmallRun&) = delete;
  SmallRun& operator=(const SmallRun&) = delete;
  ~SmallRun() { std::filesystem::remove_all(folder_); }

  const std::filesystem::path& folder() const { return folder_; }
  const Experiment& experiment() const { return experiment_; }

  /// Takes all changes of the record back, and opens it to change it again.
  SQLite::Database renewed() const {
    std::ofstream(folder_ / "run.sqlite", std::ios::binary) << record_;
    SQLite::Database record((folder_ / "run.sqlite").string(), SQLite::OPEN_READWRITE);
    record.exec("PRAGMA synchronous = OFF; PRAGMA journal_mode = MEMORY");
    return record;
  }

 private:
  std::filesystem::path folder_ = new_folder();
  /// Never destroyed, since the program's end comes too late to call operators.
  Experiment& experiment_ = *new Experiment(read_experiment(small_experiment, {folder_ / "small.toml", {}}));
  std::string record_;  ///< all bytes of its file
};

/// A column of a table in the record of a run.
struct Column {
  std::string table, name;
  bool is_text = false;
  std::string first;  ///< name of the table's first column, which tells rows apart
};

/// Returns the columns of all tables.
inline std::vector<Column> columns_of(SQLite::Database& record) {
  std::vector<Column> columns;
  SQLite::Statement row(record,
                        "SELECT m.name, c.name, c.type, (SELECT name FROM pragma_table_info(m.name) WHERE cid = 0) "
                        "FROM sqlite_master m, pragma_table_info(m.name) c WHERE m.type = 'table' ORDER BY 1, c.cid");
  while (row.executeStep())
    columns.push_back({row.getColumn(0).getString(), row.getColumn(1).getString(),
                       row.getColumn(2).getString() == "TEXT", row.getColumn(3).getString()});
  return columns;
}

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
