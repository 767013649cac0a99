// The GPU that bodies are simulated on.
#pragma once

#include <cstddef>
#include <string>

namespace evodevo::cuda {

struct Device {
  std::string name;          ///< such as "NVIDIA H200"
  std::string architecture;  ///< such as "sm_90"
  std::size_t shared_bytes;  ///< shared memory that one block can have
};

/// The current CUDA device. Throws std::runtime_error where there is none that can be used.
Device current_device();

/// Bytes of the device's memory that nobody uses.
std::size_t free_memory();

}  // namespace evodevo::cuda
