// The k nearest neighbours of every point of a cloud, on the CPU.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/neighbour_search.hpp"

namespace evodevo {

/// Returns the pairs (i, j), i < j, in which one point is among the k nearest of the other; of equally near points, the
/// one with the lower index counts as nearer. The pairs are sorted and unique. If k is not less than the number of
/// points, the result is all pairs. `positions` are in m; all squared distances must be finite.
std::vector<IndexPair> nearest_pairs(std::span<const Vec3> positions, std::uint32_t k);

/// Returns a search that uses only the CPU.
std::unique_ptr<NeighbourSearch> make_cpu_neighbour_search();

}  // namespace evodevo
