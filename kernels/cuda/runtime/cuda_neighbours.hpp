// The search for nearest neighbours on an NVIDIA GPU. Exists only with the build option EVODEVO_CUDA.
#pragma once

#include <cstddef>
#include <memory>

#include "core/neighbour_search.hpp"
#include "cuda/runtime/device.hpp"

namespace evodevo {

/// A search on the current CUDA device. Throws std::runtime_error, with a message that names the cause and a remedy, if
/// there is no usable device; find() throws one if the device fails or has too little memory. Clouds that together need
/// more than `memory` bytes are searched in portions.
std::unique_ptr<NeighbourSearch> make_cuda_neighbour_search(std::size_t memory = std::size_t{1} << 29);
/// The same on a device, which becomes that of the calling thread.
std::unique_ptr<NeighbourSearch> make_cuda_neighbour_search(const cuda::Device& device,
                                                            std::size_t memory = std::size_t{1} << 29);

}  // namespace evodevo
