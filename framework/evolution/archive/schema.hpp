// The tables of a run's SQLite file.
#pragma once

#include "evolution/archive/database.hpp"

namespace evodevo {

/// Version of the tables. It must be raised whenever they change so that older programs cannot read the new tables, or
/// this program cannot read the old ones.
inline constexpr const char* archive_format = "6";

void create_tables(RunDatabase& run);

/// Throws ArchiveError if the file holds no run, a run of another format, or tables that differ from those of a run.
/// The check also keeps a foreign file from executing code of its own, such as views in the place of tables.
void check_tables(const RunDatabase& run);

}  // namespace evodevo
