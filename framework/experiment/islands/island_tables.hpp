// The tables [islands] and [[island]], and the experiments of the single islands.
#pragma once

#include <cstdint>
#include <vector>

#include "experiment/tables/tables.hpp"

namespace evodevo {

/// Reads [islands]. To be called after [experiment] has been read.
void read_island_settings(TomlReader& top, Settings& settings);

/// Checks [[island]], of which each table changes one island. Its operators are read only with the experiment of that
/// island. To be called after read_island_settings().
void check_island_tables(TomlReader& top, const Settings& settings);

/// Returns the seed of an island, numbered from 1, that has no seed of its own.
std::int64_t island_seed(std::int64_t run_seed, std::int64_t island);

/// Returns the text of the experiment of each island, numbered from 1: `root` with the tables of operators and the seed
/// that the island has of its own, or else with a seed from the run's, and with its part of the run's evaluations and
/// spring evaluations. `settings` are those of `root`, whose [[island]] tables have been checked. Throws ConfigError if
/// there are fewer evaluations than islands.
std::vector<toml::table> island_roots(const toml::table& root, const Settings& settings);

}  // namespace evodevo
