// The ways of recording stress that the paper tried.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "paper/paper_simulator.hpp"

namespace evodevo::tools::bench {

/// Returns the name of each way of recording stress, with a copy of `plain` that records stress in that way.
inline std::vector<std::pair<std::string, PaperMethod>> stress_methods(PaperMethod plain) {
  std::vector<std::pair<std::string, PaperMethod>> methods;
  plain.stress = StressMethod::sums;
  methods.emplace_back("atomic sums", plain);
  plain.stress = StressMethod::extremes;
  methods.emplace_back("minimum and maximum of all springs", plain);
  plain.stress = StressMethod::skip_shift;
  for (const std::uint32_t skip : {1u, 10u, 100u, 500u}) {
    plain.skip = skip;
    methods.emplace_back("Skip-Shift at skip " + std::to_string(skip), plain);
  }
  return methods;
}

}  // namespace evodevo::tools::bench
