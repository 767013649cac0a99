#include "archive/archive.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <fstream>

#include "archive/genes.hpp"
#include "archive/schema.hpp"
#include "base/text.hpp"

namespace evodevo {
namespace {

namespace fs = std::filesystem;

constexpr const char* lock_name = "lock";
constexpr const char* journal_key =
    "journal";  ///< entry of the record with the journal that the user asked for, if any

std::string utc_now() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

/// Makes sure that a folder is still there after a loss of power, and so the folders above it, which may be new as
/// well. Where folders cannot be synchronised, nothing can be done about it.
void synchronise_entry_of(const fs::path& folder) {
  for (fs::path path = fs::absolute(folder).lexically_normal(); path.has_relative_path(); path = path.parent_path()) {
    const int above = open(path.parent_path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (above < 0) continue;
    fsync(above);
    close(above);
  }
}

FileLock locked(const fs::path& folder) { return FileLock(folder / lock_name); }

/// Throws ArchiveError if the folder has anything in it but what a process leaves that ends while it creates an
/// archive. A log or journal whose run.sqlite is gone is no such thing: there may be generations in it.
void require_empty(const fs::path& folder) {
  std::error_code error;
  const bool is_unfinished = fs::is_regular_file(folder / database_name, error) && !is_begun(folder);
  const fs::directory_iterator entries(folder);
  const auto may_stay = [&](const fs::directory_entry& entry) {
    const std::string name = entry.path().filename().string();
    return name == lock_name || (is_unfinished && name.starts_with(database_name));
  };
  if (!std::all_of(begin(entries), end(entries), may_stay))
    throw ArchiveError(folder.string() + ": is not empty; give another --out, or continue the run in it with `" +
                       shell_command({"resume", folder.string()}) + "`");
}

/// Throws ArchiveError unless the run's file in the folder is a regular file. Opening anything else, such as a pipe,
/// could block for ever.
void require_run(const fs::path& folder) {
  std::error_code error;
  if (has_islands(folder))
    throw ArchiveError(folder.string() +
                       ": is the folder of a run with islands; give the folder of one island, such as " +
                       (folder / island_folder_prefix).string() + "1");
  if (!fs::is_regular_file(folder / database_name, error))
    throw ArchiveError(folder.string() + ": there is no run here (no " + database_name + "); give a folder that `" +
                       program_name() + " run` has written");
}

std::optional<Journal> recorded_wish(const Archive& archive) {
  const auto wish = archive.find_record(journal_key);
  if (!wish) return std::nullopt;
  const auto journal = journal_named(*wish);
  if (!journal)
    archive.refuse(
        fmt::format("its entry \"{}\" is \"{}\", expected \"wal\" or \"delete\"", journal_key, printable(*wish)));
  return journal;
}

}  // namespace

bool has_islands(const fs::path& folder) {
  std::error_code error;
  return !fs::exists(folder / database_name, error) &&
         fs::is_directory(folder / (std::string(island_folder_prefix) + "1"), error);
}

bool is_begun(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_regular_file(folder / database_name, error)) return false;
  try {
    const RunDatabase run(folder, SQLite::OPEN_READWRITE, std::nullopt);
    run.sqlite().setBusyTimeout(0);  // does not wait for a process that is writing the run
    return has_tables(run);
  } catch (const std::runtime_error&) {
    return true;  // it holds something; whoever opens it says why it cannot be used
  }
}

Archive::Archive(std::unique_ptr<RunDatabase> run) : run_(std::move(run)) {}
Archive::Archive(Archive&&) noexcept = default;
Archive::~Archive() = default;

void begin_run_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error)
    throw ArchiveError(folder.string() + ": cannot be created: " + error.message() + "; give another place with --out");
  require_empty(folder);
  synchronise_entry_of(folder);
}

