"""Statistics for few runs: intervals of medians, rank tests and effect sizes.

Scores may be infinite, for example if no robot of a run has a fitness, but never NaN.
"""

import functools
import itertools
import math

import numpy
from scipy import optimize, stats

LEVEL = 0.95  # confidence level of intervals
SIGNIFICANT = 0.05  # level of significance: a difference counts as shown if p is below it
# Smallest number of values for an interval of the median. With fewer, the median lies between the lowest and the
# highest value with a probability below LEVEL.
INTERVAL_FROM = next(size for size in itertools.count(1) if 2 * 0.5**size <= 1 - LEVEL)
RESAMPLES = 9999  # number of bootstrap resamples
EXACT_UP_TO = 40  # largest total number of scores for the exact test, if there are no ties
EXACT_WITH_TIES_UP_TO = 16  # the same if there are ties; that test tries all ways to split the scores


def median(values):
    return float(numpy.median(values))


@functools.cache
def resampled_medians(values):
    """Returns the medians of bootstrap resamples. The result is deterministic."""
    draws = numpy.random.default_rng(1).choice(values, (RESAMPLES, len(values)))
    return numpy.median(draws, axis=1)


def median_interval(values):
    """Returns the percentile bootstrap interval of the median (Efron & Tibshirani 1993, chapter 13), or None if there
    are too few values."""
    if len(values) < INTERVAL_FROM:
        return None
    tails = (1 - LEVEL) / 2, (1 + LEVEL) / 2
    # scipy.stats.bootstrap interpolates between neighbours, which fails for infinite values; inverted_cdf picks one
    medians = resampled_medians(tuple(sorted(values)))
    return tuple(map(float, numpy.quantile(medians, tails, method="inverted_cdf")))


def rank_sum_test(a, b):
    """Returns the two-sided p of the Mann-Whitney U test, which tests whether one sample tends to higher values than
    the other."""
    ranks = stats.rankdata([*a, *b])  # ranks are finite even if scores are infinite
    values = len(set(ranks))
    if values == 1:
        return 1.0
    a, b = ranks[: len(a)], ranks[len(a) :]
    if values < len(ranks) <= EXACT_WITH_TIES_UP_TO:
        if lone := [*a] if len(a) == 1 else [*b] if len(b) == 1 else []:  # of which scipy makes no permutations
            middle = ranks.mean()
            return float((abs(ranks - middle) >= abs(lone[0] - middle)).mean())
        tested = stats.permutation_test((a, b), distance, vectorized=True, n_resamples=numpy.inf, alternative="greater")
        return float(tested.pvalue)
    method = "exact" if values == len(ranks) <= EXACT_UP_TO else "asymptotic"
    return float(stats.mannwhitneyu(a, b, method=method).pvalue)


def distance(a, b, axis):
    """Returns how far the sum of the ranks `a` is from its expected value under the null hypothesis."""
    of_a, of_b = a.shape[axis], b.shape[axis]
    return numpy.abs(a.sum(axis) - of_a * (of_a + of_b + 1) / 2)


def runs_for_verdict(tests):
    """Returns the smallest number of runs per sample with which the smallest possible p, times `tests` as in Holm's
    correction, is below SIGNIFICANT."""
    return next(size for size in itertools.count(1) if 2 * tests / math.comb(2 * size, size) < SIGNIFICANT)


def superiority(a, b):
    """Returns A12, the probability that a random value of `a` is above a random value of `b`; ties count half (Vargha &
    Delaney 2000)."""
    u = stats.rankdata([*a, *b])[: len(a)].sum() - len(a) * (len(a) + 1) / 2
    return float(u) / (len(a) * len(b))


def superiority_interval(a12, size_a, size_b):
    """Returns the interval of A12 for samples of these sizes: all values from which the observed `a12` differs by at most
    z times the standard deviation that belongs to that value.

    The standard deviation is that of Hanley & McNeil 1982, with the mean of both sizes in place of each, and the interval
    is method 5 of Newcombe 2006 (Statistics in Medicine 25:559).
    """
    z = stats.norm.ppf((1 + LEVEL) / 2)
    others = (size_a + size_b) / 2 - 1

    def excess(value):
        spread = 1 + others * ((1 - value) / (2 - value) + value / (1 + value))
        return (a12 - value) ** 2 - z * z * value * (1 - value) * spread / (size_a * size_b)

    def bound(end):
        return a12 if a12 == end else optimize.brentq(excess, end, a12 + 1e-9 * (end - a12))

    return bound(0.0), bound(1.0)


def holm(ps):
    """Returns the p values of several tests, adjusted so that they bound the probability of at least one false finding
    among all tests (Holm 1979)."""
    order = numpy.argsort(ps)
    adjusted = numpy.empty(len(ps))
    adjusted[order] = numpy.minimum(1, numpy.maximum.accumulate(numpy.take(ps, order) * numpy.arange(len(ps), 0, -1)))
    return adjusted.tolist()
