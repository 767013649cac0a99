#include "archive.hpp"

#include <SQLiteCpp/SQLiteCpp.h>
#include <SQLiteCpp/VariadicBind.h>

#include <algorithm>
#include <boost/interprocess/sync/file_lock.hpp>
#include <chrono>
#include <cstring>
#include <ctime>
#include <fstream>

#include "text.hpp"

namespace evodevo {
namespace {

namespace fs = std::filesystem;

constexpr const char* lock_name = "lock";
constexpr const char* format = "4";  ///< raised when a change of the tables keeps older programs from reading them
/// Readers and the writer do not wait for each other; but a folder that nobody may write cannot be read like this.
constexpr const char* wait_for_nobody = "PRAGMA journal_mode = WAL";
constexpr const char* rest_in_one_file = "PRAGMA journal_mode = DELETE";
constexpr int busy_ms = 60'000;  ///< how long to wait for a process that is just reading or writing

constexpr const char* schema = R"sql(
CREATE TABLE record(key TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
-- whom a run was begun and resumed by; numbered from 0
CREATE TABLE makers(maker INTEGER PRIMARY KEY, device TEXT NOT NULL, evodevo TEXT NOT NULL, program TEXT NOT NULL);
CREATE TABLE operators(maker INTEGER NOT NULL, kind TEXT NOT NULL, name TEXT NOT NULL, version TEXT NOT NULL,
  file TEXT NOT NULL, hash TEXT NOT NULL);
CREATE TABLE objectives(position INTEGER PRIMARY KEY, name TEXT NOT NULL, unit TEXT NOT NULL, maximise INTEGER NOT NULL);
CREATE TABLE individuals(
  id INTEGER PRIMARY KEY,
  born INTEGER NOT NULL,                -- generation
  died INTEGER,                         -- generation whose selection dropped it; null while it lives
  origin INTEGER NOT NULL,              -- generation of its oldest genes
  parent INTEGER, mate INTEGER,         -- ids
  made_by TEXT NOT NULL,
  genes BLOB NOT NULL,                  -- float32, little-endian
  status TEXT NOT NULL, reason TEXT, ended_at REAL,
  spring_evaluations INTEGER NOT NULL);
CREATE INDEX individuals_by_death ON individuals(died);
CREATE TABLE scores(
  individual INTEGER NOT NULL, objective INTEGER NOT NULL, value REAL NOT NULL,
  PRIMARY KEY(individual, objective)) WITHOUT ROWID;
-- what development did to those who reached the front; see life_record.hpp
CREATE TABLE lives(individual INTEGER PRIMARY KEY, record BLOB NOT NULL);
CREATE TABLE generations(
  generation INTEGER PRIMARY KEY, evaluations INTEGER NOT NULL, best REAL, median REAL,
  diverged INTEGER NOT NULL, invalid INTEGER NOT NULL, spring_evaluations INTEGER NOT NULL, wall_time REAL NOT NULL,
  maker INTEGER NOT NULL);
-- who lived on after each generation, and how old its genes were then
CREATE VIEW members AS
  SELECT generation, id AS individual, generation - origin AS age
  FROM generations JOIN individuals ON born <= generation AND (died IS NULL OR died > generation);
)sql";

/// Runs of older programs come without it.
constexpr const char* verification_schema = R"sql(
CREATE TABLE IF NOT EXISTS verifications(
  individual INTEGER NOT NULL, trial TEXT NOT NULL, position INTEGER NOT NULL,
  status TEXT NOT NULL, reason TEXT, value REAL,  -- of the first objective
  PRIMARY KEY(individual, trial)) WITHOUT ROWID;
)sql";

std::string utc_now() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

template <class T>
void bind_optional(SQLite::Statement& statement, int position, const std::optional<T>& value) {
  if (value)
    statement.bind(position, *value);
  else
    statement.bind(position);
}

std::optional<double> optional_double(const SQLite::Column& column) {
  if (column.isNull()) return std::nullopt;
  return column.getDouble();
}

/// A text that somebody else may have written.
std::string text_of(const SQLite::Column& column) {
  constexpr std::size_t longest = 5000;  // longer than any path
  return printable(column.getString(), longest);
}

Status status_from(const std::string& text) {
  for (const Status status : {Status::ok, Status::invalid, Status::diverged})
    if (text == name(status)) return status;
  throw ArchiveError("unknown status \"" + text + "\" in the record of the run");
}

constexpr const char* individual_columns =
    "id, born, origin, parent, mate, made_by, genes, status, reason, ended_at, spring_evaluations, died";

ArchivedIndividual read_individual(SQLite::Database& database, SQLite::Statement& row) {
  ArchivedIndividual individual;
  individual.id = row.getColumn(0).getUInt();
  individual.born = row.getColumn(1).getUInt();
  individual.origin = row.getColumn(2).getUInt();
  for (const int column : {3, 4})
    if (!row.isColumnNull(column)) individual.parents.push_back(row.getColumn(column).getUInt());
  individual.made_by = text_of(row.getColumn(5));
  const SQLite::Column genes = row.getColumn(6);
  individual.genome.resize(static_cast<std::size_t>(genes.getBytes()) / sizeof(float));
  if (!individual.genome.empty())
    std::memcpy(individual.genome.data(), genes.getBlob(), individual.genome.size() * sizeof(float));
  individual.result.status = status_from(text_of(row.getColumn(7)));
  if (!row.isColumnNull(8)) individual.result.reason = text_of(row.getColumn(8));
  if (!row.isColumnNull(9)) individual.result.ended_at = row.getColumn(9).getDouble();
  individual.result.spring_evaluations = static_cast<std::uint64_t>(row.getColumn(10).getInt64());
  if (!row.isColumnNull(11)) individual.died = row.getColumn(11).getUInt();
  SQLite::Statement scores(database, "SELECT value FROM scores WHERE individual = ? ORDER BY objective");
  scores.bind(1, individual.id);
  while (scores.executeStep()) individual.result.objectives.push_back(scores.getColumn(0).getDouble());
  return individual;
}

}  // namespace

