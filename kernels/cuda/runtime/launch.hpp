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

/// The form of a launch of clusters.
struct ClusterLaunch {
  ClusterLaunch(unsigned cluster, unsigned blocks, unsigned threads, std::size_t shared_bytes, cudaStream_t stream) {
    size.id = cudaLaunchAttributeClusterDimension;
    size.val.clusterDim = {cluster, 1, 1};
    config.gridDim = dim3(blocks);
    config.blockDim = dim3(threads);
    config.dynamicSmemBytes = shared_bytes;
    config.stream = stream;
    config.attrs = &size;
    config.numAttrs = 1;
  }
  ClusterLaunch(const ClusterLaunch&) = delete;

  cudaLaunchAttribute size{};
  cudaLaunchConfig_t config{};  ///< refers to `size`
};

/// Launches `blocks` blocks in clusters of `cluster` blocks; a cluster of one block is an ordinary block.
template <class... Arguments>
void launch_clusters(cudaKernel_t kernel, unsigned cluster, unsigned blocks, unsigned threads, std::size_t shared_bytes,
                     cudaStream_t stream, Arguments... arguments) {
  if (cluster == 1) return launch(kernel, dim3(blocks), threads, shared_bytes, stream, arguments...);
  void* pointers[] = {&arguments...};
  const ClusterLaunch form(cluster, blocks, threads, shared_bytes, stream);
  check(cudaLaunchKernelExC(&form.config, reinterpret_cast<const void*>(kernel), pointers), "starting a kernel");
}

/// Allows a kernel to have blocks with up to `shared_bytes` of shared memory and, if `in_clusters`, clusters of more
/// blocks than every GPU is capable of. The same kernel must always be given the same values, because other threads may
/// be launching it.
inline void allow(cudaKernel_t kernel, std::size_t shared_bytes, bool in_clusters) {
  const void* const function = reinterpret_cast<const void*>(kernel);
  check(cudaFuncSetAttribute(function, cudaFuncAttributeMaxDynamicSharedMemorySize, static_cast<int>(shared_bytes)),
        "asking for shared memory");
  if (in_clusters)
    check(cudaFuncSetAttribute(function, cudaFuncAttributeNonPortableClusterSizeAllowed, 1), "asking for clusters");
}

}  // namespace evodevo::cuda
