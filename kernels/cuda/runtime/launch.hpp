// Launches a kernel.
#pragma once

#include <cuda_runtime_api.h>

#include <cstddef>

#include "cuda/runtime/error.hpp"

namespace evodevo::cuda {

/// Launches `kernel` on `stream` with `grid` blocks of `threads` threads, each block with `shared_bytes` of dynamic
/// shared memory. Throws if the launch fails.
template <class... Arguments>
void launch(cudaKernel_t kernel, dim3 grid, unsigned threads, std::size_t shared_bytes, cudaStream_t stream,
            Arguments... arguments) {
  void* pointers[] = {&arguments...};
  check(cudaLaunchKernel(reinterpret_cast<const void*>(kernel), grid, dim3(threads), pointers, shared_bytes, stream),
        "starting a kernel");
}

}  // namespace evodevo::cuda