/// The open database and, for a process that writes, the lock that keeps others out. The lock goes with the process,
/// however it ends.
struct Archive::Files {
  std::optional<boost::interprocess::file_lock> lock;
  SQLite::Database database;

  Files(const fs::path& folder, int flags) : database((folder / database_name).string(), flags, busy_ms) {}
  Files(const Files&) = delete;
  Files& operator=(const Files&) = delete;

  /// A writer leaves one file behind that can be read from anywhere. Where a reader is at work it stays as it is.
  ~Files() {
    if (!lock) return;
    try {
      database.setBusyTimeout(0);
      database.exec(rest_in_one_file);
    } catch (const SQLite::Exception&) {
    }
  }
};

namespace {

boost::interprocess::file_lock locked(const fs::path& folder) {
  const fs::path file = folder / lock_name;
  if (!std::ofstream(file, std::ios::app)) throw ArchiveError(folder.string() + ": cannot be written");
  boost::interprocess::file_lock lock(file.c_str());
  if (!lock.try_lock())
    throw ArchiveError(folder.string() + ": another evodevo process is writing this run; wait for it or stop it first");
  return lock;
}

void require_empty(const fs::path& folder) {
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (entry.path().filename() != lock_name)
      throw ArchiveError(folder.string() + ": is not empty; give another --out, or continue the run in it with `" +
                         program_name() + " resume " + folder.string() + "`");
}

void require_run(const fs::path& folder) {
  if (std::error_code error; !fs::exists(folder / database_name, error))
    throw ArchiveError(folder.string() + ": there is no run here (no " + database_name + "); give a folder that `" +
                       program_name() + " run` has written");
}

}  // namespace

