// The kernels, compiled and loaded onto the device.
#pragma once

#include <cuda_runtime_api.h>

#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "cuda/runtime/compiler.hpp"

namespace evodevo::cuda {

/// The kernels for one architecture. Each kernel is compiled and loaded when it is first requested, and kept. If there
/// is too little memory to load it, the next request tries again. Several threads may use a store; they compile
/// different kernels at the same time.
class KernelStore {
 public:
  /// The store of all simulators and searches of this process on GPUs of an architecture, so that each kernel is
  /// compiled and loaded once. It exists as long as one of them holds it.
  static std::shared_ptr<KernelStore> of_architecture(const std::string& architecture);

  /// `more` holds source files in addition to the embedded ones. They must outlive the store.
  explicit KernelStore(std::string architecture, std::span<const EmbeddedSource> more = {})
      : architecture_(std::move(architecture)), more_(more) {}
  KernelStore(const KernelStore&) = delete;
  KernelStore& operator=(const KernelStore&) = delete;
  ~KernelStore();

  /// The kernel `function` of the source file `source`, compiled with `definitions`.
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
