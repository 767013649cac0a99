#include "cuda/runtime/clusters.hpp"

#include <algorithm>

#include "cuda/layout/resident.hpp"
#include "cuda/runtime/launch.hpp"

namespace evodevo::cuda {

unsigned Clusters::blocks_for(std::size_t bodies, KernelStore& kernels) {
  if (device_.largest_cluster == 1 || 2 * bodies > device_.multiprocessors) return 1;
  std::call_once(asked_, [&] { ask(kernels); });
  unsigned most = 1;
  for (const Size& size : sizes_)
    if (size.room >= bodies) most = std::max(most, size.blocks);
  return most;
}

void Clusters::ask(KernelStore& kernels) {
  const cudaKernel_t kernel = kernels.get("cuda/device/full_block.cu", "evodevo_full_block", {});
  const std::size_t chip = Resident<float>::largest_chip(device_.shared_bytes);
  allow(kernel, chip, device_.largest_cluster);
  for (const unsigned blocks : cluster_sizes) {
    if (blocks == 1 || blocks > device_.largest_cluster) continue;
    const ClusterLaunch launch(blocks, blocks, 1024, chip, nullptr);
    int room = 0;
    check(cudaOccupancyMaxActiveClusters(&room, reinterpret_cast<const void*>(kernel), &launch.config),
          "asking for the room for clusters");
    sizes_.push_back({blocks, static_cast<std::size_t>(std::max(room, 0))});
  }
}

}  // namespace evodevo::cuda
