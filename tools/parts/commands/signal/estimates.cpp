#include "signal/estimates.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/philox.hpp"
#include "life/measurement/combining.hpp"

namespace evodevo {
namespace {

constexpr std::size_t samples = 2000;
constexpr double least_defined = 0.9;  ///< share of the samples that must give a number for there to be an interval

std::vector<std::size_t> all_of(std::size_t count) {
  std::vector<std::size_t> indices(count);
  std::iota(indices.begin(), indices.end(), std::size_t{0});
  return indices;
}

/// Returns a percentile of sorted values, by linear interpolation.
double percentile(const std::vector<double>& sorted, double share) {
  const double place = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(place), above = std::min(below + 1, sorted.size() - 1);
  return std::lerp(sorted[below], sorted[above], place - static_cast<double>(below));
}

/// Returns a quotient, or nothing if it means nothing: if the divisor is 0, or so small that it is but rounding errors
/// of terms of the given size.
std::optional<double> quotient(double a, double b, double terms) {
  constexpr double rounding = 1e-13;
  if (!std::isfinite(a) || !std::isfinite(b) || !(std::abs(b) > rounding * terms)) return std::nullopt;
  return a / b;
}

}  // namespace

std::optional<Estimate> bootstrapped(std::size_t count, const Statistic& statistic) {
  if (count == 0) return std::nullopt;
  const std::optional<double> value = statistic(all_of(count));
  if (!value) return std::nullopt;
  Estimate estimate{*value, {}, {}};
  Rng rng(philox, {});
  std::vector<double> drawn;
  std::vector<std::size_t> sample(count);
  for (std::size_t i = 0; i < samples; ++i) {
    for (std::size_t& item : sample) item = rng.below(static_cast<std::uint32_t>(count));
    if (const std::optional<double> of_sample = statistic(sample)) drawn.push_back(*of_sample);
  }
  if (count < 2 || static_cast<double>(drawn.size()) < least_defined * samples) return estimate;
  std::ranges::sort(drawn);
  estimate.low = percentile(drawn, 0.025);
  estimate.high = percentile(drawn, 0.975);
  return estimate;
}

Scores ranked(const Scores& scores, bool maximise) {
  std::vector<double> all;
  for (const auto& of_genome : scores)
    for (const double score : of_genome)
      all.push_back(std::isnan(score) ? -std::numeric_limits<double>::infinity() : maximise ? score : -score);
  std::vector<std::size_t> order = all_of(all.size());
  std::ranges::sort(order, {}, [&](std::size_t i) { return all[i]; });
  std::vector<double> ranks(all.size());
  for (std::size_t first = 0, end = 0; first < order.size(); first = end) {
    while (end < order.size() && all[order[end]] == all[order[first]]) ++end;
    const double rank = static_cast<double>(first + end) / (2 * static_cast<double>(all.size()));
    for (std::size_t i = first; i < end; ++i) ranks[order[i]] = rank;
  }
  Scores table;
  auto next = ranks.begin();
  for (const auto& of_genome : scores) {
    const auto begin = next;
    next += static_cast<std::ptrdiff_t>(of_genome.size());
    table.emplace_back(begin, next);
  }
  return table;
}

std::optional<double> intraclass_correlation(const Scores& scores, std::span<const std::size_t> genomes) {
  if (genomes.size() < 2 || scores[genomes.front()].size() < 2) return std::nullopt;
  const auto n = static_cast<double>(genomes.size()), k = static_cast<double>(scores[genomes.front()].size());
  double sum = 0, largest = 0;
  for (const std::size_t genome : genomes)
    for (const double score : scores[genome]) {
      sum += score;
      largest = std::max(largest, std::abs(score));
    }
  const double mean = sum / (n * k);
  double between = 0, within = 0;
  for (const std::size_t genome : genomes) {
    const double own = std::accumulate(scores[genome].begin(), scores[genome].end(), 0.0) / k;
    between += k * (own - mean) * (own - mean);
    for (const double score : scores[genome]) within += (score - own) * (score - own);
  }
  between /= n - 1;
  within /= n * (k - 1);
  return quotient(between - within, between + (k - 1) * within, largest * largest);
}

std::optional<Estimate> repeatability(const Scores& scores) {
  return bootstrapped(scores.size(), [&](auto genomes) { return intraclass_correlation(scores, genomes); });
}

std::optional<double> regression(std::span<const Family> families, std::span<const std::size_t> which) {
  double weight = 0, x = 0, y = 0, largest = 0;
  for (const std::size_t i : which)
    for (const double parents : families[i].parents) {
      weight += families[i].weight;
      x += families[i].weight * parents;
      y += families[i].weight * families[i].children;
      largest = std::max(largest, std::abs(parents));
    }
  if (!(weight > 0)) return std::nullopt;
  x /= weight;
  y /= weight;
  double together = 0, alone = 0;
  for (const std::size_t i : which)
    for (const double parents : families[i].parents) {
      together += families[i].weight * (parents - x) * (families[i].children - y);
      alone += families[i].weight * (parents - x) * (parents - x);
    }
  return quotient(together, alone, weight * largest * largest);
}

std::optional<Estimate> heritability(std::span<const Family> families) {
  return bootstrapped(families.size(), [&](auto which) { return regression(families, which); });
}

std::optional<Estimate> median_of(const std::vector<double>& values) {
  return bootstrapped(values.size(), [&](auto which) -> std::optional<double> {
    std::vector<double> some;
    for (const std::size_t i : which) some.push_back(values[i]);
    const double median = combined(std::move(some), Over::median, true);
    return std::isfinite(median) ? std::optional(median) : std::nullopt;
  });
}

}  // namespace evodevo
