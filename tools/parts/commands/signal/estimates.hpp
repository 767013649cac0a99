// Estimates of what repeats in a score and of what children inherit of it, with intervals.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace evodevo {

/// A number with its 95 % interval. The interval is missing if too few resampled data give the number.
struct Estimate {
  double value = 0;
  std::optional<double> low, high;
};

/// Computes a number from those items that have the given indices, which may repeat; nothing if it is not defined.
using Statistic = std::function<std::optional<double>(std::span<const std::size_t>)>;

/// Returns a statistic of all of `count` items, with the interval between the 2.5th and the 97.5th percentile of its
/// values for 2,000 samples of `count` items, drawn with replacement (percentile bootstrap, Efron and Tibshirani 1993).
/// The samples are the same in every call. Nothing if the statistic of all items is not defined.
std::optional<Estimate> bootstrapped(std::size_t count, const Statistic& statistic);

/// Scores by genome, and for each genome by measurement. A measurement that failed has the score NaN.
using Scores = std::vector<std::vector<double>>;

/// Returns the ranks of all scores together, from 0 (worst) to 1 (best): of n scores, the k-th has (k - 1/2)/n, and
/// equal ones have the mean of their ranks. Failed measurements are equal, and worse than all others.
Scores ranked(const Scores& scores, bool maximise);

/// Returns the share of the variance of scores that lies between genomes: the one-way intraclass correlation ICC(1)
/// (Shrout and Fleiss 1979), which estimates how well a measurement agrees with another one of the same genome. All
/// genomes have equally many measurements. Nothing if there are fewer than two genomes or measurements, if one failed,
/// or if all scores are equal.
std::optional<double> intraclass_correlation(const Scores& scores, std::span<const std::size_t> genomes);
/// The same of all genomes, with an interval over genomes.
std::optional<Estimate> repeatability(const Scores& scores);

/// Parents and the mean score of their children.
struct Family {
  /// The score of the parent, or the mean of both parents, in each of several measurements.
  std::vector<double> parents;
  double children = 0;
  double weight = 0;  ///< number of the children
};

/// Returns the slope of the regression of the children's mean on the (mid-)parent's score (Falconer and Mackay 1996,
/// chapter 10). Every measurement of the parents is a point, so that the slope is that of one measurement. Nothing if
/// all parents are equal.
std::optional<double> regression(std::span<const Family> families, std::span<const std::size_t> which);
/// The same of all families, with an interval over families.
std::optional<Estimate> heritability(std::span<const Family> families);

/// Returns the median, with an interval over the values. Nothing without values, or if the median is infinite.
std::optional<Estimate> median_of(const std::vector<double>& values);

}  // namespace evodevo
