// The sources of the paper's methods as part of the program.
#pragma once

#include <vector>

#include "cuda/runtime/compiler.hpp"

namespace evodevo::tools::bench {

/// Generated when the benchmark is built.
const std::vector<cuda::EmbeddedSource>& paper_sources();

}  // namespace evodevo::tools::bench
