// The kernels that a simulator needs, loaded onto the device.
#pragma once

#include <cuda_runtime_api.h>

#include <map>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "cuda/runtime/compiler.hpp"

namespace evodevo::cuda {

/// Kernels of one device, each compiled and loaded when it is first asked for, and kept; one for which there is no
/// memory is tried again when it is asked for again. May be used from several threads, which compile different kernels
/// at the same time.
class KernelStore {
 public:
  /// `more`: sources beside the embedded ones; they must outlive the store.
  explicit KernelStore(std::string architecture, std::span<const EmbeddedSource> more = {})
      : architecture_(std::move(architecture)), more_(more) {}
  KernelStore(const KernelStore&) = delete;
  KernelStore& operator=(const KernelStore&) = delete;
  ~KernelStore();

  /// The kernel `function` of the source `source`.
  cudaKernel_t get(const std::string& source, const std::string& function, const std::vector<std::string>& definitions);

 private:
  struct Library {
    std::mutex loading;
    cudaLibrary_t handle = nullptr;
  };

  std::string architecture_;
  std::span<const EmbeddedSource> more_;
  std::mutex mutex_;
  std::map<std::string, Library> libraries_;
};

}  // namespace evodevo::cuda
