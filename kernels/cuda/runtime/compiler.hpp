// Compiles kernels at run time, for the features that a run needs.
//
//   source, definitions, architecture ─► key ─► machine code from the cache, or from NVRTC and then into the cache
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace evodevo::cuda {

/// A source file whose text is part of the program.
struct EmbeddedSource {
  std::string_view name;  ///< as in #include
  std::string_view text;
};

/// All source files of kernels. This function is generated when evodevo is built.
const std::vector<EmbeddedSource>& embedded_sources();

/// Machine code of the source file `name`, one of the embedded sources or of `more`, for an architecture such as
/// "sm_90", with `definitions` such as "EVODEVO_STRESS=true". The code is cached (cache.hpp) under a key that depends
/// on everything that the code depends on. Needs no GPU. Throws std::runtime_error if CUDA's compiler does not support
/// the architecture, and std::logic_error, with the compiler's messages, if the source has errors.
std::vector<char> compile(std::string_view name, const std::vector<std::string>& definitions,
                          const std::string& architecture, std::span<const EmbeddedSource> more = {});

/// The same from the given sources instead of the embedded ones, without the cache.
std::vector<char> compile(const std::vector<EmbeddedSource>& sources, std::string_view name,
                          const std::vector<std::string>& definitions, const std::string& architecture);

}  // namespace evodevo::cuda
