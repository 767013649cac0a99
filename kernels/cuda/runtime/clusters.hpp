// How many clusters of thread blocks a device has room for. The blocks of a cluster are neighbours, so not every
// multiprocessor can be part of one of a given size.
#pragma once

#include <mutex>
#include <vector>

#include "cuda/runtime/device.hpp"
#include "cuda/runtime/kernels.hpp"

namespace evodevo::cuda {

class Clusters {
 public:
  /// Clusters have at most `largest` blocks. The device is asked for its room when a function is first called.
  Clusters(const Device& device, unsigned largest) : device_(device), largest_(device.has_clusters ? largest : 1) {}

  /// The largest number of blocks that can work together, each with a multiprocessor for itself.
  unsigned largest(KernelStore& kernels);

  /// The largest number of blocks for each of `bodies` bodies that the device can simulate at once, if each block needs
  /// a multiprocessor; 1 if there are too many bodies for clusters.
  unsigned blocks_for(std::size_t bodies, KernelStore& kernels);

 private:
  struct Size {
    unsigned blocks;   ///< in a cluster
    std::size_t room;  ///< number of clusters at once
  };

  const std::vector<Size>& sizes(KernelStore& kernels);
  void ask(KernelStore& kernels);

  Device device_;
  unsigned largest_;
  std::once_flag asked_;
  std::vector<Size> sizes_;  // of more than one block, in ascending order, for which there is room
};

}  // namespace evodevo::cuda
