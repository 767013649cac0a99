"""Iterated racing: which configurations are run with which seeds. Everything follows from the scores and one seed, so
that the same scores give the same race again."""

import dataclasses
import math

import numpy

from .race import FIRST_TEST, clearly_worse, mean_ranks

TRIES = 100  # draws for each new configuration, most of which may be known already
REFUSALS = 30  # refusals one after the other that end the drawing


@dataclasses.dataclass(eq=False)
class Configuration:
    """Values for the tuned keys, and what became of them."""

    number: int
    values: tuple  # one text in TOML for each parameter; None: that of the experiment, which is not in the range
    iteration: int
    is_own: bool = False  # the values that the experiment has itself
    scores: list = dataclasses.field(default_factory=list)  # by seed, from 1; more is better
    fate: str = "left"  # or "dropped" by a test, "outranked" at the end of an iteration, "failed", "refused"
    mean_rank: float | None = None  # in the last test of its race
    rivals: int = 0  # number of configurations in that test, itself included


@dataclasses.dataclass(frozen=True)
class Iteration:
    number: int
    drawn: int  # new configurations
    seeds: int
    runs: int
    dropped: int
    left: int


def iterations_for(parameters):
    return 2 + int(math.log2(parameters))


def smallest_budget(parameters):
    """Returns the number of runs with which the first iteration compares one configuration more than it keeps."""
    return iterations_for(parameters) * (FIRST_TEST + 1) * (iterations_for(parameters) + 1)


class Tuning:
    """A race over `parameters` of at most `budget` runs. `accept(configuration)` says whether a configuration can be
    run; `evaluate(configurations, seeds)` returns for each its scores with the seeds 1 to `seeds`, or None if one of
    its runs failed; `tell(line)` shows the progress. `own` are the values of the experiment."""

    def __init__(self, parameters, own, budget, seed, accept, evaluate, tell):
        self._parameters, self._own, self._budget, self._seed = parameters, own, budget, seed
        self._accept, self._evaluate, self._tell = accept, evaluate, tell
        self.configurations = []  # all, in the order in which they were drawn
        self.iterations = []
        self.runs = 0
        self.ranked = []  # what is left, the best first

    def run(self):
        last = iterations_for(len(self._parameters))
        spread = 0.5
        for number in range(1, last + 1):
            share = (self._budget - self.runs) // (last - number + 1)
            seen = len(self.ranked[0].scores) if self.ranked else 0
            # so many that all can be run with the seeds that the elites have seen
            count = share // max(seen, FIRST_TEST + min(5, number))
            if number > 1:
                spread *= max(count, 2) ** (-1 / len(self._parameters))
            elites, runs = self.ranked, self.runs
            drawn = self._draw(number, count, spread, (number - 1) / last)
            if len(elites) + len(drawn) < 2:  # there is nothing to compare
                break
            keep = 1 if number == last else last
            left = self._race(elites + drawn, set(elites), seen, share, keep)
            ranked = self._rank(left)
            self.ranked = ranked if number == last else ranked[:last]
            for each in ranked[len(self.ranked) :]:
                each.fate = "outranked"
            self.iterations.append(
                Iteration(
                    number,
                    drawn=len(drawn),
                    seeds=len(left[0].scores) if left else 0,
                    runs=self.runs - runs,
                    dropped=len(elites) + len(drawn) - len(left),
                    left=len(left),
                )
            )
            if not left:
                break

    def _draw(self, iteration, count, spread, weight):
        """Draws `count` new configurations that are accepted, or fewer if there are no more."""
        drawn, index, refusals = [], 0, 0
        if iteration == 1:
            own = self._add(self._own, iteration, is_own=True)
            if own.fate == "left":
                drawn.append(own)
        while len(drawn) < count and index < TRIES * count and refusals < REFUSALS:
            index += 1
            values = self._values(numpy.random.default_rng([self._seed, iteration, index]), spread, weight)
            if any(values == known.values for known in self.configurations):
                continue
            configuration = self._add(values, iteration)
            if configuration.fate == "left":
                drawn.append(configuration)
                refusals = 0
            else:
                refusals += 1
        return drawn

    def _add(self, values, iteration, is_own=False):
        configuration = Configuration(len(self.configurations) + 1, values, iteration, is_own)
        self.configurations.append(configuration)
        if not self._accept(configuration):
            configuration.fate = "refused"
        return configuration

    def _values(self, random, spread, weight):
        if not self.ranked:
            return tuple(parameter.draw(random) for parameter in self._parameters)
        elites = len(self.ranked)
        chances = numpy.arange(elites, 0, -1) / (elites * (elites + 1) / 2)
        parent = self.ranked[random.choice(elites, p=chances)]
        return tuple(
            parameter.draw(random) if value is None else parameter.draw_near(value, random, spread, weight)
            for parameter, value in zip(self._parameters, parent.values)
        )

    def _race(self, alive, elites, seen, share, keep):
        """Races configurations until `share` runs are spent or `keep` are left, and returns what is left. Elites drop
        out only after all others have seen their seeds."""
        seeds, end = 0, self.runs + share
        while len(alive) > keep or (alive and seeds < seen):
            seeds = max(seeds + 1, FIRST_TEST)
            cost = sum(max(0, seeds - len(each.scores)) for each in alive)
            if self.runs + cost > end:
                break
            alive = self._score(alive, seeds)
            self.runs += cost
            alive = self._test(alive, seeds, elites if seeds < seen else ())
        return alive

    def _score(self, alive, seeds):
        waiting = [each for each in alive if len(each.scores) < seeds]
        if waiting:
            names = ", ".join(str(each.number) for each in waiting)
            self._tell(f"up to seed {seeds}: configurations {names}")
        for each, scores in zip(waiting, self._evaluate(waiting, seeds) if waiting else ()):
            if scores is None:
                each.fate = "failed"
                each.scores = []
            else:
                each.scores = [-math.inf if math.isnan(score) else score for score in scores]
        return [each for each in alive if each.fate == "left"]

    def _test(self, alive, seeds, safe):
        if not alive:
            return alive
        scores = numpy.array([each.scores[:seeds] for each in alive]).T
        for each, mean_rank in zip(alive, mean_ranks(scores)):
            each.mean_rank, each.rivals = float(mean_rank), len(alive)
        for each, worse in zip(alive, clearly_worse(scores)):
            if worse and each not in safe:
                each.fate = "dropped"
                self._tell(f"configuration {each.number} drops out: mean rank {each.mean_rank:.1f} of {each.rivals}")
        return [each for each in alive if each.fate == "left"]

    def _rank(self, left):
        if not left:
            return []
        order = mean_ranks(numpy.array([each.scores for each in left]).T)
        return [left[i] for i in numpy.argsort(order, kind="stable")]
