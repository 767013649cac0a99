// The GPUs on which bodies are simulated.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace evodevo::cuda {

struct Device {
  int number;                ///< from 0, among the GPUs that this process sees
  std::string name;          ///< such as "NVIDIA H200"
  std::string architecture;  ///< such as "sm_90"
  std::size_t shared_bytes;  ///< shared memory that one block can have
  unsigned multiprocessors;
  bool has_clusters;  ///< whether blocks can work together
};

/// Returns the reason why a driver for the CUDA version `driver` cannot run a program that was built with the version
/// `runtime`; empty if it can. A version is 1000 times the major plus 10 times the minor number; a driver version of 0
/// means that there is no driver.
std::string driver_obstacle(int driver, int runtime);

/// All GPUs that this process sees, in the order of their numbers; starts work on none of them. Throws
/// std::runtime_error if there is none.
std::vector<Device> visible_devices();

/// Whether both give equal results.
inline bool are_equal(const Device& a, const Device& b) {
  return a.name == b.name && a.architecture == b.architecture && a.shared_bytes == b.shared_bytes;
}

/// Returns the GPUs with these numbers, or all that equal the first one if no number is given. Throws
/// std::runtime_error if a number is not that of a visible GPU, or if the GPUs differ.
std::vector<Device> equal_devices(std::span<const Device> visible, std::span<const int> numbers);

/// Begins work on the GPUs with these numbers, and returns them. If no number is given, on all that equal the first
/// one, without those that cannot be used, for which it prints a warning. Throws std::runtime_error if a given GPU, or
/// all of them, cannot be used.
std::vector<Device> usable_devices(std::span<const int> numbers);

/// The GPU on which the calling thread works. Throws std::runtime_error if there is no usable one.
Device current_device();

/// Makes the GPU with this number the one on which the calling thread works, until the next call. Whatever uses a GPU
/// calls this first, because a thread works on different GPUs in turn. Throws std::runtime_error if the GPU cannot be
/// used, for example because another program holds it exclusively.
void work_on(const Device& device);

/// The free memory of the GPU on which the calling thread works, bytes.
std::size_t free_memory();

}  // namespace evodevo::cuda
