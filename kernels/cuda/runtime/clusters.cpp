#include "cuda/runtime/clusters.hpp"

#include <algorithm>

#include "cuda/layout/resident.hpp"
#include "cuda/runtime/launch.hpp"

namespace evodevo::cuda {

unsigned Clusters::largest(KernelStore& kernels) { return sizes(kernels).empty() ? 1 : sizes(kernels).back().blocks; }

unsigned Clusters::blocks_for(std::size_t bodies, KernelStore& kernels) {
  unsigned most = 1;
  for (const Size& size : sizes(kernels))
    if (size.room >= bodies) most = std::max(most, size.blocks);
  return most;
}

const std::vector<Clusters::Size>& Clusters::sizes(KernelStore& kernels) {
  if (largest_ > 1) std::call_once(asked_, [&] { ask(kernels); });
  return sizes_;
}

void Clusters::ask(KernelStore& kernels) {
  const cudaKernel_t kernel = kernels.get("cuda/device/full_block.cu", "evodevo_full_block", {});
  const std::size_t chip = Resident<float>::largest_chip(device_.shared_bytes, true);
  allow(kernel, chip, true);
  for (const unsigned blocks : cluster_sizes) {
    if (blocks == 1 || blocks > largest_) continue;
    const ClusterLaunch launch(blocks, blocks, 1024, chip, nullptr);
    int room = 0;
    const cudaError_t error =
        cudaOccupancyMaxActiveClusters(&room, reinterpret_cast<const void*>(kernel), &launch.config);
    if (error != cudaSuccess) cudaGetLastError();  // the device is not capable of clusters of that size
    if (error == cudaSuccess && room > 0) sizes_.push_back({blocks, static_cast<std::size_t>(room)});
  }
}

}  // namespace evodevo::cuda
