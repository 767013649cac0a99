"""The history of a run: the quantities that runs are compared by, against evaluations and against spring
evaluations."""

import bisect
import dataclasses
import itertools
import math

from .scenarios import by_scenario


@dataclasses.dataclass(frozen=True)
class Quantity:
    """A number that runs are compared by: the best first objective, or what a run's map of niches amounts to."""

    name: str
    unit: str
    maximise: bool
    column: str = "best"  # the list of a history that has the quantity after each generation

    @property
    def worst(self):
        """The value of a run in which no robot has a fitness."""
        return -math.inf if self.maximise else math.inf

    def upwards(self, values):
        """Returns the values, negated if less is better, so that more is better."""
        return values if self.maximise else [-value for value in values]


def objective_of(shown):
    """Returns the best score by the objective that `show --json` describes, with other facts about it."""
    return Quantity(shown["name"], shown["unit"], shown["maximise"])


@dataclasses.dataclass(frozen=True)
class History:
    """The history of one run. The first element of each list stands for the time before the first generation. `best` is
    the best score so far, `coverage` and `qd_score` are those of the map of all individuals so far, and all other lists
    are sums over the generations so far."""

    generations: list
    evaluations: list
    spring_evaluations: list
    best: list
    coverage: list | None  # None if the run has no map
    qd_score: list | None  # None if the run has no map, or less of the objective is better
    diverged: list
    invalid: list
    refused: list  # by verification before the front
    seconds: list
    marks: list | None  # of the run's best robot, such as "artefact"; None if it was not verified
    reborn: list  # whether it kept its score in each life to come in which development drew the same numbers
    redrawn: list  # likewise in those in which it drew others
    scenarios: dict  # scores of the run's best robot by scenario
    axes: list | None  # of the run's map; None if it has no map
    signal: list | None  # what `evodevo signal` has measured, if anything

    def at(self, axis, cost, what):
        """Returns the value of the list `what` after the last generation that was complete at that cost."""
        return getattr(self, what)[bisect.bisect_right(getattr(self, axis), cost) - 1]


def history(shown, objective):
    """Returns the history of a run, given the output of `evodevo show --json`."""
    generations = shown["generations"]

    def summed(key):
        return list(itertools.accumulate((generation[key] for generation in generations), initial=0))

    def of_the_map(key):
        values = [generation["map"] and generation["map"][key] for generation in generations]
        return None if None in values else [0, *values]

    better = max if objective.maximise else min
    scores = [objective.worst if generation["best"] is None else generation["best"] for generation in generations]
    verification = (shown["best"] or {}).get("verification")

    def lives_to_come(kind):
        trials = (verification or {}).get("trials", ())
        return [trial["held"] for trial in trials if trial["trial"].startswith(f"{kind}-")]

    return History(
        generations=list(range(len(generations) + 1)),
        evaluations=[0, *(generation["evaluations"] for generation in generations)],
        spring_evaluations=summed("spring_evaluations"),
        best=list(itertools.accumulate(scores, better, initial=objective.worst)),
        coverage=of_the_map("coverage"),
        qd_score=of_the_map("qd_score"),
        diverged=summed("diverged"),
        invalid=summed("invalid"),
        refused=[sum(counts) for counts in zip(summed("artefact"), summed("lucky"), summed("passive"))],
        seconds=summed("wall_time"),
        marks=verification and verification["marks"],
        reborn=lives_to_come("reborn"),
        redrawn=lives_to_come("redrawn"),
        scenarios=by_scenario(shown["best"], objective),
        axes=shown["map"] and shown["map"]["axes"],
        signal=shown.get("signal"),
    )


def common_span(histories, axis):
    """Returns the lowest cost at which each of these runs has completed a generation, and the highest cost that all of
    them reach. The latter may be lower."""
    return max(getattr(h, axis)[1] for h in histories), min(getattr(h, axis)[-1] for h in histories)