Archive::Archive(fs::path folder, std::unique_ptr<Files> files)
    : folder_(std::move(folder)), files_(std::move(files)) {}
Archive::Archive(Archive&&) noexcept = default;
Archive::~Archive() = default;

Archive Archive::create(const fs::path& folder, const Experiment& experiment, const std::string& device) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw ArchiveError(folder.string() + ": cannot be made: " + error.message());
  require_empty(folder);  // before the lock, which leaves a file behind, and again when nobody else can write
  auto lock = locked(folder);
  require_empty(folder);
  auto files = std::make_unique<Files>(folder, SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
  files->lock = std::move(lock);
  SQLite::Database& database = files->database;
  database.exec(wait_for_nobody);
  SQLite::Transaction transaction(database);
  database.exec(schema);
  for (std::size_t i = 0; i < experiment.objectives.size(); ++i) {
    const Objective& objective = experiment.objectives[i];
    SQLite::Statement insert(database, "INSERT INTO objectives VALUES(?, ?, ?, ?)");
    SQLite::bind(insert, static_cast<int>(i), objective.name, objective.unit, objective.maximise ? 1 : 0);
    insert.exec();
  }
  Archive archive(folder, std::move(files));
  archive.insert_maker(0, this_maker(experiment, device));
  archive.set_record("format", format);
  archive.set_record("evodevo", EVODEVO_VERSION);
  archive.set_record("created", utc_now());
  archive.set_record("name", experiment.name);
  archive.set_record("seed", std::to_string(experiment.seed));
  archive.set_record("experiment", experiment.resolved);
  transaction.commit();
  return archive;
}

Archive Archive::resume(const fs::path& folder) {
  require_run(folder);
  auto lock = locked(folder);
  Archive archive = opened(folder, SQLite::OPEN_READWRITE);
  archive.files_->lock = std::move(lock);
  archive.files_->database.exec(wait_for_nobody);
  return archive;
}

Archive Archive::annotate(const fs::path& folder) {
  require_run(folder);
  return opened(folder, SQLite::OPEN_READWRITE);
}

Archive Archive::read(const fs::path& folder) {
  require_run(folder);
  Archive archive = opened(folder, SQLite::OPEN_READONLY);
  archive.files_->database.exec("BEGIN");
  return archive;
}

Archive Archive::opened(const fs::path& folder, int flags) try {
  auto files = std::make_unique<Files>(folder, flags);
  // everything up to the first generation is one transaction
  if (!files->database.tableExists("record"))
    throw ArchiveError(folder.string() + ": the run in it ended before it began; remove the folder and run anew");
  Archive archive(folder, std::move(files));
  if (archive.record("format") != format)
    throw ArchiveError(folder.string() + ": has format " + archive.record("format") + ", this evodevo reads format " +
                       format + "; use the evodevo that wrote it, " + archive.record("evodevo"));
  return archive;
} catch (const SQLite::Exception& error) {
  throw ArchiveError((folder / database_name).string() + ": cannot be read: " + error.what());
}

