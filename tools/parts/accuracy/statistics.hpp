// How well one ranking of robots tells what another tells.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace evodevo::tools::accuracy {

/// The ranks of `values` from 0, equals sharing the mean of theirs; what is not a number counts as less than any.
std::vector<double> ranks(std::span<const double> values);

/// Spearman's rank correlation; 0 where one side is all equal, for then it tells nothing.
double rank_correlation(std::span<const double> a, std::span<const double> b);

struct Interval {
  double low = 0, high = 0;
};

/// The interval that holds 95 % of the rank correlations of samples drawn with replacement (Efron's percentile
/// bootstrap); the same for the same numbers.
Interval bootstrap_interval(std::span<const double> a, std::span<const double> b, int samples);

/// Of random groups of `group`, how often the best by `estimate` is among the best `top` by `truth`; of equally good
/// ones, the first of a group drawn in random order is taken.
double best_found(std::span<const double> truth, std::span<const double> estimate, std::size_t group, std::size_t top,
                  int draws);

}  // namespace evodevo::tools::accuracy
