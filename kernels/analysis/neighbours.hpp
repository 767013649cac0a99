// k-nearest neighbours.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/neighbour_search.hpp"

namespace evodevo {

/// Every pair (i, j), i < j, in which one position is among the k nearest of the other; ties go to the lower index.
/// Sorted, each pair once. k >= the number of positions joins all. Distances must be finite when squared.
std::vector<IndexPair> nearest_pairs(std::span<const Vec3> positions, std::uint32_t k);

/// A search on the workers alone.
std::unique_ptr<NeighbourSearch> make_cpu_neighbour_search();

}  // namespace evodevo
