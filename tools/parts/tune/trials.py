"""Runs the configurations of a race with the program, and reads their scores."""

import dataclasses
import hashlib
import json
import math
import subprocess

from common.command_line import Failure
from compare.history import history, objective_of
from compare.report import parts_of, provenances_of
from compare.runs import RunFailure, Runs, Variant, overrides


@dataclasses.dataclass(frozen=True)
class Tried(Variant):
    """A variant whose name does not grow with the number of keys."""

    @property
    def name(self):
        return hashlib.sha256(json.dumps(self.swept).encode()).hexdigest()[:12]


@dataclasses.dataclass(frozen=True)
class Result:
    """What one run came to. `score` is None if its best robot has no fitness or is marked."""

    score: float | None
    marks: tuple
    evaluations: int
    spring_evaluations: int
    builds: tuple
    devices: tuple


def result(shown, objective):
    """Returns the result of a run, given the output of `evodevo show --json`."""
    past, best = history(shown, objective), shown["best"]
    score = best["objectives"].get(objective.name) if best and best["status"] == "ok" else None
    made = list(dict.fromkeys(part for each in provenances_of(shown) for part in parts_of(each)))
    return Result(
        score=None if past.marks or score is None or not math.isfinite(score) else score,
        marks=tuple(past.marks or ()),
        evaluations=past.evaluations[-1],
        spring_evaluations=past.spring_evaluations[-1],
        builds=tuple(build for what, build in made if what == "evodevo"),
        devices=tuple(build for what, build in made if what == "device"),
    )


class Trials:
    """The runs of all configurations, and the reasons why some cannot be run. `make(runs)` makes those of the runs that
    are not finished; `tell(line)` shows the progress."""

    def __init__(self, program, out, experiment, settings, parameters, make, tell):
        self._program, self._out, self._make, self._tell = str(program), out, make, tell
        self._experiment, self._settings, self._parameters = experiment, settings, parameters
        self.results = {}  # by configuration, then by seed
        self.objective = None  # known after the first run
        self.obstacles = {}  # by configuration: why the program refuses it, or why a run of it failed
        self.made_by = {}  # for the device, evodevo and each operator: builds

    def variant(self, configuration):
        keys = [parameter.key for parameter in self._parameters]
        swept = () if configuration.is_own else tuple(zip(keys, configuration.values))
        return Tried(self._experiment, swept, self._settings)

    def accept(self, configuration):
        """Says what a configuration is, and returns whether the program accepts it. An experiment that is not accepted
        with its own values ends the race."""
        variant = self.variant(configuration)
        values = ", ".join(f"{key}={value}" for key, value in variant.swept) or "the values of the experiment"
        command = [self._program, "check", str(self._experiment), *overrides(variant)]
        checked = subprocess.run(command, capture_output=True, text=True)
        if checked.returncode == 0:
            self._tell(f"configuration {configuration.number} ({variant.name}): {values}")
            return True
        reason = checked.stderr.strip() or f"evodevo check ended with {checked.returncode}"
        if configuration.is_own or checked.returncode < 0:
            raise Failure(reason)
        self.obstacles[configuration] = reason
        self._tell(f"configuration {configuration.number} is refused: {values}\n  " + "\n  ".join(reason.splitlines()))
        return False

    def evaluate(self, configurations, seeds):
        """Returns for each configuration its scores with the seeds 1 to `seeds`, more being better, or None if a run of
        it failed."""
        variants = {self.variant(configuration): configuration for configuration in configurations}
        while variants:
            runs = Runs(self._program, self._out, list(variants), range(1, seeds + 1))
            runs.check()
            try:
                self._make(runs)
                break
            except RunFailure as failure:
                failed = variants.pop(failure.run.variant)
                self.obstacles[failed] = str(failure)
                self._tell(f"configuration {failed.number} drops out, because a run of it failed: {failure}")
        else:
            return [None] * len(configurations)
        for run in runs.all:
            self._read(runs, run, variants[run.variant])
        return [self._scores(each) if each in variants.values() else None for each in configurations]

    def _read(self, runs, run, configuration):
        results = self.results.setdefault(configuration, {})
        if run.seed in results:
            return
        shown = runs.shown(run)
        objective = objective_of(shown["objectives"][0])
        if self.objective not in (None, objective):
            raise Failure(
                f"{run.folder}: its first objective is {objective.name} ({objective.unit}), not {self.objective.name} "
                f"({self.objective.unit}); leave out the key of --over that changes it"
            )
        self.objective = objective
        results[run.seed] = result(shown, objective)
        for each in provenances_of(shown):
            for what, build in parts_of(each):
                self.made_by.setdefault(what, {})[build] = True

    def _scores(self, configuration):
        results = self.results[configuration]
        scores = [self.objective.worst if each.score is None else each.score for _, each in sorted(results.items())]
        return self.objective.upwards(scores)
