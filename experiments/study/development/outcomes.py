#!/usr/bin/env python3
r"""Measures what the plan of this study describes besides distance: how the best robots fare in other scenes, how fast
evolution goes on when it moves to another scene, how much bodies differ, and when the line of the best robot began.

  tools/compare experiments/study/development/evo.toml experiments/study/development/evo-devo.toml --seeds 101..150 \
    --out runs/study
  EVODEVO_PROGRAM=build/cuda/bin/evodevo python3 experiments/study/development/outcomes.py runs/study

The best robot of each run is born again, LIVES times with other random numbers, in the scenarios of scenarios.txt. The
last population of each run goes on to evolve on a slope. The bodies of BODIES robots of each last population are
compared in pairs. Each result is kept in `outcomes/rows`, and what is there is not measured again, so that a run can be
removed once it has been measured; one that was removed before is left out. `--jobs N` makes N measurements at once.
Prints medians over the runs with their intervals, and writes all numbers to `outcomes/outcomes.csv`. Needs SciPy.
"""

import argparse
import collections
import concurrent.futures
import contextlib
import functools
import itertools
import json
import math
import os
import pathlib
import sqlite3
import statistics
import subprocess
import sys

from scipy import stats

HERE = pathlib.Path(__file__).resolve().parent
sys.path.append(str(HERE.parents[2] / "tools/parts"))

from common.command_line import positive  # noqa: E402
from compare import rows  # noqa: E402
from compare.continued import Arm, Continuation, Program  # noqa: E402
from compare.history import history, objective_of  # noqa: E402
from compare.measured import report, write_csv  # noqa: E402
from compare.scenarios import by_scenario  # noqa: E402

LIVES = 3
ENOUGH = 0.5  # of the distance in the run
ALONE = ("population=1", "random_individuals=0", "evaluations=1", "verify=0", "verify_front=off")
MOVE = "scene.gravity.slope=-10"  # degrees, uphill
GENERATIONS = (1, 2, 4)  # after which the distance on the slope is told
BODIES = 10  # of each population


def lives_in_scenarios(arm, run):
    """Returns the runs in which the best robot of a run is born again in the scenarios."""
    experiment = f"{arm.experiment}\n{(HERE / 'scenarios.txt').read_text()}"
    settings = arm.settings(*(f"experiment.{setting}" for setting in ALONE))
    names = {life: f"scenarios/{arm.name}/{run.name}-life-{life}" for life in range(1, LIVES + 1)}
    return [Continuation(name, experiment, settings, run, life) for life, name in names.items()]


def distances_of_lives(out, arm, run):
    """Returns for each further life of the best robot of a run its distances by scenario. Lives in which it diverges
    in one of the scenes have no distances, and are left out. None if the lives have not been measured."""
    again = lives_in_scenarios(arm, run)
    if not all(life.row(out).exists() for life in again):
        return None
    lives = [rows.read(life.row(out)) for life in again]
    return [by_scenario(shown["best"], objective_of(shown["objectives"][0])) for shown in lives if shown["best"]]


def born_again(_, out, arm, run):
    """Returns how far the best robot of a run gets at home in other lives, in which development draws other random
    numbers, and in how many of them and of those of its verification, which also begin in slightly other places, it
    keeps ENOUGH; None if nothing has been measured and the run is gone. The same holds for the other outcomes."""
    shown = rows.read(arm.row(run))
    if shown["best"] is None:
        return None
    distance = shown["best"]["objectives"][shown["objectives"][0]["name"]]
    found = {}
    if lives := distances_of_lives(out, arm, run):
        again = [life["home"] for life in lives]
        found["in the run"], found["median life"] = distance, statistics.median(again)
        found["lives that kept half, %"] = 100 * statistics.fmean(each >= ENOUGH * distance for each in again)
    verified = history(shown, objective_of(shown["objectives"][0]))
    if perturbed := verified.redrawn or verified.reborn:  # rows of before call those with other numbers reborn
        found["of lives with other places at birth, %"] = 100 * statistics.fmean(perturbed)
    return found or None


def in_scenarios(_, out, arm, run):
    """Returns the distances of the best robot of a run by scenario, each the mean of several lives."""
    lives = distances_of_lives(out, arm, run)
    if not lives:
        return None
    scores = collections.defaultdict(list)
    for scenario, score in itertools.chain.from_iterable(life.items() for life in lives):
        scores[scenario].append(score)
    return {scenario: statistics.fmean(of_lives) for scenario, of_lives in scores.items()}


def population_of(arm, run):
    return rows.read(arm.row(run))["generations"][0]["evaluations"]


def move_to_the_slope(arm, run):
    """Returns the run in which the last population of a run goes on to evolve on a slope."""
    evaluations = f"experiment.evaluations={GENERATIONS[-1] * population_of(arm, run)}"
    settings = arm.settings(MOVE, evaluations, "experiment.verify=0")
    return Continuation(f"slope/{arm.name}/{run.name}", arm.experiment, settings, run, int(run.name.split("-")[1]))


