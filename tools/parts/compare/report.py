"""Writes report.md, the report on a comparison."""

import collections
import dataclasses

from . import heredity, inference, niches, questions, scenarios
from .standings import AXES, common_cost, comparison, median_with_interval, number, table, too_few_seeds

METHOD = f"""\
## How to read this

A run's score is the best first objective of any robot so far, counted at the end of each generation: at a given cost it
is that of the last generation complete by then, without interpolation between generations. A run without a fitness is
below all others. One spring evaluation is the computation of one spring in one time step, so the simulation of
development counts as cost.

Intervals of medians over seeds are by the percentile bootstrap, from {inference.RESAMPLES:,} resamples of the runs.

Refused individuals lost their fitness in verification before the front (`[experiment] verify_front`), as artefacts, as
passive, or because they owed it to luck. The best robot of a whole run, where it was verified (`[experiment] verify`),
held, or is an artefact of the time step, passive, or both. If robots develop, it was also born again, with masses in
slightly other places, in lives in which development drew the same random numbers and in lives with new ones; the last
two columns count those that were at least half as good in most of these lives.
"""

TESTS = f"""\
A12 is the probability that a run is better than one of the experiment that is tested against, ties counting half: 0.5
is no difference; 0.56, 0.64 and 0.71 (or 0.44, 0.36 and 0.29) count as a small, medium and large one (Vargha & Delaney
2000). Its interval is that of Newcombe (2006, method 5) and allows for this row alone.

p is that of the two-sided Mann-Whitney U test: exact up to {inference.EXACT_UP_TO} runs of both together, with ties up
to {inference.EXACT_WITH_TIES_UP_TO}, and by the normal distribution beyond, corrected for ties. p (Holm) allows for all rows of its table. Below {inference.SIGNIFICANT} a difference counts as shown.
"""

