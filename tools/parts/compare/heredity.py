"""What repeats in the scores of each experiment's robots, what children inherit, and how far the best robots get in lives
to come, as `evodevo signal` has measured them."""

import math

from . import inference
from .standings import INTERVAL, median_with_interval, number, table

TEXT = f"""\
`evodevo signal` measured every run when it had ended, in lives that selection has not seen. **Repeatability** is the share
of the differences between scores, by rank, that lies between robots and not between lives of one, of the combination of
lives that selection sees; **heritability** is the share of the differences between parents, by rank, that their children
get: both of random robots, as medians of the runs, and of the last populations. **Lives to come** is the median score of
the best robot of each run, chosen by its record, in ten times as many lives as it was selected by, with the development's
draws of the run and with new ones; its **children** are 20. A12 compares lives to come with those of the experiment's
random search, if there is one, and otherwise with the experiment that is tested against; a robot that fails in half of
them is below all others.
"""


def numbers_of(signal):
    """Returns the numbers of a run's signal by population, quantity, of and scale."""
    return {tuple(each[key] for key in ("population", "quantity", "of", "scale")): each["value"] for each in signal or ()}


def repeatability(numbers, population):
    """Returns the repeatability of what selection sees: the combination of lives, if there are several."""
    of_lives = [numbers.get((population, "repeatability", of, "rank")) for of in ("all lives", "one life")]
    return next((value for value in of_lives if value is not None), None)


def heritability(numbers, population):
    return numbers.get((population, "heritability", "all children", "rank"))


def is_measured(runs, of):
    """Returns whether such a score of the best robot was measured in any run."""
    return any(("champion", "failures", of, "share") in numbers_of(run.signal) for run in runs)


def score_of(runs, of, worst):
    """Returns a score of the best robot of each run; the worst if it has none."""
    return [numbers_of(run.signal).get(("champion", "score", of, "value"), worst) for run in runs]


def median_of(values):
    known = [value for value in values if value is not None]
    return number(inference.median(known)) if known else "-"


def beside(scores, others, objective):
    """Returns A12 with its interval."""
    a12 = inference.superiority(objective.upwards(scores), objective.upwards(others))
    low, high = inference.superiority_interval(a12, len(scores), len(others))
    return f"{a12:.2f} ({low:.2f} to {high:.2f})"


def section(histories, objective, against):
    """Returns the section, or an empty text if not every run with a fitness was measured."""
    if not all(run.signal or math.isinf(run.best[-1]) for runs in histories.values() for run in runs):
        return ""
    of_name = {variant.name: runs for variant, runs in histories.items()}
    rows = []
    for variant, runs in histories.items():
        numbers = [numbers_of(run.signal) for run in runs]
        row = [f"`{variant.name}`"]
        for population in ("random", "last"):
            row += [median_of([of(each, population) for each in numbers]) for of in (repeatability, heritability)]
        for of in ("record", "lives to come", "new draws", "children"):
            scores = score_of(runs, of, objective.worst)
            row.append(median_with_interval(scores) if any(map(math.isfinite, scores)) else "-")
        baseline = of_name.get(f"{variant.name},random", of_name[against])
        for of in ("lives to come", "new draws"):
            scores, others = (score_of(some, of, objective.worst) for some in (runs, baseline))
            is_told = runs is not baseline and is_measured(runs, of) and is_measured(baseline, of)
            row.append(beside(scores, others, objective) if is_told else "-")
        rows.append(row)
    header = ["", *(f"{what}, {whose}" for whose in ("random", "last") for what in ("repeatability", "heritability"))]
    header += ["record", "lives to come", "new draws", "children", f"A12 ({INTERVAL})", "A12, new draws"]
    return f"## What repeats, and what children inherit\n\n{TEXT}\n{table(header, rows)}"
