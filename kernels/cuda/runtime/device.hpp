// The GPU on which bodies are simulated.
#pragma once

#include <cstddef>
#include <string>

namespace evodevo::cuda {

struct Device {
  std::string name;          ///< such as "NVIDIA H200"
  std::string architecture;  ///< such as "sm_90"
  std::size_t shared_bytes;  ///< shared memory that one block can have
};

/// Returns the reason why a driver for the CUDA version `driver` cannot run a program that was built with the version
/// `runtime`; empty if it can. A version is 1000 times the major plus 10 times the minor number; a driver version of 0
/// means that there is no driver.
std::string driver_obstacle(int driver, int runtime);

/// The current CUDA device. Throws std::runtime_error if there is no usable one.
Device current_device();

/// The free memory of the device, bytes.
std::size_t free_memory();

}  // namespace evodevo::cuda