void Archive::commit(const std::vector<Individual>& newborns, const std::vector<std::uint32_t>& dropped,
                     const std::map<std::uint32_t, LifeRecord>& lives, const Summary& summary) {
  SQLite::Database& database = files_->database;
  SQLite::Transaction transaction(database);
  SQLite::Statement insert(database, std::string("INSERT INTO individuals(") + individual_columns +
                                         ") VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, NULL)");
  SQLite::Statement insert_score(database, "INSERT INTO scores VALUES(?, ?, ?)");
  for (const Individual& individual : newborns) {
    const Result& result = individual.result;
    const auto parent = [&](std::size_t i) {
      return i < individual.parents.size() ? std::optional(individual.parents[i]) : std::nullopt;
    };
    insert.bind(1, individual.id);
    insert.bind(2, individual.born);
    insert.bind(3, individual.origin);
    bind_optional(insert, 4, parent(0));
    bind_optional(insert, 5, parent(1));
    insert.bind(6, individual.made_by);
    insert.bind(7, individual.genome.data(), static_cast<int>(individual.genome.size() * sizeof(float)));
    insert.bind(8, name(result.status));
    if (result.status != Status::ok) insert.bind(9, result.reason);
    if (result.status == Status::diverged) insert.bind(10, result.ended_at);
    insert.bind(11, static_cast<std::int64_t>(result.spring_evaluations));
    insert.exec();
    insert.reset();
    insert.clearBindings();
    for (std::size_t i = 0; i < result.objectives.size(); ++i) {
      SQLite::bind(insert_score, individual.id, static_cast<int>(i), result.objectives[i]);
      insert_score.exec();
      insert_score.reset();
    }
  }
  SQLite::Statement insert_life(database, "INSERT INTO lives VALUES(?, ?)");
  for (const auto& [id, life] : lives) {
    insert_life.bind(1, id);
    insert_life.bind(2, life.bytes().data(), static_cast<int>(life.bytes().size()));
    insert_life.exec();
    insert_life.reset();
  }
  SQLite::Statement drop(database, "UPDATE individuals SET died = ? WHERE id = ?");
  for (const std::uint32_t id : dropped) {
    SQLite::bind(drop, summary.generation, id);
    drop.exec();
    drop.reset();
  }
  SQLite::Statement add(database, "INSERT INTO generations VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?)");
  add.bind(1, summary.generation);
  add.bind(2, summary.evaluations);
  bind_optional(add, 3, summary.best);
  bind_optional(add, 4, summary.median);
  add.bind(5, summary.diverged);
  add.bind(6, summary.invalid);
  add.bind(7, static_cast<std::int64_t>(summary.spring_evaluations));
  add.bind(8, summary.wall_time);
  add.bind(9, summary.maker);
  add.exec();
  transaction.commit();
}

void Archive::add_verifications(const std::vector<Verification>& verifications) try {
  SQLite::Database& database = files_->database;
  SQLite::Transaction transaction(database);
  database.exec(verification_schema);
  SQLite::Statement insert(database, "INSERT OR REPLACE INTO verifications VALUES(?, ?, ?, ?, ?, ?)");
  for (const Verification& verification : verifications) {
    int position = 0;
    for (const Trial& trial : verification.trials) {
      insert.bind(1, verification.individual);
      insert.bind(2, trial.name);
      insert.bind(3, position++);
      insert.bind(4, name(trial.status));
      if (trial.status != Status::ok) insert.bind(5, trial.reason);
      bind_optional(insert, 6, trial.value);
      insert.exec();
      insert.reset();
      insert.clearBindings();
    }
  }
  transaction.commit();
} catch (const SQLite::Exception& error) {
  throw ArchiveError(folder_.string() + ": verifications cannot be written: " + error.what());
}

std::optional<Verification> Archive::verification(std::uint32_t id) const {
  if (!files_->database.tableExists("verifications")) return std::nullopt;
  SQLite::Statement row(files_->database,
                        "SELECT trial, status, reason, verifications.value, scores.value FROM verifications "
                        "JOIN scores USING(individual) WHERE individual = ? AND objective = 0 ORDER BY position");
  row.bind(1, id);
  Verification verification{id, 0, {}};
  while (row.executeStep()) {
    verification.fitness = row.getColumn(4).getDouble();
    verification.trials.push_back({text_of(row.getColumn(0)), status_from(text_of(row.getColumn(1))),
                                   row.isColumnNull(2) ? "" : text_of(row.getColumn(2)),
                                   optional_double(row.getColumn(3))});
  }
  if (verification.trials.empty()) return std::nullopt;
  return verification;
}

std::string Archive::record(const std::string& key) const {
  auto value = find_record(key);
  if (!value) throw ArchiveError(folder_.string() + ": its record has no \"" + key + "\"");
  return std::move(*value);
}

