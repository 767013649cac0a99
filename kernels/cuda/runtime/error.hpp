// Failures of the CUDA runtime in words.
#pragma once

#include <cuda_runtime_api.h>

#include <stdexcept>
#include <string>

namespace evodevo::cuda {

/// Memory that was asked for is not there, on the device or, where it cannot be swapped out, on the host.
class OutOfMemory : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Throws std::runtime_error, OutOfMemory where it is that, where `result` is a failure: `what` was attempted ("copying
/// bodies to the device"), the runtime's words, and a remedy where there is one.
void check(cudaError_t result, const std::string& what);

}  // namespace evodevo::cuda
