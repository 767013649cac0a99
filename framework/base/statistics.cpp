#include "base/statistics.hpp"

#include <algorithm>
#include <numeric>

namespace evodevo {

BestAndMedian best_and_median(std::vector<double> numbers, bool maximise) {
  if (numbers.empty()) return {};
  std::sort(numbers.begin(), numbers.end());
  const std::size_t half = numbers.size() / 2;
  return {maximise ? numbers.back() : numbers.front(),
          numbers.size() % 2 == 1 ? numbers[half] : std::midpoint(numbers[half - 1], numbers[half])};
}

}  // namespace evodevo
