#include "cuda/runtime/kernels.hpp"

#include "cuda/runtime/error.hpp"
#include "cuda/runtime/shared.hpp"

namespace evodevo::cuda {

namespace {

cudaLibrary_t load_library(const std::string& source, const std::vector<std::string>& definitions,
                           const std::string& architecture, std::span<const EmbeddedSource> more) {
  const std::vector<char> code = compile(source, definitions, architecture, more);
  cudaLibrary_t library = nullptr;
  check(cudaLibraryLoadData(&library, code.data(), nullptr, nullptr, 0, nullptr, nullptr, 0),
        "loading a kernel of " + source);
  return library;
}

}  // namespace

std::shared_ptr<KernelStore> KernelStore::of_architecture(const std::string& architecture) {
  static Shared<std::string, KernelStore> stores;
  return stores.get(architecture, [&] { return std::make_shared<KernelStore>(architecture); });
}

KernelStore::~KernelStore() {
  for (const auto& [key, library] : libraries_)
    if (library.handle != nullptr) cudaLibraryUnload(library.handle);
}

cudaKernel_t KernelStore::get(const std::string& source, const std::string& function,
                              const std::vector<std::string>& definitions) {
  std::string key = source;
  for (const std::string& definition : definitions) key += ' ' + definition;
  Library* library = nullptr;
  {
    const std::lock_guard lock(mutex_);
    library = &libraries_[key];
  }
  {
    // the first thread loads the library, others wait for it
    const std::lock_guard lock(library->loading);
    if (library->handle == nullptr) library->handle = load_library(source, definitions, architecture_, more_);
  }
  cudaKernel_t kernel = nullptr;
  check(cudaLibraryGetKernel(&kernel, library->handle, function.c_str()), "looking up " + function);
  return kernel;
}

}  // namespace evodevo::cuda
