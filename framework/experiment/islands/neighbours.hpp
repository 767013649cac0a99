// The islands that exchange migrants.
#pragma once

#include <cstdint>
#include <vector>

#include "experiment/settings.hpp"

namespace evodevo {

/// The rows and columns of a torus: the factors of the number of islands that differ least, rows <= columns. A prime
/// number has only one row, which is a ring and no torus.
struct Grid {
  std::int64_t rows = 1, columns = 1;
};
Grid torus_grid(std::int64_t count);

/// Returns the numbers of the islands that send migrants to an island, in ascending order, each once. Islands are
/// numbered from 1; on a torus, row by row. On a ring, each island sends to the one with the next number, and the last
/// one to the first. In the other topologies, islands send to those from which they receive.
std::vector<std::int64_t> sources_of(std::int64_t island, const IslandSettings& islands);

/// Returns the numbers of the islands to which an island sends migrants, in ascending order, each once.
std::vector<std::int64_t> destinations_of(std::int64_t island, const IslandSettings& islands);

/// Returns the largest number of islands from which one island receives.
std::int64_t most_sources(const IslandSettings& islands);

}  // namespace evodevo
