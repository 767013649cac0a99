"""Writes report.md, the report on a race."""

import dataclasses

from compare import inference
from compare.standings import INTERVAL, number, table

from .race import FIRST_TEST, SIGNIFICANT
from .tuning import smallest_budget

METHOD = f"""\
## How to read this

The score of a run is the first objective of its best robot. If that robot has no fitness, or if verification marked it
as an artefact or as passive, the score is the worst possible one. All configurations get the same seeds, and all runs
the same `evaluations` and `spring_evaluations`. From seed {FIRST_TEST} on, each seed ends with a test of all
configurations that are left: a Friedman test with Conover's comparison to the best, or a Wilcoxon signed-rank test if
there are two. With p below {SIGNIFICANT}, what is worse drops out. That a configuration dropped out is no proof that it
is worse, because a race makes many tests and does not correct for their number.

The best configuration was chosen by the scores that the table shows, so its median is too favourable. To measure how
much better than the experiment it is, compare both with `tools/compare` and many more seeds than the race used; it
began with seed 1, too.

The share of others that a configuration beats is the mean over its first {FIRST_TEST} seeds; ties count half.
A main effect is the difference of this share between the best and the worst level of a key. Its interval is by the
percentile bootstrap over configurations. The levels were chosen after the fact, so effects are too large, most of all
with few configurations. After the first iteration, configurations are drawn around the best. The values of different
keys are then no longer independent: an effect may be that of another key.
"""


@dataclasses.dataclass(frozen=True)
class Setting:
    """The command line of a race, and what made its runs."""

    command: str
    budget: int
    builds: dict  # for the device, evodevo and each operator: builds
    obstacles: dict  # by configuration: why it was refused or failed


def value_of(text):
    return "-" if text is None else f"`{text}`"


def iterations(tuning):
    header = ["iteration", "new configurations", "seeds", "runs", "dropped", "left"]
    rows = [[str(value) for value in dataclasses.astuple(each)] for each in tuning.iterations]
    return f"## The race\n\n{tuning.runs} runs of a budget of {{}}.\n\n{table(header, rows)}"


def order(tuning):
    """Returns the configurations that were run: what is left, the best first, and then those with more seeds first."""
    rest = [each for each in tuning.configurations if each not in tuning.ranked and each.fate != "refused"]
    return tuning.ranked + sorted(rest, key=lambda each: (-len(each.scores), each.mean_rank or 0, each.number))


def fate(configuration, tuning):
    what = "best" if configuration is tuning.ranked[0] else configuration.fate
    return f"{what}, the experiment" if configuration.is_own else what


def row(configuration, tuning, objective):
    scores = objective.upwards(configuration.scores)  # from more is better, back to the scores
    bounds = inference.median_interval(scores) if scores else None
    return [
        str(configuration.number),
        *map(value_of, configuration.values),
        fate(configuration, tuning),
        str(len(scores)),
        "-" if configuration.mean_rank is None else f"{configuration.mean_rank:.1f} of {configuration.rivals}",
        number(inference.median(scores)) if scores else "-",
        "{} to {}".format(*map(number, bounds)) if bounds else "-",
    ]


def configurations(tuning, parameters, objective):
    keys = [f"`{parameter.key}`" for parameter in parameters]
    header = ["", *keys, "", "seeds", "mean rank", f"median {objective.name}", INTERVAL]
    return (
        "## Configurations\n\nTests dropped some configurations; others were outranked, that is, not among the few that "
        "an iteration hands on to the next. The mean rank is that in the last test of the configuration, in which 1 is "
        "the best. A value - is that of the experiment, which is not in the range or not in the file. Intervals take "
        f"{inference.INTERVAL_FROM} seeds.\n\n"
        + table(header, [row(each, tuning, objective) for each in order(tuning)])
    )


def obstacles(tuning, reasons):
    """Returns sentences on the configurations that could not be run, with the first reason for each fate."""
    said = ""
    for fate, what in (
        ("refused", "not accepted by `evodevo check`; others took their places, at no cost"),
        ("failed", "dropped because a run failed"),
    ):
        some = [each for each in tuning.configurations if each.fate == fate]
        if some:
            reason = "\n".join(f"    {line}" for line in reasons[some[0]].splitlines())
            said += f"{len(some)} configurations were {what}. The first reason:\n\n{reason}\n\n"
    return said


def main_effects(found):
    lines = ""
    for effect in sorted(found, key=lambda effect: -(effect.size or 0)):
        bounds = "{:.2f} to {:.2f}".format(*effect.interval) if effect.interval else "too few for an interval"
        size = "fewer than two levels" if effect.size is None else f"{effect.size:.2f} ({bounds})"
        lines += f"### `{effect.key}`: {size}\n\n"
        rows = [[level.name, str(len(level.shares)), f"{level.mean:.2f}"] for level in effect.levels]
        lines += table(["value", "configurations", "share of others beaten"], rows) + "\n"
    return f"## What mattered\n\n{lines}" if lines else ""


def verdict(tuning, parameters):
    best, rivals = tuning.ranked[0], len(tuning.ranked) - 1
    said = (
        "The experiment's own values are the best.\n"
        if best.is_own
        else "The best values: " + ", ".join(f"`{p.key} = {v}`" for p, v in zip(parameters, best.values)) + ".\n"
    )
    if rivals:
        others = ", ".join(str(each.number) for each in tuning.ranked[1:])
        said += f"The race did not tell them from those of configurations {others}; a larger `--budget` may.\n"
    return said


def markdown(tuning, parameters, objective, found, setting):
    devices, programs = (" and ".join(setting.builds.get(what, ("none",))) for what in ("device", "evodevo"))
    several = [what for what, builds in setting.builds.items() if len(builds) > 1]
    least = smallest_budget(len(parameters))
    parts = [
        f"# {objective.name} ({objective.unit}, {'more' if objective.maximise else 'less'} is better)\n",
        f"On {devices}, evodevo {programs}. Made by\n\n```sh\n{setting.command}\n```\n",
        f"**The runs were made by different builds or devices** ({', '.join(several)}).\n" if several else "",
        verdict(tuning, parameters),
        f"This budget is small: below {3 * least} runs, the first iteration has few configurations, and their "
        "number of seeds rarely suffices to tell them apart.\n" if setting.budget < 3 * least else "",
        "![The scores of all configurations](chart.svg)\n",
        iterations(tuning).format(setting.budget),
        configurations(tuning, parameters, objective),
        obstacles(tuning, setting.obstacles),
        main_effects(found),
        METHOD,
    ]
    return "\n".join(part for part in parts if part)
