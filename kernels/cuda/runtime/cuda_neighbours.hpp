// Nearest neighbours on an NVIDIA GPU; only where the build option EVODEVO_CUDA is on.
#pragma once

#include <cstddef>
#include <memory>

#include "analysis/neighbours.hpp"

namespace evodevo {

/// A search on the current CUDA device; `threads` cores (0: all) take part. Throws std::runtime_error, which says what
/// is missing and what to do, where there is no device, and in find() where it runs out of memory or fails. Clouds that
/// need more than `memory` bytes together are searched in portions.
std::unique_ptr<NeighbourSearch> make_cuda_neighbour_search(std::size_t memory = std::size_t{1} << 29);

}  // namespace evodevo
