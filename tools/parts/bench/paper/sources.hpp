// The CUDA sources of the paper's methods, embedded in the program.
#pragma once

#include <vector>

#include "cuda/runtime/compiler.hpp"

namespace evodevo::tools::bench {

/// Returns the sources. This function is generated when the benchmark is built.
const std::vector<cuda::EmbeddedSource>& paper_sources();

}  // namespace evodevo::tools::bench
