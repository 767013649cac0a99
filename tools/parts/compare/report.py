"""Writes a comparison as text: report.md for people, results.csv for other programs."""

import collections
import csv
import dataclasses
import math
import re

from . import inference
from .history import common_span
from .scenarios import shared

AXES = {"spring_evaluations": "spring evaluations", "evaluations": "evaluations"}
INTERVAL = f"{100 * inference.LEVEL:.0f} % interval"

METHOD = f"""\
## How to read this

A run's score is the best first objective of any robot so far, counted at the end of each generation: at a given cost it
is that of the last generation complete by then, without interpolation between generations. A run without a fitness is
below all others. One spring evaluation is the computation of one spring in one time step, so the simulation of
development counts as cost.

Intervals of medians over seeds are by the percentile bootstrap, from {inference.RESAMPLES:,} resamples of the runs.

The best robot of a whole run, where it was verified (`[experiment] verify`), held, or is an artefact of the time step,
passive, or both.
"""

TESTS = f"""\
A12 is the probability that a run is better than one of the experiment that is tested against, ties counting half: 0.5
is no difference; 0.56, 0.64 and 0.71 (or 0.44, 0.36 and 0.29) count as a small, medium and large one (Vargha & Delaney
2000). Its interval is that of Newcombe (2006, method 5) and allows for this row alone.

p is that of the two-sided Mann-Whitney U test: exact up to {inference.EXACT_UP_TO} runs of both together, with ties up
to {inference.EXACT_WITH_TIES_UP_TO}, and by the normal distribution beyond, corrected for ties. p (Holm) allows for all rows of its table. Below {inference.SIGNIFICANT} a difference counts as shown.
"""


SCENARIOS = """\
The best robot of each run, by the first objective of its own experiment. Its score in a scenario is the mean of the
repeats. Each cell has the median of the runs and, if there are enough seeds, its interval. Experiments that
differ in the key `over` score their robots by different tests; this table has their scores in the same ones.
"""


@dataclasses.dataclass(frozen=True)
class Setting:
    """The command line of a comparison, and the builds that made its runs."""

    command: str
    seeds: int
    against: str  # the name of the variant that the others are tested against
    builds: dict  # for the device, evodevo and each operator: runs of each variant by build


def builds(shown):
    """Counts the runs of each variant by the device and the builds that made them. `shown` is the output of `evodevo
    show --json` for each run. A run that was resumed may have been made by several builds; it counts for each."""
    made = collections.defaultdict(lambda: collections.defaultdict(collections.Counter))
    for run, said in shown.items():
        for what, build in dict.fromkeys(by for provenance in provenances_of(said) for by in parts_of(provenance)):
            made[what][build][run.variant.name] += 1
    return made


def provenances_of(said):
    """Returns the provenances of all generations of a run, each once."""
    return [said["provenances"][place] for place in sorted({generation["provenance"] for generation in said["generations"]})]


def parts_of(provenance):
    """Yields the device, evodevo and each operator of a provenance with its build; results depend on all of them."""
    yield "device", provenance["device"]
    yield "evodevo", f"{provenance['evodevo']} ({provenance['program']})"
    for operator in provenance["operators"]:
        yield f"{operator['kind']} `{operator['name']}`", f"{operator['version']} ({operator['hash']})"


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
    """One variant at one cost, compared with the variant that it is tested against."""

    name: str
    scores: list
    a12: float
    p: float
    holm: float

    def achieved(self, spent, generations):
        """Returns the first cells of the variant's row in the table: the median score with its interval, and the median
        costs."""
        bounds = inference.median_interval(self.scores)
        interval = "{} to {}".format(*map(number, bounds)) if bounds else "-"
        score, *costs = (number(inference.median(values)) for values in (self.scores, spent, generations))
        return [f"`{self.name}`", score, interval, *costs]

    def interval(self):
        return "{:.2f} to {:.2f}".format(*inference.superiority_interval(self.a12, len(self.scores)))

    def tests(self, judged):
        """Returns the remaining cells of the variant's row: the comparison with the variant that it is tested
        against."""
        return [f"{self.a12:.2f}", self.interval() if judged else "-", f"{self.p:.2g}", f"{self.holm:.2g}"]

    def verdict(self, baseline):
        """Returns a sentence that claims a difference only if the test shows one."""
        beside = f"`{self.name}`, beside `{baseline}`: "
        numbers = f"A12 {self.a12:.2f}, {self.interval()}, p (Holm) {self.holm:.2g}"
        if self.holm >= inference.SIGNIFICANT:
            return f"- {beside}no difference is shown ({numbers})."
        return f"- {beside}{'better' if self.a12 > 0.5 else 'worse'} ({numbers})."


