// The tables of a run's SQLite file.
#pragma once

#include "evolution/archive/database.hpp"

namespace evodevo {

/// Raised when a change of the tables keeps older programs from reading them, or this one from reading theirs.
inline constexpr const char* archive_format = "6";

void create_tables(RunDatabase& run);

/// Throws ArchiveError where the file holds no run, one of another format, or other tables than those of a run. Views
/// in their place would be code that comes with the data.
void check_tables(const RunDatabase& run);

}  // namespace evodevo
