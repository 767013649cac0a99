// Statistics of scores.
#pragma once

#include <optional>
#include <vector>

namespace evodevo {

/// The best and the median of some numbers; nullopt if there are none.
struct BestAndMedian {
  std::optional<double> best, median;
};

/// Returns the best and the median of some numbers, of which more or fewer are better.
BestAndMedian best_and_median(std::vector<double> numbers, bool maximise);

}  // namespace evodevo