std::optional<std::string> Archive::find_record(const std::string& key) const {
  SQLite::Statement query(files_->database, "SELECT value FROM record WHERE key = ?");
  query.bind(1, key);
  if (!query.executeStep()) return std::nullopt;
  return query.getColumn(0).getString();
}

void Archive::set_record(const std::string& key, const std::string& value) {
  SQLite::Statement insert(files_->database, "INSERT OR REPLACE INTO record VALUES(?, ?)");
  SQLite::bind(insert, key, value);
  insert.exec();
}

void Archive::set_records(const std::map<std::string, std::string>& entries) {
  SQLite::Transaction transaction(files_->database);
  for (const auto& [key, value] : entries) set_record(key, value);
  transaction.commit();
}

void Archive::insert_maker(std::uint32_t place, const Maker& maker) {
  SQLite::Statement insert(files_->database, "INSERT INTO makers VALUES(?, ?, ?, ?)");
  SQLite::bind(insert, place, maker.device, maker.version, maker.program);
  insert.exec();
  for (const OperatorUse& use : maker.operators) {
    SQLite::Statement add(files_->database, "INSERT INTO operators VALUES(?, ?, ?, ?, ?, ?)");
    SQLite::bind(add, place, use.kind, use.name, use.version, use.file.string(), use.hash);
    add.exec();
  }
}

std::uint32_t Archive::add_maker(const Maker& maker) {
  const std::vector<Maker> there = makers();
  const auto same = std::find_if(there.begin(), there.end(), [&](const Maker& one) { return are_same(one, maker); });
  const auto place = static_cast<std::uint32_t>(same - there.begin());
  if (same != there.end()) return place;
  SQLite::Transaction transaction(files_->database);
  insert_maker(place, maker);
  transaction.commit();
  return place;
}

std::vector<Maker> Archive::makers() const {
  std::vector<Maker> makers;
  SQLite::Statement row(files_->database, "SELECT device, evodevo, program FROM makers ORDER BY maker");
  while (row.executeStep())
    makers.push_back({text_of(row.getColumn(0)), text_of(row.getColumn(1)), text_of(row.getColumn(2)), {}});
  SQLite::Statement use(files_->database,
                        "SELECT maker, kind, name, version, file, hash FROM operators ORDER BY rowid");
  while (use.executeStep())
    makers.at(use.getColumn(0).getUInt())
        .operators.push_back({text_of(use.getColumn(1)), text_of(use.getColumn(2)), text_of(use.getColumn(3)),
                              text_of(use.getColumn(4)), text_of(use.getColumn(5))});
  return makers;
}

Maker Archive::maker(std::uint32_t generation) const {
  SQLite::Statement query(files_->database, "SELECT maker FROM generations WHERE generation = ?");
  query.bind(1, generation);
  if (!query.executeStep())
    throw ArchiveError(folder_.string() + ": its record has no generation " + std::to_string(generation));
  return makers().at(query.getColumn(0).getUInt());
}

std::vector<Objective> Archive::objectives() const {
  std::vector<Objective> objectives;
  SQLite::Statement query(files_->database, "SELECT name, unit, maximise FROM objectives ORDER BY position");
  while (query.executeStep())
    objectives.push_back({text_of(query.getColumn(0)), text_of(query.getColumn(1)), query.getColumn(2).getInt() != 0});
  return objectives;
}

std::vector<Summary> Archive::generations() const {
  std::vector<Summary> summaries;
  SQLite::Statement row(files_->database, "SELECT * FROM generations ORDER BY generation");
  while (row.executeStep())
    summaries.push_back({.generation = row.getColumn(0).getUInt(),
                         .evaluations = row.getColumn(1).getInt64(),
                         .best = optional_double(row.getColumn(2)),
                         .median = optional_double(row.getColumn(3)),
                         .diverged = row.getColumn(4).getInt64(),
                         .invalid = row.getColumn(5).getInt64(),
                         .spring_evaluations = static_cast<std::uint64_t>(row.getColumn(6).getInt64()),
                         .wall_time = row.getColumn(7).getDouble(),
                         .maker = row.getColumn(8).getUInt()});
  return summaries;
}

