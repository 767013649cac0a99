// The kernels that a simulator needs, loaded onto the device.
#pragma once

#include <cuda_runtime_api.h>

#include <future>
#include <map>
#include <mutex>
#include <string>
#include <vector>

namespace evodevo::cuda {

/// Kernels of one device, each compiled and loaded when it is first asked for, and kept. May be used from several
/// threads, which compile different kernels at the same time.
class KernelStore {
 public:
  explicit KernelStore(std::string architecture) : architecture_(std::move(architecture)) {}
  KernelStore(const KernelStore&) = delete;
  KernelStore& operator=(const KernelStore&) = delete;
  ~KernelStore();

  /// The kernel `function` of the embedded source `source`.
  cudaKernel_t get(const std::string& source, const std::string& function, const std::vector<std::string>& definitions);

 private:
  std::string architecture_;
  std::mutex mutex_;
  std::map<std::string, std::shared_future<cudaLibrary_t>> libraries_;
};

}  // namespace evodevo::cuda
