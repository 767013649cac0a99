// Lexicase selection: an individual is chosen by some of many test cases, taken in a random order, so that specialists
// have a chance (Spector 2012; Helmuth et al. 2015). With real scores, small differences do not count (La Cava et al.
// 2016).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "evodevo/rng.hpp"

namespace evodevo {

/// The scores of one individual, one for each test case; greater is better.
using CaseScores = std::span<const double>;

/// Returns the median of numbers, of which there is at least one. Of an even number, it is the mean of the middle two.
inline double median(std::vector<double> numbers) {
  const auto middle = numbers.begin() + static_cast<std::ptrdiff_t>(numbers.size() / 2);
  std::nth_element(numbers.begin(), middle, numbers.end());
  if (numbers.size() % 2 == 1) return *middle;
  return *middle / 2 + *std::max_element(numbers.begin(), middle) / 2;
}

/// Returns, for each case, the median absolute deviation of the scores from their median: the difference between two
/// scores that does not count (La Cava et al. 2016).
inline std::vector<double> median_deviations(const std::vector<CaseScores>& individuals) {
  std::vector<double> deviations;
  for (std::size_t test = 0; !individuals.empty() && test < individuals.front().size(); ++test) {
    std::vector<double> scores;
    for (const CaseScores& one : individuals) scores.push_back(one[test]);
    const double middle = median(scores);
    for (double& score : scores) score = std::abs(score - middle);
    deviations.push_back(median(scores));
  }
  return deviations;
}

/// Draws one of the individuals, of which there is at least one, and returns its index. In each case, those stay whose
/// score is at most `tolerance[case]` lower than the best score of those that were left.
inline std::uint32_t draw_lexicase(const std::vector<CaseScores>& individuals, std::span<const double> tolerance,
                                   Rng& rng) {
  std::vector<std::uint32_t> left(individuals.size()), cases(tolerance.size());
  std::iota(left.begin(), left.end(), 0u);
  std::iota(cases.begin(), cases.end(), 0u);
  rng.shuffle(cases);
  for (const std::uint32_t test : cases) {
    if (left.size() == 1) break;
    double best = individuals[left.front()][test];
    for (const std::uint32_t i : left) best = std::max(best, individuals[i][test]);
    std::erase_if(left, [&](std::uint32_t i) { return individuals[i][test] < best - tolerance[test]; });
  }
  return left[rng.below(static_cast<std::uint32_t>(left.size()))];
}

}  // namespace evodevo