NICHES = """\
The map of niches divides the ranges of one or two descriptors into cells. It counts all individuals that the run ever
evaluated, whatever its selection operator. Coverage is the share of the cells that some individual of the run lies in.
The QD score is the sum of the best scores of the filled cells (Pugh, Soros & Stanley 2016), of which negative ones
count as 0. Both are compared after equal numbers of evaluations only.
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
    questions: list = dataclasses.field(default_factory=list)  # pairs of names of variants


def builds(shown):
    """Counts the runs of each variant by the device and the builds that made them. `shown` is the output of `evodevo
    show --json` for each run. A run may have been made by several builds, one after the other or at the same time; it
    counts for each."""
    made = collections.defaultdict(lambda: collections.defaultdict(collections.Counter))
    for run, said in shown.items():
        for what, build in dict.fromkeys(by for provenance in provenances_of(said) for by in parts_of(provenance)):
            made[what][build][run.variant.name] += 1
    return made


def provenances_of(said):
    """Returns the provenances that have evaluated individuals of a run."""
    return [provenance for provenance in said["provenances"] if provenance["evaluations"] > 0]


def parts_of(provenance):
    """Yields the device, evodevo and each operator of a provenance with its build; results depend on all of them."""
    yield "device", provenance["device"]
    yield "evodevo", f"{provenance['evodevo']} ({provenance['program']})"
    for operator in provenance["operators"]:
        yield f"{operator['kind']} `{operator['name']}`", f"{operator['version']} ({operator['hash']})"


def capitalised(text):
    return text[0].upper() + text[1:]


def share(part, whole):
    return f"{100 * part / whole:.2f} %"


def section(histories, objective, axis, against):
    """Returns the section on the best scores at the highest cost that every run has reached."""
    cost, obstacle = common_cost(histories, axis)
    other = next(name for name in AXES if name != axis)
    spent = [(f"{AXES[other]} by then", other), ("generations", "generations")]
    compared = obstacle or comparison(histories, objective, axis, cost, against, spent)
    return f"## After {number(cost)} {AXES[axis]}\n\n{compared}"


def verified(runs):
    """Returns table cells that count, among the verified best robots, those without a mark, the artefacts and the
    passive ones; and among those that were born again, those that kept their score in most of these lives, with the same
    draws and with new ones."""
    marks = [history.marks for history in runs if history.marks is not None]
    if not marks:
        return ["not verified", "-", "-", "-", "-"]
    counts = [marks.count([]), *(sum(mark in some for some in marks) for mark in ("artefact", "passive"))]

    def kept(lives):
        lives = [each for each in lives if each]
        return f"{sum(2 * sum(each) > len(each) for each in lives)} of {len(lives)}" if lives else "-"

    born_again = [kept([run.reborn for run in runs]), kept([run.redrawn for run in runs])]
    return [*(f"{count} of {len(marks)}" for count in counts), *born_again]


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
                share(sum(history.refused[-1] for history in runs), evaluations),
                f"{sum(history.seconds[-1] for history in runs) / 3600:.2f}",
                *verified(runs),
            ]
        )
    header = ["", "generations", "evaluations", "spring evaluations", "diverged", "invalid", "refused", "hours"]
    header += ["best held", "best is artefact", "best is passive", "best kept, same draws", "best kept, new draws"]
    return f"## All runs, each to its end\n\n{table(header, rows)}"


def in_scenarios(histories, objective):
    """Returns the section on the best robots in each scenario that all experiments with scenarios share, or an empty
    text if no experiment has any."""
    found = scenarios.shared(histories, objective)
    if not found.scores:
        return ""
    said = "".join(f"`{name}` has no scenarios and is not in this comparison.\n" for name in found.without)
    for scenario, names in found.left_out.items():
        said += f"Not compared: \"{scenario}\", which only {' and '.join(f'`{name}`' for name in names)} has.\n"
    title = f"## {capitalised(objective.name)} of the best robots in each scenario\n\n"
    if not found.names:
        return f"{title}{said}The experiments share no scenario.\n"

    rows = [[name, *(median_with_interval(scores[name]) for scores in found.scores.values())] for name in found.names]
    header = ["scenario", *(f"`{variant.name}`" for variant in found.scores)]
    chart = "![The best robots in each scenario](scenarios.svg)\n"
    return title + "\n".join(part for part in (SCENARIOS, said, table(header, rows), chart) if part)


def not_in_maps(found, objective, against):
    """Returns sentences on what the comparison by maps leaves out, and why."""
    said = ""
    for names, reason in (
        (found.without, "they have no map of niches"),
        (found.different, f"their maps have other axes than that of `{against}`"),
    ):
        if names:
            said += f"Not compared, because {reason}: {', '.join(f'`{name}`' for name in names)}.\n"
    if not objective.maximise:
        said += (
            f"No QD score, because less {objective.name} is better: a sum over the filled cells would favour runs that "
            "fill fewer of them.\n"
        )
    return said


def by_maps(histories, objective, against):
    """Returns the section on the maps of niches, or an empty text if no experiment has one."""
    found = niches.shared(histories, objective, against)
    if len(found.without) == len(histories):
        return ""
    title = f"## {capitalised(' and '.join(quantity.name for quantity in found.quantities))}"
    if not found.histories:
        return (
            f"{title}\n\nNot compared: `{against}` has no map of niches to test others against; name another "
            "experiment with `--against`.\n"
        )
    cost, obstacle = common_cost(found.histories, "evaluations")
    parts = [f"{title} after {number(cost)} evaluations\n", not_in_maps(found, objective, against), obstacle]
    for quantity in [] if obstacle else found.quantities:
        parts.append(f"### {capitalised(quantity.name)} ({quantity.unit})\n")
        parts.append(comparison(found.histories, quantity, "evaluations", cost, against))
    parts.append("![The maps of niches over evaluations](map.svg)\n")
    return "\n".join(part for part in parts if part)


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
        "A run that was resumed by another counts with each. To make runs anew, remove their files in `rows` and their "
        f"folders in `runs`, and give the same command.\n\n{lines}"
    )


def markdown(histories, objective, setting):
    devices, programs = (" and ".join(sorted(setting.builds[what])) for what in ("device", "evodevo"))
    seeds = f"{setting.seeds} {'seed' if setting.seeds == 1 else 'seeds'}"
    tested = f", the others tested against `{setting.against}`" if len(histories) > 1 else ""
    head = (
        f"# {objective.name} ({objective.unit}, {'more' if objective.maximise else 'less'} is better)\n\n"
        f"{seeds} of each experiment{tested}, on {devices}, evodevo {programs}. Made by\n\n```sh\n{setting.command}\n```\n"
    )
    maps = by_maps(histories, objective, setting.against)
    parts = [
        head,
        differences(setting.builds),
        too_few_seeds(setting.seeds, len(histories)),
        "![Best so far over spring evaluations and over evaluations](chart.svg)\n",
        questions.section(histories, objective, setting.questions),
        *(section(histories, objective, axis, setting.against) for axis in AXES),
        maps,
        in_scenarios(histories, objective),
        heredity.section(histories, objective, setting.against),
        whole_runs(histories),
        METHOD,
        NICHES if maps else "",
        TESTS if len(histories) > 1 else "",
    ]
    return "\n".join(part for part in parts if part)
