#include "statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

namespace evodevo::tools::accuracy {
namespace {

/// Returns the values with each NaN replaced by minus infinity.
std::vector<double> ordered(std::span<const double> values) {
  std::vector<double> result(values.begin(), values.end());
  for (double& value : result)
    if (std::isnan(value)) value = -std::numeric_limits<double>::infinity();
  return result;
}

/// A random integer below `count` that is the same with every standard library; the distributions of the standard
/// library do not guarantee this.
std::size_t below(std::mt19937_64& random, std::size_t count) { return random() % count; }

double correlation(std::span<const double> a, std::span<const double> b) {
  const auto n = static_cast<double>(a.size());
  const double mean_a = std::accumulate(a.begin(), a.end(), 0.0) / n;
  const double mean_b = std::accumulate(b.begin(), b.end(), 0.0) / n;
  double ab = 0, aa = 0, bb = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    ab += (a[i] - mean_a) * (b[i] - mean_b);
    aa += (a[i] - mean_a) * (a[i] - mean_a);
    bb += (b[i] - mean_b) * (b[i] - mean_b);
  }
  return aa > 0 && bb > 0 ? ab / std::sqrt(aa * bb) : 0;
}

}  // namespace

std::vector<double> ranks(std::span<const double> values) {
  const std::vector<double> numbers = ordered(values);
  std::vector<std::size_t> order(numbers.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) { return numbers[i] < numbers[j]; });
  std::vector<double> result(numbers.size());
  for (std::size_t first = 0; first < order.size();) {
    std::size_t end = first + 1;
    while (end < order.size() && numbers[order[end]] == numbers[order[first]]) ++end;
    for (std::size_t i = first; i < end; ++i) result[order[i]] = static_cast<double>(first + end - 1) / 2;
    first = end;
  }
  return result;
}

double rank_correlation(std::span<const double> a, std::span<const double> b) {
  return correlation(ranks(a), ranks(b));
}

Interval bootstrap_interval(std::span<const double> a, std::span<const double> b, int samples) {
  std::mt19937_64 random(1);
  std::vector<double> drawn_a(a.size()), drawn_b(b.size()), found;
  for (int sample = 0; sample < samples; ++sample) {
    for (std::size_t i = 0; i < a.size(); ++i) {
      const std::size_t from = below(random, a.size());
      drawn_a[i] = a[from];
      drawn_b[i] = b[from];
    }
    found.push_back(rank_correlation(drawn_a, drawn_b));
  }
  std::sort(found.begin(), found.end());
  const auto at = [&](double part) { return found[static_cast<std::size_t>(part * static_cast<double>(samples - 1))]; };
  return {at(0.025), at(0.975)};
}

double best_found(std::span<const double> truth, std::span<const double> estimate, std::size_t group, std::size_t top,
                  int draws) {
  const std::vector<double> true_values = ordered(truth), estimates = ordered(estimate);
  std::mt19937_64 random(1);
  std::vector<std::size_t> members(truth.size());
  std::iota(members.begin(), members.end(), std::size_t{0});
  int found = 0;
  for (int draw = 0; draw < draws; ++draw) {
    for (std::size_t i = 0; i < group; ++i) std::swap(members[i], members[i + below(random, members.size() - i)]);
    const auto end = members.begin() + static_cast<std::ptrdiff_t>(group);
    const std::size_t best =
        *std::max_element(members.begin(), end, [&](auto i, auto j) { return estimates[i] < estimates[j]; });
    const auto better = std::count_if(members.begin(), end, [&](auto i) { return true_values[i] > true_values[best]; });
    found += static_cast<std::size_t>(better) < top;
  }
  return static_cast<double>(found) / draws;
}

}  // namespace evodevo::tools::accuracy