std::map<std::string, std::int64_t> Archive::statuses() const {
  std::map<std::string, std::int64_t> counts;
  for (const Status status : {Status::ok, Status::invalid, Status::diverged}) counts[name(status)] = 0;
  SQLite::Statement query(files_->database, "SELECT status, count(*) FROM individuals GROUP BY status");
  while (query.executeStep()) counts[query.getColumn(0).getString()] = query.getColumn(1).getInt64();
  return counts;
}

std::vector<Failure> Archive::failures() const {
  std::map<std::pair<std::string, std::string>, Failure> failures;
  SQLite::Statement query(files_->database,
                          "SELECT status, coalesce(reason, ''), count(*) FROM individuals WHERE status <> 'ok' "
                          "GROUP BY status, reason ORDER BY min(id)");
  while (query.executeStep()) {
    const std::string status = text_of(query.getColumn(0)), reason = text_of(query.getColumn(1));
    const std::string alike = reason.substr(0, reason.find_first_of("0123456789"));
    Failure& failure = failures.try_emplace({status, alike}, Failure{status, reason}).first->second;
    failure.count += query.getColumn(2).getInt64();
    failure.varies |= failure.reason != reason;
  }
  std::vector<Failure> sorted;
  for (auto& [key, failure] : failures) sorted.push_back(std::move(failure));
  std::stable_sort(sorted.begin(), sorted.end(), [](const Failure& a, const Failure& b) { return a.count > b.count; });
  return sorted;
}

std::vector<Individual> Archive::population() const {
  std::vector<Individual> population;
  SQLite::Statement query(files_->database, std::string("SELECT ") + individual_columns +
                                                " FROM individuals WHERE died IS NULL ORDER BY id");
  while (query.executeStep()) population.push_back(read_individual(files_->database, query));
  return population;
}

std::optional<ArchivedIndividual> Archive::individual(std::uint32_t id) const {
  SQLite::Statement query(files_->database,
                          std::string("SELECT ") + individual_columns + " FROM individuals WHERE id = ?");
  query.bind(1, id);
  if (!query.executeStep()) return std::nullopt;
  return read_individual(files_->database, query);
}

std::optional<LifeRecord> Archive::life(std::uint32_t id) const try {
  SQLite::Statement query(files_->database, "SELECT record FROM lives WHERE individual = ?");
  query.bind(1, id);
  if (!query.executeStep()) return std::nullopt;
  return LifeRecord(query.getColumn(0).getString());
} catch (const std::invalid_argument& error) {
  throw ArchiveError(folder_.string() + ": individual " + std::to_string(id) + ": " + error.what());
}

std::vector<std::uint32_t> Archive::best(std::size_t count) const {
  const bool maximise = objectives().at(0).maximise;
  std::vector<std::uint32_t> ids;
  SQLite::Statement query(files_->database,
                          std::string("SELECT individual FROM scores WHERE objective = 0 ORDER BY value ") +
                              (maximise ? "DESC" : "ASC") + ", individual LIMIT ?");
  query.bind(1, static_cast<std::int64_t>(count));
  while (query.executeStep()) ids.push_back(query.getColumn(0).getUInt());
  return ids;
}

Experiment recorded_experiment(const Archive& archive, std::vector<fs::path> plugin_path) {
  Experiment experiment =
      read_experiment(archive.record("experiment"), {.file = (archive.folder() / "record of the run").string(),
                                                     .overrides = {},
                                                     .plugin_path = std::move(plugin_path),
                                                     .is_record = true});
  experiment.name = printable(archive.record("name"));
  return experiment;
}

}  // namespace evodevo
