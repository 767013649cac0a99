"""Main effects: how the configurations with some value of a key did, whatever their other values."""

import dataclasses

import numpy

from compare import inference

from .race import FIRST_TEST, ranks
from .ranges import Numbers

PARTS = ("low", "middle", "high")  # thirds of a range, by number of configurations


@dataclasses.dataclass(frozen=True)
class Level:
    """The configurations with the same value of a key, or with values in the same third."""

    name: str
    shares: tuple  # of the configurations that each of these configurations beats with the first seeds

    @property
    def mean(self):
        return float(numpy.mean(self.shares))


@dataclasses.dataclass(frozen=True)
class Effect:
    key: str
    levels: tuple
    size: float | None  # mean of the best level minus that of the worst; None with fewer than two levels
    interval: tuple | None  # None if a level has fewer than two configurations


def shares_beaten(configurations):
    """Returns, for each configuration, the mean share of the others that it beats with the same seed, from 0 to 1; ties
    count half. All are compared by their first seeds, which every configuration has."""
    scores = numpy.array([each.scores[:FIRST_TEST] for each in configurations]).T
    return (len(configurations) - ranks(scores).mean(axis=0)) / max(1, len(configurations) - 1)


def levels_of(parameter, texts, shares):
    """Returns the levels of a parameter, without those that no configuration has. `texts` has one value for each
    configuration."""
    if not isinstance(parameter, Numbers):
        found = [value for value in parameter.values if value in texts]
        return [Level(value, tuple(shares[[text == value for text in texts]])) for value in found]
    values = numpy.array([float(text) for text in texts])
    low, high = numpy.quantile(values, [1 / 3, 2 / 3], method="inverted_cdf")
    third = numpy.where(values <= low, 0, numpy.where(values <= high, 1, 2))
    return [
        Level(f"{part}: {min(some):g} to {max(some):g}", tuple(shares[third == i]))
        for i, part in enumerate(PARTS)
        if len(some := values[third == i])
    ]


def interval_of_difference(best, worst):
    """Returns the percentile bootstrap interval of the difference of two means, from resamples of the configurations,
    or None if there are too few of them."""
    if min(len(best), len(worst)) < 2:
        return None
    random = numpy.random.default_rng(1)
    means = [random.choice(some, (inference.RESAMPLES, len(some))).mean(axis=1) for some in (best, worst)]
    tails = (1 - inference.LEVEL) / 2, (1 + inference.LEVEL) / 2
    return tuple(map(float, numpy.quantile(means[0] - means[1], tails)))


def effects(parameters, configurations, values):
    """Returns the effect of each parameter. `values(configuration)` gives one text or None for each parameter."""
    scored = [each for each in configurations if each.scores]
    if not scored:
        return []
    beaten, found = shares_beaten(scored), []
    for i, parameter in enumerate(parameters):
        known = [k for k, each in enumerate(scored) if values(each)[i] is not None]
        levels = levels_of(parameter, [values(scored[k])[i] for k in known], beaten[known]) if known else []
        by_mean = sorted(levels, key=lambda level: level.mean)
        size = by_mean[-1].mean - by_mean[0].mean if len(levels) > 1 else None
        interval = None if size is None else interval_of_difference(by_mean[-1].shares, by_mean[0].shares)
        found.append(Effect(parameter.key, tuple(levels), size, interval))
    return found
