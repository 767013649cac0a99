"""A comparison as text: report.md for readers, results.csv for other programs."""

import csv
import dataclasses
import math
import re

from . import inference
from .history import common_span

AXES = {"spring_evaluations": "spring evaluations", "evaluations": "evaluations"}
SIGNIFICANT = 0.05

METHOD = f"""\
## How to read this

A run's score is the best first objective of any robot so far, counted at the end of each generation: at a given cost it
is that of the last generation complete by then, without interpolation between generations. A run without a fitness is
below all others. One spring evaluation is one spring in one time step, so development pays for its simulation.

Intervals are of the median over seeds: {100 * inference.LEVEL:.0f} %, percentile bootstrap, {inference.RESAMPLES} \
resamples of the runs with a fixed seed.

A12 is the probability that a run is better than one of the first experiment, ties counting half: 0.5 is no difference;
0.56, 0.64 and 0.71 (or 0.44, 0.36 and 0.29) count as a small, medium and large one (Vargha & Delaney 2000).

p is that of the two-sided Mann-Whitney U test, exact up to {inference.EXACT_UP_TO} runs of both together, else by the \
normal approximation,
always with ties. p (Holm) allows for all rows of its table. Below {SIGNIFICANT} a difference counts as shown.
"""


@dataclasses.dataclass(frozen=True)
class Setting:
    """What a comparison was made by."""

    command: str
    seeds: int
    devices: list
    versions: list


def number(value):
    if math.isinf(value):
        return "none"
    if 1e3 <= abs(value) < 1e6:
        return f"{value:.0f}"
    return re.sub(r"e\+?(-?)0*", r"e\1", f"{value:.3g}")


def share(part, whole):
    return f"{100 * part / whole:.2f} %"


def table(header, rows):
    lines = [header, ["---"] * len(header), *rows]
    return "".join("| " + " | ".join(line) + " |\n" for line in lines)


@dataclasses.dataclass(frozen=True)
class Standing:
    """One variant at one cost, beside the first."""

    name: str
    scores: list
    a12: float
    p: float
    holm: float

    def verdict(self, baseline):
        """One sentence that claims no more than the test bears."""
        beside = f"`{self.name}`, beside `{baseline}`: "
        numbers = f"A12 {self.a12:.2f}, p (Holm) {self.holm:.2g}"
        if self.holm >= SIGNIFICANT:
            return f"- {beside}no difference is shown ({numbers})."
        return f"- {beside}{'better' if self.a12 > 0.5 else 'worse'} ({numbers})."


def standings(histories, objective, axis, cost):
    """All variants at one cost, the first of which is what the others are tested against."""
    scores = {variant: [history.at(axis, cost) for history in runs] for variant, runs in histories.items()}
    baseline = objective.upwards(next(iter(scores.values())))
    upwards = [objective.upwards(values) for values in scores.values()]
    ps = [inference.rank_sum_test(values, baseline) for values in upwards]
    return [
        Standing(variant.name, scores[variant], inference.superiority(values, baseline), p, adjusted)
        for variant, values, p, adjusted in zip(scores, upwards, ps, [1.0, *inference.holm(ps[1:])])
    ]


def section(histories, objective, axis):
    """The comparison at the cost that every run has reached."""
    other = next(name for name in AXES if name != axis)
    _, cost = common_span([history for runs in histories.values() for history in runs], axis)
    first, *others = all_standings = standings(histories, objective, axis, cost)
    rows = []
    for standing, runs in zip(all_standings, histories.values()):
        low, high = inference.median_interval(standing.scores)
        tests = [f"{standing.a12:.2f}", f"{standing.p:.2g}", f"{standing.holm:.2g}"]
        spent = inference.median([history.at(axis, cost, other) for history in runs])
        median = number(inference.median(standing.scores))
        beside = ["-"] * 3 if standing is first else tests
        rows.append([f"`{standing.name}`", median, f"{number(low)} to {number(high)}", number(spent), *beside])
    header = ["", f"median {objective.name}", "95 % interval", f"{AXES[other]} by then", "A12", "p", "p (Holm)"]
    verdicts = "\n".join(standing.verdict(first.name) for standing in others)
    return f"## After {number(cost)} {AXES[axis]}\n\n{verdicts}\n\n{table(header, rows)}"


def whole_runs(histories):
    """What all runs of each variant came to, at whatever cost."""
    rows = []
    for variant, runs in histories.items():
        evaluations = sum(history.evaluations[-1] for history in runs)
        rows.append(
            [
                f"`{variant.name}`",
                str(evaluations),
                number(sum(history.spring_evaluations[-1] for history in runs)),
                share(sum(history.diverged[-1] for history in runs), evaluations),
                share(sum(history.invalid[-1] for history in runs), evaluations),
                f"{sum(history.seconds[-1] for history in runs) / 3600:.2f}",
            ]
        )
    header = ["", "evaluations", "spring evaluations", "diverged", "invalid", "hours"]
    return f"## All runs, each to its end\n\n{table(header, rows)}"


def markdown(histories, objective, setting):
    head = (
        f"# {objective.name} ({objective.unit}, {'more' if objective.maximise else 'less'} is better)\n\n"
        f"{setting.seeds} seeds of each experiment, on {' and '.join(setting.devices)}, evodevo "
        f"{' and '.join(setting.versions)}. Made by\n\n```sh\n{setting.command}\n```\n\n"
        "![Best so far over spring evaluations and over evaluations](chart.svg)\n"
    )
    return "\n".join([head, *(section(histories, objective, axis) for axis in AXES), whole_runs(histories), METHOD])


def write_csv(file, histories):
    """One line for each generation of each run; all columns but the best so far add up over generations."""
    with open(file, "w", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        columns = ["evaluations", "spring_evaluations", "best", "diverged", "invalid", "seconds"]
        writer.writerow(["experiment", "seed", *columns])
        for variant, runs in histories.items():
            for seed, run in enumerate(runs, 1):
                generations = zip(*(getattr(run, column) for column in columns))
                next(generations)  # what was before the first
                for evaluations, springs, best, *failures, seconds in generations:
                    best_text = "" if math.isinf(best) else best
                    writer.writerow([variant.name, seed, evaluations, springs, best_text, *failures, f"{seconds:.3f}"])
