"""What can be inferred from few runs: intervals of medians, rank tests and effect sizes.

Scores may be infinite, as that of a run in which no robot has a fitness, but never NaN.
"""

import functools
import itertools
import math

import numpy
from scipy import optimize, stats

LEVEL = 0.95  # of intervals
SIGNIFICANT = 0.05  # what p must be below
# values; of fewer, even the lowest and the highest have the median between them less often than LEVEL says
INTERVAL_FROM = next(size for size in itertools.count(1) if 2 * 0.5**size <= 1 - LEVEL)
RESAMPLES = 9999  # of the bootstrap
EXACT_UP_TO = 40  # scores of both samples without ties
EXACT_WITH_TIES_UP_TO = 16  # likewise with ties, for which all ways to divide the scores are tried


def median(values):
    return float(numpy.median(values))


@functools.cache
def resampled_medians(values):
    """Medians of resamples; the same for the same values."""
    draws = numpy.random.default_rng(1).choice(values, (RESAMPLES, len(values)))
    return numpy.median(draws, axis=1)


def median_interval(values):
    """The percentile bootstrap interval of the median (Efron & Tibshirani 1993, chapter 13); None of too few values."""
    if len(values) < INTERVAL_FROM:
        return None
    tails = (1 - LEVEL) / 2, (1 + LEVEL) / 2
    # scipy.stats.bootstrap goes between neighbours, which infinite ones do not bear; this takes one of them
    medians = resampled_medians(tuple(sorted(values)))
    return tuple(map(float, numpy.quantile(medians, tails, method="inverted_cdf")))


def rank_sum_test(a, b):
    """Two-sided p of the Mann-Whitney U test: whether one sample tends to higher values than the other."""
    ranks = stats.rankdata([*a, *b])  # finite where scores are not
    values = len(set(ranks))
    if values == 1:
        return 1.0
    a, b = ranks[: len(a)], ranks[len(a) :]
    if values < len(ranks) <= EXACT_WITH_TIES_UP_TO:
        tested = stats.permutation_test((a, b), distance, vectorized=True, n_resamples=numpy.inf, alternative="greater")
        return float(tested.pvalue)
    method = "exact" if values == len(ranks) <= EXACT_UP_TO else "asymptotic"
    return float(stats.mannwhitneyu(a, b, method=method).pvalue)


def distance(a, b, axis):
    """Of the sum of the first ranks from what it is on average."""
    of_a, of_b = a.shape[axis], b.shape[axis]
    return numpy.abs(a.sum(axis) - of_a * (of_a + of_b + 1) / 2)


def runs_for_verdict(tests):
    """Runs of each sample from which on some p, times `tests` (Holm's), can be below SIGNIFICANT at all."""
    return next(size for size in itertools.count(1) if 2 * tests / math.comb(2 * size, size) < SIGNIFICANT)


def superiority(a, b):
    """A12, the probability that one of `a` is above one of `b`, ties counting half (Vargha & Delaney 2000)."""
    u = stats.rankdata([*a, *b])[: len(a)].sum() - len(a) * (len(a) + 1) / 2
    return float(u) / (len(a) * len(b))


def superiority_interval(a12, size):
    """Of the A12 of two samples of that size: the values that are not too far from it by their own standard deviation.

    That is of Hanley & McNeil 1982, and the interval method 5 of Newcombe 2006 (Statistics in Medicine 25:559).
    """
    z = stats.norm.ppf((1 + LEVEL) / 2)

    def excess(value):
        spread = 1 + (size - 1) * ((1 - value) / (2 - value) + value / (1 + value))
        return (a12 - value) ** 2 - z * z * value * (1 - value) * spread / size**2

    def bound(end):
        return a12 if a12 == end else optimize.brentq(excess, end, a12 + 1e-9 * (end - a12))

    return bound(0.0), bound(1.0)


def holm(ps):
    """The p of several tests, raised so that one false finding among all has at most its probability (Holm 1979)."""
    order = numpy.argsort(ps)
    adjusted = numpy.empty(len(ps))
    adjusted[order] = numpy.minimum(1, numpy.maximum.accumulate(numpy.take(ps, order) * numpy.arange(len(ps), 0, -1)))
    return adjusted.tolist()
