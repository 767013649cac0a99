"""Implements the command, from its arguments to the report."""

import pathlib
import shlex

from common import charts
from common.command_line import Failure, ended

from . import arguments, chart, launchers, niches, questions, report, tables
from .history import history, objective_of
from .runs import Runs, make_variants, parse_setting, parse_sweep
from .scenarios import shared


def first_objective(shown):
    """Returns the first objective, by which runs are compared. It must be the same in all runs."""
    objectives = {objective_of(run["objectives"][0]) for run in shown}
    if len(objectives) > 1:
        names = ", ".join(sorted(f"{o.name} ({o.unit})" for o in objectives))
        raise Failure(f"the experiments differ in their first objective: {names}; only the same can be compared")
    return objectives.pop()


def tested_against(name, variants):
    """Returns the name of the variant that the others are tested against, which is the first by default."""
    names = [variant.name for variant in variants]
    if name is not None and name not in names:
        raise Failure(f"--against {name}: none of the experiments has that name; give one of {', '.join(names)}")
    return name or names[0]


def tell(line):
    print(line, flush=True)


def compare(words, program):
    given = arguments.parse(words)
    launchers.refuse_options(given)
    sweeps, settings = map(parse_sweep, given.sweep), map(parse_setting, given.set)
    variants = make_variants(given.experiments, list(sweeps), list(settings), given.random)
    against = tested_against(given.against, variants)
    pairs = [questions.parse(text, [variant.name for variant in variants]) for text in given.question]
    out = given.out or pathlib.Path("runs") / f"compare-{given.experiments[0].stem}"
    runs = Runs(program, out, variants, given.seeds)
    if given.launcher == "slurm":
        runs.check()
        if not launchers.make_in_array(runs, program, out, given.jobs, given.sbatch, tell):
            return
    else:
        launcher = launchers.launcher(given)
        runs.check()
        runs.make(given.jobs or 1, launcher, tell)

    if given.signal:
        runs.measure(given.signal, given.jobs or 1, tell)
    shown = {run: runs.shown(run) for run in runs.all}
    objective = first_objective(shown.values())
    histories = {
        variant: [history(shown[run], objective) for run in runs.all if run.variant == variant] for variant in variants
    }
    setting = report.Setting(
        command=shlex.join(["tools/compare", *map(str, words)]),
        seeds=len(given.seeds),
        against=against,
        questions=pairs,
        builds=report.builds(shown),
    )
    text = report.markdown(histories, objective, setting)
    (out / "report.md").write_text(text)
    tables.write_csv(out / "results.csv", histories, given.seeds)
    charts.save(chart.best_figure(histories, objective), out / "chart.svg")
    maps = niches.shared(histories, objective, against)
    if maps.histories:
        charts.save(chart.map_figure(maps.histories, [objective, *maps.quantities]), out / "map.svg")
    if in_scenarios := shared(histories, objective).scores:
        tables.write_scenarios_csv(out / "scenarios.csv", histories, given.seeds)
        if all(in_scenarios.values()):
            charts.save(chart.scenario_figure(in_scenarios, objective), out / "scenarios.svg")
    print(f"\n{text}\nwritten to {out}")


def main(words, program):
    return ended("compare", lambda: compare(words, program))