def on_the_slope(_, out, arm, run):
    """Returns the best distance so far after each of GENERATIONS on the slope."""
    row = move_to_the_slope(arm, run).row(out)
    if not row.exists():
        return None
    shown = rows.read(row)
    past = history(shown, objective_of(shown["objectives"][0]))
    population = population_of(arm, run)
    return {f"after {count * population} evaluations": past.at("generations", count, "best") for count in GENERATIONS}


def shape(body):
    """Returns the distances of a newborn's masses from their centre, in body lengths."""
    places = [mass["position"] for mass in body["masses"]]
    axes = list(zip(*places))
    length = max(max(axis) - min(axis) for axis in axes)
    centre = [statistics.fmean(axis) for axis in axes]
    return [math.dist(place, centre) / length for place in places]


def lengths(body):
    """Returns the rest lengths of a body's springs, m. Unlike positions, they do not depend on the pose."""
    return [spring["rest_length"] for spring in body["springs"]]


def mean_distance(descriptions):
    """Returns the mean Wasserstein distance between the pairs of some lists of numbers."""
    pairs = list(itertools.starmap(stats.wasserstein_distance, itertools.combinations(descriptions, 2)))
    return statistics.fmean(pairs) if pairs else -math.inf


def living(folder):
    """Returns the ids of those in the last population that have a fitness."""
    with contextlib.closing(sqlite3.connect(f"file:{folder / 'run.sqlite'}?mode=ro", uri=True)) as archive:
        found = archive.execute("SELECT id FROM individuals WHERE died IS NULL AND status = 'ok' ORDER BY id")
        return [number for (number,) in found]


def matured(program, run, number):
    """Returns the matured body of an individual, or None if it does not mature on this device: on another one than that
    of the run, it can diverge."""
    try:
        return program.json("body", run, "--individual", number, "--matured")
    except subprocess.CalledProcessError:  # the program has said why
        print(f"left out: individual {number} of {run}", file=sys.stderr)
        return None


def between_bodies(program, out, arm, run):
    """Returns the mean distances between the bodies of a population: of their shapes at birth, and of the lengths of
    their springs at birth and, as far as they mature, matured."""
    row = out / "rows" / "bodies" / arm.name / f"{run.name}.json"
    if not row.exists():
        if not run.exists():
            return None
        ids = living(run)
        chosen = ids[:: max(1, len(ids) // BODIES)][:BODIES]
        newborn = [program.json("body", run, "--individual", number) for number in chosen]
        grown = [body for number in chosen if (body := matured(program, run, number)) is not None]
        distances = {
            "shape at birth, body lengths": mean_distance(map(shape, newborn)),
            "springs at birth, m": mean_distance(map(lengths, newborn)),
            "springs when matured, m": mean_distance(map(lengths, grown)),
        }
        rows.store(row, distances)
    return json.loads(row.read_text())


def line_of_the_best(program, out, arm, run):
    """Returns the shares of the run after which the oldest genes of its best robot began to evolve, and after which
    that robot was born, %; None if there is no such robot, or only one generation."""
    shown = rows.read(arm.row(run))
    best, last = shown["best"], len(shown["generations"]) - 1
    if best is None or last == 0:
        return None
    generations = {"the line began": last - best["age"], "the robot was born": best["generation"]}
    return {what: 100 * generation / last for what, generation in generations.items()}


OUTCOMES = (
    ("Distance of the best robot when it is born again", born_again),
    ("Distance in other scenes", in_scenarios),
    ("Distance on a slope to which evolution moved", on_the_slope),
    ("Distance between the bodies of a population", between_bodies),
    ("The line of the best robot, % of the run", line_of_the_best),
)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path, help="of the comparison, that is, --out of tools/compare")
    parser.add_argument("--jobs", metavar="N", type=positive, default=1, help="measurements at once (1)")
    given = parser.parse_args()
    folder, out = given.folder, given.folder / "outcomes"
    program = Program(os.environ.get("EVODEVO_PROGRAM", "evodevo"), given.jobs)
    arms = [Arm(file.parent) for file in sorted(folder.glob("rows/*/made-from.json"))]
    if not arms:
        sys.exit(f"{folder}: has no complete runs; give the folder that tools/compare wrote, which holds rows/ and runs/")
    of_all = [(arm, run) for arm in arms for run in arm.runs]
    lives = [life for arm, run in of_all for life in lives_in_scenarios(arm, run)]
    program.make(out, [*lives, *(move_to_the_slope(arm, run) for arm, run in of_all)])
    with concurrent.futures.ThreadPoolExecutor(given.jobs) as pool:

        def begin(measure):
            """Returns for each arm what is measured of its runs, each as soon as it is known."""
            return {arm: pool.map(functools.partial(measure, program, out, arm), arm.runs) for arm in arms}

        def end(arm, measured):
            """Returns what was measured of the runs of an arm, by their names."""
            return {run.name: numbers for run, numbers in zip(arm.runs, measured) if numbers is not None}

        begun = [(title, begin(measure)) for title, measure in OUTCOMES]
        known = [(title, {arm.name: end(arm, runs) for arm, runs in of_arms.items()}) for title, of_arms in begun]
    write_csv(known, out / "outcomes.csv")
    text = "\n".join(report(title, of_arms) for title, of_arms in known)
    (out / "report.md").write_text(text)
    print(text)


if __name__ == "__main__":
    main()
