// The file of a run, and which of SQLite's journals it has while it is written.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>

namespace evodevo {

/// A run's file in its folder.
inline constexpr const char* database_name = "run.sqlite";

enum class Journal {
  wal,      ///< a write-ahead log: readers and the writer do not wait for each other; needs memory that processes share
  rollback  ///< works wherever files can be locked; who writes and who reads wait for each other
};

/// "wal" or "delete", as SQLite calls them.
const char* name(Journal journal);
/// The journal with this name, or nullopt if there is none.
std::optional<Journal> journal_named(std::string_view name);

/// Whether a file system of this type (statfs.f_type) may lie on another machine, or in a program, so that processes do
/// not share memory through its files.
bool is_remote(std::uint32_t file_system_type);

/// The journal that works in a folder, as far as its file system tells.
Journal journal_for(const std::filesystem::path& folder);

}  // namespace evodevo
