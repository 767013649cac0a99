// Measures the search for nearest neighbours; only where the build option EVODEVO_CUDA is on.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>

namespace evodevo::benchmark {

/// A population whose neighbours are searched for.
struct NeighbourSettings {
  std::uint32_t bodies = 1024, masses = 1000;
  std::uint32_t neighbours = 25;  ///< of each mass
  int threads = 0;                ///< of the CPU; 0: all cores
  int runs = 5;                   ///< of which the median counts
};

/// How long the GPU and the CPU take for the same population of random balls, s, copies included, and how many times
/// faster the GPU is. Throws std::runtime_error where they do not find the same.
nlohmann::ordered_json measure_neighbours(const NeighbourSettings& settings);

}  // namespace evodevo::benchmark
