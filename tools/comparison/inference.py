"""What can be inferred from few runs: intervals of medians, rank tests and effect sizes.

Scores may be infinite, as that of a run in which no robot has a fitness, but never NaN.
"""

import collections
import functools
import math
import random

LEVEL = 0.95  # of intervals
RESAMPLES = 10_000
EXACT_UP_TO = 40  # scores of both samples; beyond, the normal p errs by less than 0.005, and below 0.05 by 0.0015


def median(values):
    ordered = sorted(values)
    return (ordered[(len(ordered) - 1) // 2] + ordered[len(ordered) // 2]) / 2


@functools.cache
def resampled_middles(size):
    """How often which two places of `size` ordered values are the middle of a bootstrap resample.

    They do not depend on the values, so one set of resamples serves all points of a curve. The seed is fixed: the same
    runs give the same interval.
    """
    draw = random.Random(size)
    low, high = (size - 1) // 2, size // 2
    middles = collections.Counter()
    for _ in range(RESAMPLES):
        places = sorted(draw.choices(range(size), k=size))
        middles[places[low], places[high]] += 1
    return middles


def median_interval(values):
    """The percentile bootstrap interval of the median (Efron & Tibshirani 1993, chapter 13)."""
    ordered = sorted(values)
    middles = resampled_middles(len(ordered))
    medians = sorted(((ordered[i] + ordered[j]) / 2, count) for (i, j), count in middles.items())
    tail = (1 - LEVEL) / 2 * RESAMPLES

    def beyond_tail(from_outside):
        passed = 0
        for value, count in from_outside:
            passed += count
            if passed > tail:
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


def superiority(a, b):
    """A12, the probability that one of `a` is above one of `b`, ties counting half (Vargha & Delaney 2000)."""
    return sum((x > y) + (x == y) / 2 for x in a for y in b) / (len(a) * len(b))


def holm(ps):
    """The p of several tests, raised so that one false finding among all has at most its probability (Holm 1979)."""
    adjusted = [0.0] * len(ps)
    highest = 0.0
    for place, index in enumerate(sorted(range(len(ps)), key=ps.__getitem__)):
        highest = max(highest, min(1.0, (len(ps) - place) * ps[index]))
        adjusted[index] = highest
    return adjusted
