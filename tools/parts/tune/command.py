"""Implements the command, from its arguments to the report."""

import pathlib
import shlex
import subprocess

import numpy

from common import charts
from common.command_line import Failure, ended
from compare import launchers
from compare.runs import has_table_of, parse_setting, read_experiment

from . import arguments, chart, edit, report, tables
from .effects import effects
from .ranges import parse_range
from .trials import Trials
from .tuning import Tuning, smallest_budget


def value_at(experiment, key):
    """Returns the value of a key in an experiment, or None if it is not written."""
    node = experiment
    for part in key.split("."):
        if isinstance(node, list):
            node = node[int(part)] if part.isdecimal() and int(part) < len(node) else None
        else:
            node = node.get(part) if isinstance(node, dict) else None
    return node


def refuse_keys(experiment, parameters, settings):
    """Refuses a key that is given twice, or lies in another, or whose table is missing, or that is a table."""
    given = [*((each.key, "--over") for each in parameters), *((key, "--set") for key, _ in settings)]
    for i, (key, option) in enumerate(given):
        for other, _ in given[:i]:
            if f"{key}.".startswith(f"{other}.") or f"{other}.".startswith(f"{key}."):
                raise Failure(f"{option} {key}: {other} is given as well; give one of them, once")
        if not has_table_of(experiment, key):
            raise Failure(f"{option} {key}: the experiment has no table [{key.rpartition('.')[0]}]; add it")
        value = value_at(experiment, key)
        tables = value if isinstance(value, list) else [value]
        if option == "--over" and any(isinstance(table, dict) for table in tables):
            raise Failure(f"--over {key}: this is a table; give one of its keys, such as {key}.name")


def refuse_small_budget(budget, parameters):
    least = smallest_budget(len(parameters))
    if budget < least:
        raise Failure(
            f"--budget {budget}: too few runs to tune {len(parameters)} {'key' if len(parameters) == 1 else 'keys'}; "
            f"give at least {least}"
        )


def refuse_text(experiment, parameters):
    """Refuses an experiment whose text the best values could not be written to."""
    random = numpy.random.default_rng(1)
    edit.with_values(read_text(experiment), [(each.key, each.draw(random)) for each in parameters])


def nothing_left(experiment, obstacles):
    reason = next(iter(obstacles.values()), "all drawn values are those of the experiment")
    return f"{experiment}: no configurations to compare are left; mend the first obstacle, or change --over:\n{reason}"


def read_text(file):
    return file.read_bytes().decode()  # with its ends of lines as they are


def write_best(program, out, experiment, variant):
    """Writes best.toml, and returns what the program has against it, or an empty text."""
    file = out / "best.toml"
    file.write_bytes(edit.with_values(read_text(experiment), variant.swept).encode())
    checked = subprocess.run([str(program), "check", str(file)], capture_output=True, text=True)
    if checked.returncode == 0:
        return ""
    return (
        f"{file} is not accepted where it lies; copy it to {experiment.parent}, to which its relative paths belong:\n"
        f"{checked.stderr.strip()}\n"
    )


def tell(line):
    print(line, flush=True)


def tune(words, program):
    given = arguments.parse(words)
    launchers.refuse_options(given)
    parameters = [parse_range(text) for text in given.over]
    settings = tuple(parse_setting(text) for text in given.set)
    experiment = read_experiment(given.experiment)
    refuse_keys(experiment, parameters, settings)
    refuse_small_budget(given.budget, parameters)
    refuse_text(given.experiment, parameters)
    own = tuple(parameter.find(value_at(experiment, parameter.key)) for parameter in parameters)
    out = given.out or pathlib.Path("runs") / f"tune-{given.experiment.stem}"

    launcher = launchers.launcher(given)

    def make(runs):
        runs.make(given.jobs, launcher, lambda line: tell(f"  {line}"))

    trials = Trials(program, out, given.experiment, settings, parameters, make, tell)
    tuning = Tuning(parameters, own, given.budget, given.seed, trials.accept, trials.evaluate, tell)
    tuning.run()
    if not tuning.ranked:
        raise Failure(nothing_left(given.experiment, trials.obstacles))
    write(program, out, given, words, parameters, trials, tuning)


def write(program, out, given, words, parameters, trials, tuning):
    best = tuning.ranked[0]
    objection = write_best(program, out, given.experiment, trials.variant(best))
    scored = [each for each in tuning.configurations if each.scores]
    found = effects(parameters, scored, lambda each: each.values)
    setting = report.Setting(shlex.join(["tools/tune", *words]), given.budget, trials.made_by, trials.obstacles)
    text = report.markdown(tuning, parameters, trials.objective, found, setting)
    (out / "report.md").write_text(text)
    tables.write_csv(
        out / "results.csv", parameters, tuning.configurations, trials.results, lambda each: trials.variant(each).name
    )
    tried = [(each.values, trials.objective.upwards(each.scores), each is best) for each in scored]
    charts.save(chart.figure(parameters, tried, trials.objective), out / "chart.svg")
    print(f"\n{text}\n{objection}written to {out}; the best experiment is {out / 'best.toml'}")


def main(words, program):
    return ended("tune", lambda: tune(words, program))
