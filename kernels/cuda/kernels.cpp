#include "cuda/kernels.hpp"

#include "cuda/error.hpp"

namespace evodevo::cuda {

KernelStore::~KernelStore() {
  for (const auto& [key, library] : libraries_) cudaLibraryUnload(library);
}

cudaKernel_t KernelStore::get(const std::string& source, const std::string& function,
                              const std::vector<std::string>& definitions) {
  std::string key = source;
  for (const std::string& definition : definitions) key += ' ' + definition;
  auto found = libraries_.find(key);
  if (found == libraries_.end()) {
    const std::vector<char> code = compile(source, definitions, architecture_, more_);
    cudaLibrary_t library = nullptr;
    check(cudaLibraryLoadData(&library, code.data(), nullptr, nullptr, 0, nullptr, nullptr, 0),
          "loading a kernel of " + source);
    found = libraries_.emplace(key, library).first;
  }
  cudaKernel_t kernel = nullptr;
  check(cudaLibraryGetKernel(&kernel, found->second, function.c_str()), "looking up " + function);
  return kernel;
}

}  // namespace evodevo::cuda