def standings(histories, objective, axis, cost, against):
    """Returns the standings of all variants at one cost, tested against the variant with the name `against`."""
    scores = {variant.name: [history.at(axis, cost) for history in runs] for variant, runs in histories.items()}
    upwards = {name: objective.upwards(values) for name, values in scores.items()}
    ps = {name: inference.rank_sum_test(values, upwards[against]) for name, values in upwards.items()}
    others = [name for name in scores if name != against]
    adjusted = {against: 1.0, **dict(zip(others, inference.holm([ps[name] for name in others])))}
    return [
        Standing(name, scores[name], inference.superiority(upwards[name], upwards[against]), ps[name], adjusted[name])
        for name in scores
    ]


def verdicts_possible(seeds, experiments):
    return seeds >= inference.runs_for_verdict(experiments - 1)


def too_few_seeds(seeds, experiments):
    """Returns a text on the statistics that are left out because there are too few runs."""
    said = ""
    if seeds < inference.INTERVAL_FROM:
        said += f"No intervals of medians: they take {inference.INTERVAL_FROM} seeds (`--seeds`).\n"
    if not verdicts_possible(seeds, experiments):
        said += (
            f"No verdicts: whatever the runs come to, {seeds} seeds cannot show a difference between {experiments} "
            f"experiments; that takes {inference.runs_for_verdict(experiments - 1)}.\n"
        )
    return said


def too_early(histories, axis, cost):
    """Explains why nothing is compared at a cost at which some run has not completed a generation."""
    late = " and ".join(f"`{variant.name}`" for variant, runs in histories.items() if common_span(runs, axis)[0] > cost)
    ending = min(histories, key=lambda variant: common_span(histories[variant], axis)[1]).name
    return (
        f"Not compared: a run of `{ending}` ends before the first generation of every run of {late} is complete. "
        f"Let `{ending}` run longer (`experiment.evaluations`, `experiment.spring_evaluations`), or give {late} a "
        "smaller `experiment.population`.\n"
    )


def section(histories, objective, axis, against):
    """Returns the section on the comparison at the highest cost that every run has reached."""
    start, cost = common_span([history for runs in histories.values() for history in runs], axis)
    title = f"## After {number(cost)} {AXES[axis]}\n\n"
    if cost < start:
        return title + too_early(histories, axis, cost)
    all_standings = standings(histories, objective, axis, cost, against)
    others = [standing for standing in all_standings if standing.name != against]
    other = next(name for name in AXES if name != axis)
    header = ["", f"median {objective.name}", INTERVAL, f"{AXES[other]} by then", "generations"]
    rows = [
        standing.achieved(*([history.at(axis, cost, what) for history in runs] for what in (other, "generations")))
        for standing, runs in zip(all_standings, histories.values())
    ]
    if not others:
        return title + table(header, rows)
    judged = verdicts_possible(len(others[0].scores), len(histories))
    verdicts = "".join(f"{standing.verdict(against)}\n" for standing in others) + "\n" if judged else ""
    tests = [["-"] * 4 if standing.name == against else standing.tests(judged) for standing in all_standings]
    return title + verdicts + table(header + ["A12", INTERVAL, "p", "p (Holm)"], map(list.__add__, rows, tests))


def verified(runs):
    """Returns table cells that count, among the verified best robots, those without a mark, the artefacts and the
    passive ones."""
    marks = [history.marks for history in runs if history.marks is not None]
    if not marks:
        return ["not verified", "-", "-"]
    counts = [marks.count([]), *(sum(mark in some for some in marks) for mark in ("artefact", "passive"))]
    return [f"{count} of {len(marks)}" for count in counts]


def whole_runs(histories):
    """Returns the section on the totals of all runs of each variant."""
    rows = []
    for variant, runs in histories.items():
        evaluations = sum(history.evaluations[-1] for history in runs)
        rows.append(
            [
                f"`{variant.name}`",
                str(sum(history.generations[-1] for history in runs)),
                str(evaluations),
                number(sum(history.spring_evaluations[-1] for history in runs)),
                share(sum(history.diverged[-1] for history in runs), evaluations),
                share(sum(history.invalid[-1] for history in runs), evaluations),
                f"{sum(history.seconds[-1] for history in runs) / 3600:.2f}",
                *verified(runs),
            ]
        )
    header = ["", "generations", "evaluations", "spring evaluations", "diverged", "invalid", "hours"]
    header += ["best held", "artefact", "passive"]
    return f"## All runs, each to its end\n\n{table(header, rows)}"


