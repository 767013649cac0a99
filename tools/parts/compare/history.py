"""The history of a run: the best score so far against evaluations and against spring evaluations."""

import bisect
import dataclasses
import itertools
import math

from .scenarios import by_scenario


@dataclasses.dataclass(frozen=True)
class Objective:
    name: str
    unit: str
    maximise: bool

    @classmethod
    def of(cls, shown):
        """The objective that `show --json` describes, with other facts about it."""
        return cls(shown["name"], shown["unit"], shown["maximise"])

    @property
    def worst(self):
        """The score of a run in which no robot has a fitness."""
        return -math.inf if self.maximise else math.inf

    def upwards(self, scores):
        """Returns the scores, negated if less is better, so that more is better."""
        return scores if self.maximise else [-score for score in scores]


@dataclasses.dataclass(frozen=True)
class History:
    """The history of one run. The first element of each list stands for the time before the first generation. `best` is
    the best score so far; all other lists are sums over the generations so far."""

    generations: list
    evaluations: list
    spring_evaluations: list
    best: list
    diverged: list
    invalid: list
    seconds: list
    marks: list | None  # of the run's best robot, such as "artefact"; None if it was not verified
    scenarios: dict  # scores of the run's best robot by scenario

    def at(self, axis, cost, what="best"):
        """Returns the value of the list `what` after the last generation that was complete at that cost."""
        return getattr(self, what)[bisect.bisect_right(getattr(self, axis), cost) - 1]


def history(shown, objective):
    """Returns the history of a run, given the output of `evodevo show --json`."""
    generations = shown["generations"]

    def summed(key):
        return list(itertools.accumulate((generation[key] for generation in generations), initial=0))

    better = max if objective.maximise else min
    scores = [objective.worst if generation["best"] is None else generation["best"] for generation in generations]
    verification = (shown["best"] or {}).get("verification")
    return History(
        generations=list(range(len(generations) + 1)),
        evaluations=[0, *(generation["evaluations"] for generation in generations)],
        spring_evaluations=summed("spring_evaluations"),
        best=list(itertools.accumulate(scores, better, initial=objective.worst)),
        diverged=summed("diverged"),
        invalid=summed("invalid"),
        seconds=summed("wall_time"),
        marks=verification and verification["marks"],
        scenarios=by_scenario(shown["best"], objective),
    )


def common_span(histories, axis):
    """Returns the lowest cost at which each of these runs has completed a generation, and the highest cost that all of
    them reach. The latter may be lower."""
    return max(getattr(h, axis)[1] for h in histories), min(getattr(h, axis)[-1] for h in histories)
