#include "fuzz/small_run.hpp"

#include <unistd.h>

#include <atomic>
#include <fstream>
#include <iterator>

#include "evolution/archive/archive.hpp"
#include "evolution/evolution.hpp"
#include "experiment/device.hpp"
#include "fuzz/target.hpp"

namespace evodevo {
namespace {

namespace fs = std::filesystem;

/// Has genomes whose blocks come and go, recorded lives, descriptors, scenarios, and a selection operator that notes
/// and remembers.
constexpr const char* small_experiment = R"(
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

fs::path new_folder() {
  std::string pattern = (fs::temp_directory_path() / "evodevo-fuzz-XXXXXX").string();
  require(mkdtemp(pattern.data()) != nullptr, "no folder for a run");
  return pattern;
}

std::string bytes_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace

SmallRun::SmallRun()
    : folder_(new_folder()),
      experiment_(*new Experiment(read_experiment(small_experiment, {folder_ / "small.toml", {}}))) {
  {
    const auto simulator = make_simulator(experiment_);
    Archive archive = Archive::create(folder_, experiment_, simulator->device(), Journal::rollback);
    const std::atomic<bool> stop = false;
    const TimeSpent time = evolve(experiment_, *simulator, archive, stop, {});
    record_time_spent(archive, time);
    archive.add_verifications({{archive.best(1).front(), 0.3, {{"again", Status::ok, "", 0.3}}}});
  }
  record_ = bytes_of(folder_ / "run.sqlite");
}

SmallRun::~SmallRun() { fs::remove_all(folder_); }

SQLite::Database SmallRun::renewed() const {
  std::ofstream(folder_ / "run.sqlite", std::ios::binary) << record_;
  SQLite::Database record((folder_ / "run.sqlite").string(), SQLite::OPEN_READWRITE);
  record.exec("PRAGMA synchronous = OFF; PRAGMA journal_mode = MEMORY");
  return record;
}

std::vector<Column> columns_of(SQLite::Database& record) {
  std::vector<Column> columns;
  SQLite::Statement row(record,
                        "SELECT m.name, c.name, c.type, (SELECT name FROM pragma_table_info(m.name) WHERE cid = 0) "
                        "FROM sqlite_master m, pragma_table_info(m.name) c WHERE m.type = 'table' ORDER BY 1, c.cid");
  while (row.executeStep())
    columns.push_back({row.getColumn(0).getString(), row.getColumn(1).getString(),
                       row.getColumn(2).getString() == "TEXT", row.getColumn(3).getString()});
  return columns;
}

}  // namespace evodevo
