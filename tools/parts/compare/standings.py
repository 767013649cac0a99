"""How variants stand at a cost by a quantity, as text: medians, tests against one of the variants, and verdicts."""

import dataclasses
import math
import re

from . import inference
from .history import common_span

AXES = {"spring_evaluations": "spring evaluations", "evaluations": "evaluations"}
INTERVAL = f"{100 * inference.LEVEL:.0f} % interval"


def number(value):
    if math.isinf(value):
        return "none"
    if 1e3 <= abs(value) < 1e6:
        return f"{value:.0f}"
    return re.sub(r"e\+?(-?)0*", r"e\1", f"{value:.3g}")


def table(header, rows):
    lines = [header, ["---"] * len(header), *rows]
    return "".join("| " + " | ".join(line) + " |\n" for line in lines)


def median_with_interval(values):
    """Returns the median and, if there are enough values, its interval."""
    bounds = inference.median_interval(values)
    return number(inference.median(values)) + (" ({} to {})".format(*map(number, bounds)) if bounds else "")


@dataclasses.dataclass(frozen=True)
class Standing:
    """One variant at one cost, compared with the variant that it is tested against."""

    name: str
    values: list
    a12: float
    p: float
    holm: float

    def achieved(self, spent):
        """Returns the first cells of the variant's row in the table: the median with its interval, and the medians of
        what the runs had spent."""
        bounds = inference.median_interval(self.values)
        interval = "{} to {}".format(*map(number, bounds)) if bounds else "-"
        middle, *costs = (number(inference.median(values)) for values in (self.values, *spent))
        return [f"`{self.name}`", middle, interval, *costs]

    def interval(self):
        return "{:.2f} to {:.2f}".format(*inference.superiority_interval(self.a12, len(self.values), len(self.values)))

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


def standings(histories, quantity, axis, cost, against):
    """Returns the standings of all variants at one cost, tested against the variant with the name `against`."""
    values = {
        variant.name: [run.at(axis, cost, quantity.column) for run in runs] for variant, runs in histories.items()
    }
    upwards = {name: quantity.upwards(some) for name, some in values.items()}
    ps = {name: inference.rank_sum_test(some, upwards[against]) for name, some in upwards.items()}
    others = [name for name in values if name != against]
    adjusted = {against: 1.0, **dict(zip(others, inference.holm([ps[name] for name in others])))}
    return [
        Standing(name, values[name], inference.superiority(upwards[name], upwards[against]), ps[name], adjusted[name])
        for name in values
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


def common_cost(histories, axis):
    """Returns the highest cost that every run has reached, and a text that explains why nothing is compared there. The
    text is empty if every run has completed a generation by then."""
    start, cost = common_span([run for runs in histories.values() for run in runs], axis)
    return cost, too_early(histories, axis, cost) if cost < start else ""


def too_early(histories, axis, cost):
    """Explains why nothing is compared at a cost at which some run has not completed a generation."""
    late = " and ".join(f"`{variant.name}`" for variant, runs in histories.items() if common_span(runs, axis)[0] > cost)
    ending = min(histories, key=lambda variant: common_span(histories[variant], axis)[1]).name
    return (
        f"Not compared: a run of `{ending}` ends before the first generation of every run of {late} is complete. "
        f"Let `{ending}` run longer (`experiment.evaluations`, `experiment.spring_evaluations`), or give {late} "
        "smaller generations (`experiment.children` or, without it, `experiment.population`).\n"
    )


def comparison(histories, quantity, axis, cost, against, spent=()):
    """Returns the verdicts and the table at one cost. `spent` names the lists of histories whose medians the table has
    in further columns: pairs of a header and a list."""
    all_standings = standings(histories, quantity, axis, cost, against)
    others = [standing for standing in all_standings if standing.name != against]
    header = ["", f"median {quantity.name}", INTERVAL, *(title for title, _ in spent)]
    rows = [
        standing.achieved([run.at(axis, cost, what) for run in runs] for _, what in spent)
        for standing, runs in zip(all_standings, histories.values())
    ]
    if not others:
        return table(header, rows)
    judged = verdicts_possible(len(others[0].values), len(histories))
    verdicts = "".join(f"{standing.verdict(against)}\n" for standing in others) + "\n" if judged else ""
    tests = [["-"] * 4 if standing.name == against else standing.tests(judged) for standing in all_standings]
    return verdicts + table(header + ["A12", INTERVAL, "p", "p (Holm)"], map(list.__add__, rows, tests))
