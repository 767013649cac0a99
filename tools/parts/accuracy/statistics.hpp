// How well two rankings of robots agree.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace evodevo::tools::accuracy {

/// The ranks of `values`, starting at 0; equal values share the mean of their ranks. NaN ranks below all numbers.
std::vector<double> ranks(std::span<const double> values);

/// Spearman's rank correlation; 0, by convention, if all values on one side are equal.
double rank_correlation(std::span<const double> a, std::span<const double> b);

struct Interval {
  double low = 0, high = 0;
};

/// The interval that holds 95 % of the rank correlations of samples drawn with replacement (Efron's percentile
/// bootstrap). The result is deterministic.
Interval bootstrap_interval(std::span<const double> a, std::span<const double> b, int samples);

/// Draws `draws` random groups of `group` robots; returns the share of groups whose best robot by `estimate` is among
/// the group's best `top` by `truth`. Ties in `estimate` are decided at random.
double best_found(std::span<const double> truth, std::span<const double> estimate, std::size_t group, std::size_t top,
                  int draws);

}  // namespace evodevo::tools::accuracy
