"""The tests of a race: which configurations are clearly worse.

Scores have one row for each seed and one column for each configuration; more is better. They may be infinite, but never
NaN."""

import numpy
from scipy import stats

FIRST_TEST = 5  # seeds before the first test
SIGNIFICANT = 0.05


def ranks(scores):
    """Returns the ranks in each row, from 1 for the best; equal scores share the mean of their ranks."""
    return stats.rankdata(-numpy.asarray(scores, dtype=float), axis=1)


def mean_ranks(scores):
    return ranks(scores).mean(axis=0)


def clearly_worse(scores):
    """Returns, for each configuration, whether it is clearly worse than the best one."""
    scores = numpy.asarray(scores, dtype=float)
    seeds, configurations = scores.shape
    if configurations < 2 or seeds < 2:
        return numpy.zeros(configurations, dtype=bool)
    return worse_of_two(scores) if configurations == 2 else worse_of_many(scores)


def worse_of_many(scores):
    """The Friedman test, and what follows it for each configuration beside the best (Conover 1999, chapter 5.8)."""
    by_seed = ranks(scores)
    seeds, configurations = by_seed.shape
    sums = by_seed.sum(axis=0)
    squares, level = (by_seed**2).sum(), seeds * configurations * (configurations + 1) ** 2 / 4
    if squares <= level:  # all scores of each seed are equal
        return numpy.zeros(configurations, dtype=bool)
    statistic = (configurations - 1) * ((sums**2).sum() - seeds * level) / (squares - level)
    if stats.chi2.sf(statistic, configurations - 1) >= SIGNIFICANT:
        return numpy.zeros(configurations, dtype=bool)
    freedom = (seeds - 1) * (configurations - 1)
    rest = max(0.0, seeds * squares - (sums**2).sum())
    difference = stats.t.ppf(1 - SIGNIFICANT / 2, freedom) * (2 * rest / freedom) ** 0.5
    return sums - sums.min() > difference


def worse_of_two(scores):
    """The Wilcoxon signed-rank test."""
    differences = signed_ranks(scores[:, 0], scores[:, 1])
    none = numpy.zeros(2, dtype=bool)
    if len(differences) == 0 or stats.wilcoxon(differences).pvalue >= SIGNIFICANT:
        return none
    none[int(differences.sum() > 0)] = True
    return none


def signed_ranks(one, other):
    """Returns the ranks of those differences that are not 0, with their signs. The difference to an infinite score is
    larger than any finite one."""
    unequal = one != other
    differences = one[unequal] - other[unequal]
    return numpy.sign(differences) * stats.rankdata(numpy.abs(differences))
