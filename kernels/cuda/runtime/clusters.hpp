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
  explicit Clusters(const Device& device) : device_(device) {}

  /// The largest number of blocks for each of `bodies` bodies that the device can simulate at once, if each block needs
  /// a multiprocessor; 1 if there are too many bodies for clusters. The device is asked when this is first called for
  /// few bodies.
  unsigned blocks_for(std::size_t bodies, KernelStore& kernels);

 private:
  struct Size {
    unsigned blocks;   ///< in a cluster
    std::size_t room;  ///< number of clusters at once
  };

  void ask(KernelStore& kernels);

  Device device_;
  std::once_flag asked_;
  std::vector<Size> sizes_;
};

}  // namespace evodevo::cuda
