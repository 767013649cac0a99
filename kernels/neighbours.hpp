// k-nearest neighbours.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "evodevo/body.hpp"

namespace evodevo {

/// Every pair (i, j), i < j, in which one place is among the k nearest of the other; ties go to the lower index.
/// Sorted, each pair once. k >= the number of places joins all.
std::vector<std::pair<std::uint32_t, std::uint32_t>> nearest_pairs(std::span<const Vec3> places, std::uint32_t k);

}  // namespace evodevo
