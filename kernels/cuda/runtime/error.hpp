// Failures of the CUDA runtime as exceptions with clear messages.
#pragma once

#include <cuda_runtime_api.h>

#include <string>

#include "core/simulator.hpp"

namespace evodevo::cuda {

/// The device has too little free memory, or the host too little memory that cannot be swapped out.
class OutOfMemory : public DeviceOutOfMemory {
 public:
  using DeviceOutOfMemory::DeviceOutOfMemory;
};

/// Throws if `result` is a failure: OutOfMemory, or std::runtime_error for any other. The message says what was
/// attempted (`what`, such as "copying bodies to the device"), the runtime's description of the failure, and a remedy
/// if one is known.
void check(cudaError_t result, const std::string& what);

}  // namespace evodevo::cuda
