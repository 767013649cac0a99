#include "archive/schema.hpp"

#include <map>

#include "base/text.hpp"

namespace evodevo {
namespace {

constexpr const char* schema = R"sql(
CREATE TABLE record(key TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
-- what evaluates the individuals of the run; numbered from 0
CREATE TABLE provenances(provenance INTEGER PRIMARY KEY, device TEXT NOT NULL, evodevo TEXT NOT NULL, program TEXT NOT NULL);
CREATE TABLE operators(provenance INTEGER NOT NULL, kind TEXT NOT NULL, name TEXT NOT NULL, version TEXT NOT NULL,
  file TEXT NOT NULL, hash TEXT NOT NULL);
CREATE TABLE objectives(position INTEGER PRIMARY KEY, name TEXT NOT NULL, unit TEXT NOT NULL, maximise INTEGER NOT NULL);
-- scores that are not objectives
CREATE TABLE measures(position INTEGER PRIMARY KEY, name TEXT NOT NULL, unit TEXT NOT NULL, role TEXT NOT NULL,
  low REAL, high REAL, bins INTEGER);    -- of descriptors
CREATE TABLE scenarios(scenario INTEGER PRIMARY KEY, name TEXT NOT NULL);
-- contents of the files that parameters of operators name
CREATE TABLE files(path TEXT PRIMARY KEY, content BLOB NOT NULL) WITHOUT ROWID;
-- what the genes of individuals are: owners of sections, types of blocks and their genes, blocks of first genomes
CREATE TABLE sections(section INTEGER PRIMARY KEY, owner TEXT NOT NULL);
CREATE TABLE block_types(
  type INTEGER PRIMARY KEY, section INTEGER NOT NULL, name TEXT NOT NULL,
  least INTEGER NOT NULL, most INTEGER NOT NULL);
CREATE TABLE gene_types(
  type INTEGER NOT NULL, position INTEGER NOT NULL, name TEXT NOT NULL,
  low REAL NOT NULL, high REAL NOT NULL, choices INTEGER NOT NULL, refers_to INTEGER,
  PRIMARY KEY(type, position)) WITHOUT ROWID;
CREATE TABLE gene_options(
  type INTEGER NOT NULL, position INTEGER NOT NULL, option INTEGER NOT NULL, name TEXT NOT NULL,
  PRIMARY KEY(type, position, option)) WITHOUT ROWID;
CREATE TABLE first_blocks(
  block INTEGER PRIMARY KEY, type INTEGER NOT NULL, genes INTEGER NOT NULL, id INTEGER NOT NULL);
CREATE TABLE individuals(
  id INTEGER PRIMARY KEY,
  born INTEGER NOT NULL,                -- generation
  died INTEGER,                         -- generation whose selection dropped it; null while it lives
  origin INTEGER NOT NULL,              -- generation of its oldest genes
  parent INTEGER, mate INTEGER,         -- ids
  made_by TEXT NOT NULL,
  provenance INTEGER NOT NULL,          -- of its result
  lives INTEGER NOT NULL,               -- number of lives that it has had
  measured INTEGER NOT NULL,            -- generation in which the last of them were evaluated
  genes BLOB NOT NULL,                  -- float32, little-endian
  blocks BLOB,                          -- of sections whose blocks come and go
  status TEXT NOT NULL, reason TEXT, ended_at REAL,
  spring_evaluations INTEGER NOT NULL);
CREATE INDEX individuals_by_death ON individuals(died);
CREATE TABLE scores(
  individual INTEGER NOT NULL, objective INTEGER NOT NULL, value REAL NOT NULL,
  PRIMARY KEY(individual, objective)) WITHOUT ROWID;
CREATE TABLE measured(
  individual INTEGER NOT NULL, measure INTEGER NOT NULL, value REAL NOT NULL,
  PRIMARY KEY(individual, measure)) WITHOUT ROWID;
-- scores in each life, from which those above are made, of individuals that have had several
CREATE TABLE life_scores(
  individual INTEGER NOT NULL, life INTEGER NOT NULL, objective INTEGER NOT NULL, value REAL NOT NULL,
  PRIMARY KEY(individual, life, objective)) WITHOUT ROWID;
-- scores in each repeat of each scenario, from which those of a life are made
CREATE TABLE tests(
  individual INTEGER NOT NULL, life INTEGER NOT NULL, scenario INTEGER NOT NULL, repeat INTEGER NOT NULL,
  objective INTEGER NOT NULL, value REAL NOT NULL,
  PRIMARY KEY(individual, life, scenario, repeat, objective)) WITHOUT ROWID;
-- what the selection operator noted about individuals; a number holds until the generation that has another one
CREATE TABLE note_titles(position INTEGER PRIMARY KEY, name TEXT NOT NULL, unit TEXT NOT NULL, is_label INTEGER NOT NULL);
CREATE TABLE notes(
  individual INTEGER NOT NULL, note INTEGER NOT NULL, generation INTEGER NOT NULL, value REAL NOT NULL,
  PRIMARY KEY(individual, note, generation)) WITHOUT ROWID;
-- what the operator that chooses the survivors, or another one that chooses the parents, remembers after the last
-- generation: lists of numbers by name
CREATE TABLE memory(
  role TEXT NOT NULL, name TEXT NOT NULL, generation INTEGER NOT NULL, version INTEGER NOT NULL,
  numbers BLOB NOT NULL,                -- float64, little-endian
  PRIMARY KEY(role, name));
-- what development did in each life of those who reached the front; see life_record.hpp
CREATE TABLE lives(
  individual INTEGER NOT NULL, life INTEGER NOT NULL, record BLOB NOT NULL, PRIMARY KEY(individual, life));
CREATE TABLE generations(
  generation INTEGER PRIMARY KEY, evaluations INTEGER NOT NULL, best REAL, median REAL,
  diverged INTEGER NOT NULL, invalid INTEGER NOT NULL, artefact INTEGER NOT NULL, lucky INTEGER NOT NULL,
  passive INTEGER NOT NULL, clones INTEGER NOT NULL,
  spring_evaluations INTEGER NOT NULL, wall_time REAL NOT NULL);
-- who came from, and left for, other islands of the run, which are numbered from 1; those who came from island 0 are of
-- the run that [experiment] start names
CREATE TABLE immigrants(individual INTEGER PRIMARY KEY, island INTEGER NOT NULL, source INTEGER NOT NULL);
CREATE TABLE emigrants(
  generation INTEGER NOT NULL, island INTEGER NOT NULL, individual INTEGER NOT NULL,
  PRIMARY KEY(generation, island, individual)) WITHOUT ROWID;
CREATE TABLE verifications(
  individual INTEGER NOT NULL, trial TEXT NOT NULL, position INTEGER NOT NULL,
  status TEXT NOT NULL, reason TEXT, value REAL,  -- of the first objective
  PRIMARY KEY(individual, trial)) WITHOUT ROWID;
-- what of its scores selection can use, as far as it was measured
CREATE TABLE signal(
  position INTEGER PRIMARY KEY, population TEXT NOT NULL, quantity TEXT NOT NULL, of TEXT NOT NULL, scale TEXT NOT NULL,
  value REAL NOT NULL, low REAL, high REAL, count INTEGER NOT NULL);
-- who lived on after each generation, and how old its genes were then
CREATE VIEW members AS
  SELECT generation, id AS individual, generation - origin AS age
  FROM generations JOIN individuals ON born <= generation AND (died IS NULL OR died > generation);
)sql";

/// The objects of a database, such as tables and views: the SQL statement that created each one, by its name.
using Things = std::map<std::string, std::string>;

Things things_in(SQLite::Database& database) {
  Things things;
  SQLite::Statement row(database, "SELECT name, sql FROM sqlite_master WHERE sql IS NOT NULL");
  while (row.executeStep()) things[row.getColumn(0).getString()] = row.getColumn(1).getString();
  return things;
}

const Things& things_of_a_run() {
  static const Things things = [] {
    SQLite::Database database(":memory:", SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
    database.exec(schema);
    return things_in(database);
  }();
  return things;
}

[[noreturn]] void refuse_foreign(const RunDatabase& run, const std::string& what) {
  throw ArchiveError(run.folder().string() + ": is not the folder of a run: " + database_name + " " + what +
                     "; give a folder that `" + program_name() + " run` has written");
}

std::string recorded(const RunDatabase& run, const char* key) {
  Statement row(run, "record", "SELECT value FROM record WHERE key = ?");
  row.bind(key);
  return row.step() ? row.text(0) : "none";
}

void check_format(const RunDatabase& run) {
  const std::string format = recorded(run, "format");
  if (format == archive_format) return;
  throw ArchiveError(run.folder().string() + ": has format " + format + ", this evodevo reads format " +
                     archive_format + "; use the evodevo that wrote it, " + recorded(run, "evodevo"));
}

}  // namespace

void create_tables(RunDatabase& run) { run.execute(schema); }

bool has_tables(const RunDatabase& run) {
  return run.guarded([&] { return !things_in(run.sqlite()).empty(); });
}

void check_tables(const RunDatabase& run) {
  const Things here = run.guarded([&] { return things_in(run.sqlite()); });
  if (here.empty())
    throw ArchiveError(run.folder().string() + ": the run in it ended before it stored anything; if there was a " +
                       database_name + "-wal beside " + database_name +
                       ", put that back; otherwise begin the run again in another folder");
  const auto check = [&](const std::string& name) {
    const auto found = here.find(name);
    if (found == here.end()) refuse_foreign(run, "lacks \"" + name + "\"");
    if (found->second != things_of_a_run().at(name)) refuse_foreign(run, "defines \"" + name + "\" in another way");
  };
  check("record");  // checked first, because the format in it says whether this program knows the other tables
  check_format(run);
  for (const auto& [name, sql] : things_of_a_run()) check(name);
}

}  // namespace evodevo
