// Failures of the CUDA runtime in words.
#pragma once

#include <cuda_runtime_api.h>

#include <string>

namespace evodevo::cuda {

/// Throws std::runtime_error where `result` is a failure: `what` was attempted ("copying bodies to the device"), the
/// runtime's words, and a remedy where there is one.
void check(cudaError_t result, const std::string& what);

}  // namespace evodevo::cuda
