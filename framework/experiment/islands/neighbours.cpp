#include "experiment/islands/neighbours.hpp"

#include <algorithm>
#include <set>

namespace evodevo {
namespace {

std::vector<std::int64_t> others(std::int64_t island, std::int64_t count) {
  std::vector<std::int64_t> all;
  for (std::int64_t other = 1; other <= count; ++other)
    if (other != island) all.push_back(other);
  return all;
}

std::vector<std::int64_t> around(std::int64_t island, const Grid& grid) {
  const std::int64_t row = (island - 1) / grid.columns, column = (island - 1) % grid.columns;
  const auto number = [&](std::int64_t r, std::int64_t c) {
    return (r + grid.rows) % grid.rows * grid.columns + (c + grid.columns) % grid.columns + 1;
  };
  // in two rows or columns, both neighbours on that axis are the same island
  const std::set<std::int64_t> found{number(row - 1, column), number(row + 1, column), number(row, column - 1),
                                     number(row, column + 1)};
  return {found.begin(), found.end()};
}

/// `step` is 1 for the next island on a ring, and -1 for the one before.
std::vector<std::int64_t> neighbours(std::int64_t island, const IslandSettings& islands, std::int64_t step) {
  const std::int64_t count = islands.count;
  switch (islands.topology) {
    case Topology::ring:
      return {(island - 1 + step + count) % count + 1};
    case Topology::torus:
      return around(island, torus_grid(count));
    case Topology::star:
      return island == 1 ? others(1, count) : std::vector<std::int64_t>{1};
    case Topology::full:
      break;
  }
  return others(island, count);
}

}  // namespace

Grid torus_grid(std::int64_t count) {
  Grid grid{1, count};
  for (std::int64_t rows = 2; rows * rows <= count; ++rows)
    if (count % rows == 0) grid = {rows, count / rows};
  return grid;
}

std::vector<std::int64_t> sources_of(std::int64_t island, const IslandSettings& islands) {
  return neighbours(island, islands, -1);
}

std::vector<std::int64_t> destinations_of(std::int64_t island, const IslandSettings& islands) {
  return neighbours(island, islands, 1);
}

std::int64_t most_sources(const IslandSettings& islands) {
  // the first island has as many as any other in all topologies
  return static_cast<std::int64_t>(sources_of(1, islands).size());
}

}  // namespace evodevo
