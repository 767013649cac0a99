"""What can be inferred from few runs: intervals of medians, rank tests and effect sizes.

Scores may be infinite, as that of a run in which no robot has a fitness, but never NaN.
"""

import collections
import functools
import itertools
import math
import statistics

LEVEL = 0.95  # of intervals
SIGNIFICANT = 0.05  # what p must be below
# values; of fewer, even the lowest and the highest have the median between them less often than LEVEL says
INTERVAL_FROM = next(size for size in itertools.count(1) if 2 * 0.5**size <= 1 - LEVEL)
EXACT_UP_TO = 40  # scores of both samples; beyond, the normal p errs by less than 0.005, and below 0.05 by 0.0015


def median(values):
    ordered = sorted(values)
    return (ordered[(len(ordered) - 1) // 2] + ordered[len(ordered) // 2]) / 2


@functools.cache
def resampled_middles(size):
    """With which probability which two places of `size` ordered values are the middle of a bootstrap resample.

    Counted among all size**size resamples, so exact. The lower middle is at most at a place where at least half of the
    draws are. Where an even resample has two places in the middle, half of the draws are at or below the lower one, one
    or more of them at it, and likewise above.
    """
    half = size // 2

    def up_to(place):
        draws = range((size + 1) // 2, size + 1)
        return sum(math.comb(size, k) * place**k * (size - place) ** (size - k) for k in draws)

    def with_end(places):
        return places**half - (places - 1) ** half

    middles = {}
    for low in range(size):
        above = range(low + 1, size) if size % 2 == 0 else ()
        ways = {(low, high): math.comb(size, half) * with_end(low + 1) * with_end(size - high) for high in above}
        ways[low, low] = up_to(low + 1) - up_to(low) - sum(ways.values())
        middles |= {places: count / size**size for places, count in ways.items()}
    return middles


def median_interval(values):
    """The percentile bootstrap interval of the median (Efron & Tibshirani 1993, chapter 13); None of too few values."""
    if len(values) < INTERVAL_FROM:
        return None
    ordered = sorted(values)
    middles = resampled_middles(len(ordered))
    medians = sorted(((ordered[i] + ordered[j]) / 2, probability) for (i, j), probability in middles.items())

    def beyond_tail(from_outside):
        passed = 0.0
        for value, probability in from_outside:
            passed += probability
            if passed > (1 - LEVEL) / 2:
                return value

    return beyond_tail(medians), beyond_tail(reversed(medians))


def doubled_midranks(pooled):
    """Twice the rank of each value from 1; equal values share the mean of their ranks, so that all are whole."""
    ordered = sorted(pooled)
    first = {value: rank for rank, value in reversed(list(enumerate(ordered, 1)))}
    last = {value: rank for rank, value in enumerate(ordered, 1)}
    return [first[value] + last[value] for value in pooled]


def exact_p(ranks, size):
    """Share of the ways to choose `size` of the ranks whose sum is as far from the mean as that of the first ones."""
    ways = [collections.Counter() for _ in range(size + 1)]  # of each number of ranks, by their sum
    ways[0][0] = 1
    for rank in ranks:
        for chosen in range(size, 0, -1):
            for total, count in ways[chosen - 1].items():
                ways[chosen][total + rank] += count
    mean = size * (len(ranks) + 1)
    distance = abs(sum(ranks[:size]) - mean)
    extreme = sum(count for total, count in ways[size].items() if abs(total - mean) >= distance)
    return extreme / math.comb(len(ranks), size)


def normal_p(ranks, size):
    """The same by the normal distribution, corrected for ties and continuity (Hollander & Wolfe 1999, section 4.1)."""
    total = len(ranks)
    ties = sum(count**3 - count for count in collections.Counter(ranks).values())
    variance = size * (total - size) / 12 * (total + 1 - ties / (total * (total - 1)))
    distance = abs(sum(ranks[:size]) - size * (total + 1)) / 2
    if variance == 0:
        return 1.0
    return math.erfc(max(0.0, distance - 0.5) / math.sqrt(2 * variance))


def rank_sum_test(a, b):
    """Two-sided p of the Mann-Whitney U test: whether one sample tends to higher values than the other."""
    ranks = doubled_midranks([*a, *b])
    return exact_p(ranks, len(a)) if len(ranks) <= EXACT_UP_TO else normal_p(ranks, len(a))


def runs_for_verdict(tests):
    """Runs of each sample from which on some p, times `tests` (Holm's), can be below SIGNIFICANT at all."""
    return next(size for size in itertools.count(1) if 2 * tests / math.comb(2 * size, size) < SIGNIFICANT)


def superiority(a, b):
    """A12, the probability that one of `a` is above one of `b`, ties counting half (Vargha & Delaney 2000)."""
    return sum((x > y) + (x == y) / 2 for x in a for y in b) / (len(a) * len(b))


def superiority_interval(a12, size):
    """Of the A12 of two samples of that size: the values that are not too far from it by their own standard deviation.

    That is of Hanley & McNeil 1982, and the interval method 5 of Newcombe 2006 (Statistics in Medicine 25:559).
    """
    z = statistics.NormalDist().inv_cdf((1 + LEVEL) / 2)

    def within(value):
        spread = 1 + (size - 1) * ((1 - value) / (2 - value) + value / (1 + value))
        return (a12 - value) ** 2 <= z * z * value * (1 - value) * spread / size**2

    def bound(outside):
        inside = a12
        for _ in range(50):  # halvings
            middle = (inside + outside) / 2
            inside, outside = (middle, outside) if within(middle) else (inside, middle)
        return inside

    return bound(0.0), bound(1.0)


def holm(ps):
    """The p of several tests, raised so that one false finding among all has at most its probability (Holm 1979)."""
    adjusted = [0.0] * len(ps)
    highest = 0.0
    for place, index in enumerate(sorted(range(len(ps)), key=ps.__getitem__)):
        highest = max(highest, min(1.0, (len(ps) - place) * ps[index]))
        adjusted[index] = highest
    return adjusted