Archive Archive::create(const fs::path& folder, const Experiment& experiment, const std::string& device,
                        std::optional<Journal> journal) {
  begin_run_folder(folder);  // checked before locked(), which creates a file, and again when no other process can write
  auto lock = locked(folder);
  require_empty(folder);
  Archive archive(std::make_unique<RunDatabase>(folder, SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE, std::move(lock)));
  RunDatabase& run = *archive.run_;
  run.set_journal(journal);
  run.start_writing();
  WriteTransaction transaction(run);
  create_tables(run);
  for (std::size_t i = 0; i < experiment.objectives.size(); ++i) {
    const Objective& objective = experiment.objectives[i];
    Statement(run, "objectives", "INSERT INTO objectives VALUES(?, ?, ?, ?)")
        .execute(static_cast<std::uint32_t>(i), objective.name, objective.unit, objective.maximise ? 1 : 0);
  }
  for (std::size_t i = 0; i < experiment.measures.size(); ++i) {
    const Objective& measure = experiment.measures[i];
    const bool has_range = measure.role == Role::descriptor;
    Statement(run, "measures", "INSERT INTO measures VALUES(?, ?, ?, ?, ?, ?, ?)")
        .execute(static_cast<std::uint32_t>(i), measure.name, measure.unit, name(measure.role),
                 has_range ? std::optional(measure.low) : std::nullopt,
                 has_range ? std::optional(measure.high) : std::nullopt,
                 has_range ? std::optional(measure.bins) : std::nullopt);
  }
  const std::vector<NoteTitle> titles = experiment.note_titles();
  for (std::size_t i = 0; i < titles.size(); ++i)
    Statement(run, "note_titles", "INSERT INTO note_titles VALUES(?, ?, ?, ?)")
        .execute(static_cast<std::uint32_t>(i), titles[i].name, titles[i].unit, titles[i].is_label ? 1 : 0);
  for (std::size_t i = 0; i < experiment.scenarios.size(); ++i)
    Statement(run, "scenarios", "INSERT INTO scenarios VALUES(?, ?)")
        .execute(static_cast<std::uint32_t>(i), experiment.scenarios[i].name);
  for (const auto& [path, content] : experiment.files)
    Statement(run, "files", "INSERT INTO files VALUES(?, ?)").execute(path, std::string_view(content));
  insert_layout(run, experiment.layout);
  archive.insert_provenance(0, this_provenance(experiment, device));
  archive.insert_record("format", archive_format);
  archive.insert_record("evodevo", EVODEVO_VERSION);
  archive.insert_record("created", utc_now());
  archive.insert_record("name", experiment.name);
  archive.insert_record("seed", std::to_string(experiment.seed));
  archive.insert_record("experiment", experiment.resolved);
  if (experiment.island > 0) archive.insert_record("island", std::to_string(experiment.island));
  if (journal) archive.insert_record(journal_key, name(*journal));
  transaction.commit();
  return archive;
}

Archive Archive::resume(const fs::path& folder, std::optional<Journal> journal) {
  require_run(folder);
  auto lock = locked(folder);
  Archive archive(std::make_unique<RunDatabase>(folder, SQLite::OPEN_READWRITE, std::move(lock)));
  RunDatabase& run = *archive.run_;
  if (journal.value_or(journal_for(folder)) == Journal::rollback) run.prepare_for_rollback();
  check_tables(run);
  run.set_journal(journal ? journal : recorded_wish(archive));
  run.start_writing();
  if (journal) archive.set_record(journal_key, name(*journal));
  return archive;
}

Archive Archive::annotate(const fs::path& folder) {
  require_run(folder);
  Archive archive(std::make_unique<RunDatabase>(folder, SQLite::OPEN_READWRITE, std::nullopt));
  check_tables(*archive.run_);
  archive.run_->start_writing();
  return archive;
}

Archive Archive::read(const fs::path& folder) {
  require_run(folder);
  // opened for writing, because SQLite may have to recover a file that a killed process left behind
  Archive archive(std::make_unique<RunDatabase>(folder, SQLite::OPEN_READWRITE, std::nullopt));
  archive.run_->take_snapshot();
  check_tables(*archive.run_);
  return archive;
}

const fs::path& Archive::folder() const { return run_->folder(); }

bool Archive::is_in_place() const {
  try {
    run_->require_in_place();
    return true;
  } catch (const StorageError&) {
    return false;
  }
}

void Archive::refuse(const std::string& what) const { run_->refuse(what); }

}  // namespace evodevo
