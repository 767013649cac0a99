// The small experiment with other values.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "support/experiments.hpp"

namespace evodevo::testing {

/// Returns the small experiment with the first occurrence of each text replaced.
inline std::string small_with(const std::vector<std::pair<std::string, std::string>>& changes) {
  std::string text = small_experiment;
  for (const auto& [from, to] : changes) {
    const std::size_t at = text.find(from);
    if (at == std::string::npos) throw std::logic_error("the small experiment has no " + from);
    text.replace(at, from.size(), to);
  }
  return text;
}

}  // namespace evodevo::testing