def in_scenarios(histories, objective):
    """Returns the section on the best robots in each scenario that all experiments with scenarios share, or an empty
    text if no experiment has any."""
    found = shared(histories, objective)
    if not found.scores:
        return ""
    said = "".join(f"`{name}` has no scenarios and is not in this comparison.\n" for name in found.without)
    for scenario, names in found.left_out.items():
        said += f"Not compared: \"{scenario}\", which only {' and '.join(f'`{name}`' for name in names)} has.\n"
    title = f"## {objective.name.capitalize()} of the best robots in each scenario\n\n"
    if not found.names:
        return f"{title}{said}The experiments share no scenario.\n"

    def cell(scores):
        bounds = inference.median_interval(scores)
        return number(inference.median(scores)) + (" ({} to {})".format(*map(number, bounds)) if bounds else "")

    rows = [[name, *(cell(scores[name]) for scores in found.scores.values())] for name in found.names]
    header = ["scenario", *(f"`{variant.name}`" for variant in found.scores)]
    chart = "![The best robots in each scenario](scenarios.svg)\n"
    return title + "\n".join(part for part in (SCENARIOS, said, table(header, rows), chart) if part)


def differences(made):
    """Returns a warning if runs were made by different builds or devices, since these may cause differences between
    experiments."""
    lines = ""
    for what in [what for what, several in made.items() if len(several) > 1]:
        lines += f"- {what}:\n"
        for build, runs in made[what].items():
            lines += f"  - {build}: " + ", ".join(f"{count} of `{name}`" for name, count in runs.items()) + "\n"
    return lines and (
        "**Not all runs were made by the same builds and devices.** What the experiments differ in may come from that. "
        "A run that was resumed by another counts with each. To make runs anew, remove their folders and give the same "
        f"command.\n\n{lines}"
    )


def markdown(histories, objective, setting):
    devices, programs = (" and ".join(sorted(setting.builds[what])) for what in ("device", "evodevo"))
    seeds = f"{setting.seeds} {'seed' if setting.seeds == 1 else 'seeds'}"
    tested = f", the others tested against `{setting.against}`" if len(histories) > 1 else ""
    head = (
        f"# {objective.name} ({objective.unit}, {'more' if objective.maximise else 'less'} is better)\n\n"
        f"{seeds} of each experiment{tested}, on {devices}, evodevo {programs}. Made by\n\n```sh\n{setting.command}\n```\n"
    )
    parts = [
        head,
        differences(setting.builds),
        too_few_seeds(setting.seeds, len(histories)),
        "![Best so far over spring evaluations and over evaluations](chart.svg)\n",
        *(section(histories, objective, axis, setting.against) for axis in AXES),
        in_scenarios(histories, objective),
        whole_runs(histories),
        METHOD,
        TESTS if len(histories) > 1 else "",
    ]
    return "\n".join(part for part in parts if part)


def write_csv(file, histories):
    """Writes one line for each generation of each run. `best` is the best score so far; all other numbers are sums over
    the generations so far."""
    with open(file, "w", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        columns = ["evaluations", "spring_evaluations", "best", "diverged", "invalid", "seconds"]
        writer.writerow(["experiment", "seed", *columns])
        for variant, runs in histories.items():
            for seed, run in enumerate(runs, 1):
                generations = zip(*(getattr(run, column) for column in columns))
                next(generations)  # skips the state before the first generation
                for evaluations, springs, best, *failures, seconds in generations:
                    best_text = "" if math.isinf(best) else best
                    writer.writerow([variant.name, seed, evaluations, springs, best_text, *failures, f"{seconds:.3f}"])


def write_scenarios_csv(file, histories):
    """Writes the score of the best robot of each run in each scenario of its experiment; one line for each."""
    with open(file, "w", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(["experiment", "seed", "scenario", "score"])
        for variant, runs in histories.items():
            for seed, run in enumerate(runs, 1):
                writer.writerows([variant.name, seed, *score] for score in run.scenarios.items())
