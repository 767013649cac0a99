#include "common/agreement.hpp"

#include <algorithm>
#include <functional>
#include <numeric>
#include <vector>

namespace evodevo::tools {

double share_found(std::span<const double> truth, std::span<const double> estimate, std::size_t count) {
  std::vector<double> falling(estimate.begin(), estimate.end());
  std::sort(falling.begin(), falling.end(), std::greater<>());
  const double last = falling[count - 1];
  const auto equals = std::equal_range(falling.begin(), falling.end(), last, std::greater<>());
  const auto room = static_cast<double>(count) - static_cast<double>(equals.first - falling.begin());
  const double chance = room / static_cast<double>(equals.second - equals.first);

  std::vector<std::size_t> by_truth(truth.size());
  std::iota(by_truth.begin(), by_truth.end(), std::size_t{0});
  std::stable_sort(by_truth.begin(), by_truth.end(), [&](auto i, auto j) { return truth[i] > truth[j]; });
  double found = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double value = estimate[by_truth[i]];
    found += value > last ? 1 : value == last ? chance : 0;
  }
  return found / static_cast<double>(count);
}

}  // namespace evodevo::tools
