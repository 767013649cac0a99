// The tables of a run's SQLite file.
#pragma once

#include "archive/database.hpp"

namespace evodevo {

/// Version of the tables. It must be raised whenever the tables are changed in such a way that older programs cannot
/// read the new tables, or that this program cannot read the old ones.
inline constexpr const char* archive_format = "17";

void create_tables(RunDatabase& run);

/// Whether anything was ever committed to the file: Archive::create() writes the tables in one transaction.
bool has_tables(const RunDatabase& run);

/// Throws ArchiveError if the file holds no run, a run in another format, or tables that differ from those of a run.
/// The check also prevents a file from elsewhere from executing its own code, for example through views in place of
/// tables.
void check_tables(const RunDatabase& run);

}  // namespace evodevo
