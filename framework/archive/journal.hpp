// The name of a run's file, and the choice of SQLite's journal for it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>

namespace evodevo {

/// The name of a run's file in the folder of the run.
inline constexpr const char* database_name = "run.sqlite";

/// How SQLite makes transactions atomic.
enum class Journal {
  wal,      ///< write-ahead log: readers and the writer do not wait for each other; processes must share memory
  rollback  ///< rollback journal: works wherever files can be locked; readers and the writer wait for each other
};

/// Returns SQLite's name for a journal: "wal" or "delete".
const char* name(Journal journal);
/// Returns the journal with this name, or nullopt if there is none.
std::optional<Journal> journal_named(std::string_view name);

/// Returns whether a file system of this type (statfs.f_type) may be on another machine or in user space, so that
/// processes cannot share memory through its files.
bool is_remote(std::uint32_t file_system_type);

/// Returns the journal that should work in a folder, judging by the type of its file system.
Journal journal_for(const std::filesystem::path& folder);

}  // namespace evodevo
