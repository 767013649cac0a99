// Kernels are compiled when they are needed, for the features that are asked for.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace evodevo::cuda {

/// A source file that is part of the program.
struct EmbeddedSource {
  std::string_view name;  ///< as #include has it
  std::string_view text;
};

/// All sources that kernels are made of; generated when evodevo is built.
const std::vector<EmbeddedSource>& embedded_sources();

/// Machine code of `name`, one of the embedded sources or of `more` such, for an architecture such as "sm_90", with
/// `definitions` such as "EVODEVO_STRESS=1". It is kept in $XDG_CACHE_HOME/evodevo/kernels (or ~/.cache), under a name
/// that changes with whatever it depends on; a cache that cannot be written is not used. Needs no GPU. Throws
/// std::runtime_error where CUDA's compiler does not know the architecture, and std::logic_error, with its messages,
/// where it finds errors.
std::vector<char> compile(std::string_view name, const std::vector<std::string>& definitions,
                          const std::string& architecture, std::span<const EmbeddedSource> more = {});

/// The same from other sources than the embedded ones, past the cache.
std::vector<char> compile(const std::vector<EmbeddedSource>& sources, std::string_view name,
                          const std::vector<std::string>& definitions, const std::string& architecture);

}  // namespace evodevo::cuda
