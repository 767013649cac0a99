// The k nearest neighbours of every point of a cloud, on the CPU.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/neighbour_search.hpp"

namespace evodevo {

/// The pairs (i, j), i < j, in which one point is among the k nearest of the other; of equally near points the one of
/// lower index counts as nearer. The pairs are sorted, and each is there once. If k is not less than the number of
/// points, all pairs are joined. `positions` in m; all squared distances must be finite.
std::vector<IndexPair> nearest_pairs(std::span<const Vec3> positions, std::uint32_t k);

/// A search that uses the CPU alone.
std::unique_ptr<NeighbourSearch> make_cpu_neighbour_search();

}  // namespace evodevo
