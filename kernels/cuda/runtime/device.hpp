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

/// Why a driver for the CUDA version `driver` (1000 times the major plus 10 times the minor one; 0: there is none) does
/// not bear a program that is built with `runtime`; empty where it does.
std::string driver_obstacle(int driver, int runtime);

/// The current CUDA device. Throws std::runtime_error where there is none that can be used.
Device current_device();

/// Bytes of the device's memory that nobody uses.
std::size_t free_memory();

}  // namespace evodevo::cuda
