#include "cuda/kernels.hpp"

#include <exception>

#include "cuda/error.hpp"

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

KernelStore::~KernelStore() {
  for (const auto& [key, library] : libraries_) {
    try {
      cudaLibraryUnload(library.get());
    } catch (const std::exception&) {  // one that could not be loaded
    }
  }
}

cudaKernel_t KernelStore::get(const std::string& source, const std::string& function,
                              const std::vector<std::string>& definitions) {
  std::string key = source;
  for (const std::string& definition : definitions) key += ' ' + definition;
  std::shared_future<cudaLibrary_t> library;
  {
    const std::lock_guard lock(mutex_);
    std::shared_future<cudaLibrary_t>& entry = libraries_[key];
    // deferred: the first who waits for it loads it, outside the lock; all others wait for that
    if (!entry.valid())
      entry = std::async(std::launch::deferred, load_library, source, definitions, architecture_, more_).share();
    library = entry;
  }
  cudaKernel_t kernel = nullptr;
  check(cudaLibraryGetKernel(&kernel, library.get(), function.c_str()), "looking up " + function);
  return kernel;
}

}  // namespace evodevo::cuda
