#!/usr/bin/env python3
r"""Measures the outcomes of the plan of this study (README.md) after the runs, and answers its questions.

  tools/compare experiments/study/inheritance/*.toml --seeds 301..350 --out runs/inheritance
  EVODEVO_PROGRAM=build/cuda/bin/evodevo python3 experiments/study/inheritance/outcomes.py runs/inheritance

Of each run it first writes to `kept` what the outcomes need of it: the last population, the line of the best robot, and
the best robots of earlier generations. Then the run itself can be removed. Each result is kept in `outcomes/rows`, and
what is there is not measured again. `--jobs N` makes N measurements at once. `--only lives` measures nothing but the
lives that answer the questions, and `--only inborn` those and that outcome. Prints the tables and writes them to
`outcomes/report.md`, all numbers to `outcomes/outcomes.csv` and a chart of the lives to `outcomes/lives.svg`. Needs
SciPy and Matplotlib.
"""

import argparse
import collections
import concurrent.futures
import functools
import json
import os
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parents[2] / "tools/parts")]

import answers  # noqa: E402
import bodies  # noqa: E402
import figures  # noqa: E402
import kept  # noqa: E402
from common import charts  # noqa: E402
from common.command_line import positive  # noqa: E402
from compare import rows  # noqa: E402
from compare.continued import Arm, Continuation, Program  # noqa: E402
from compare.measured import report, write_csv  # noqa: E402

LIVES = 12  # of a robot that is born again
SEEN = 3  # the first of them, which selection may have seen
ALONE = ("population=1", "children=1", "random_individuals=0", "evaluations=1", "spring_evaluations=0")
ALONE = (*ALONE, "verify=0", "verify_front=off", f"lives={LIVES}")
OTHER_SEED = 10000  # added to a run's seed: of new draws, and twice of the runs in which robots are born again
SHARES = {"development needed, %", "marked, %", "needed, %"}  # of the runs: of each run all or nothing
SCENES = {
    "slope": "scene.gravity.slope=-10",  # degrees, uphill along x
    "load": "scene.payload.share=0.5",  # of the body's mass
    "damage": "scenario.0.damage=0.1",  # share of the springs that are lost around a random place
}
MOVED = ("evaluations=200", "spring_evaluations=0", "verify=0")  # of evolution in another scene
MARKS = {"artefact", "passive"}
RUNS_MOVED, RUNS_OF_SIGNAL, RUNS_COMPARED = 20, 10, 20  # of each arm: the first ones
ROBOTS = 40  # that `signal` measures


def seed_of(run):
    return int(run.name.split("-")[1])


def alone(arm, run, name, start, *settings):
    """Returns the run in which the best robot of `start` lives LIVES times."""
    settings = arm.settings(*(f"experiment.{setting}" for setting in ALONE), *settings)
    seed = 2 * OTHER_SEED + seed_of(run)
    return Continuation(f"lives/{arm.name}/{run.name}/{name}", arm.experiment, settings, start, seed)


class Lives:
    """How far the best robot of a run goes in lives to come, with the draws of its run, with new ones, and without
    development; and the same of the best robots after each quarter of the run."""

    def __init__(self, out, arm, run, start):
        new = ("development.draws_between_lives=new", f"development.seed={OTHER_SEED + seed_of(run)}")
        ways = {"same draws": ()}
        if arm.develops:
            ways |= {"new draws": new, "without development": ("development.control=no-change",)}
        self._out = out
        self.of_end = {way: alone(arm, run, way.replace(" ", "-"), start, *more) for way, more in ways.items()}
        self.of_quarters = {}
        if arm.develops and start.exists():
            for quarter, folder in enumerate(kept.bests(start, out / "starts" / arm.name / run.name)):
                for way in ("same draws", "without development"):
                    name = f"quarter-{quarter}-{way.replace(' ', '-')}"
                    self.of_quarters[quarter, way] = alone(arm, run, name, folder, *ways[way])

    @property
    def runs(self):
        return [*self.of_end.values(), *self.of_quarters.values()]

    def score(self, way):
        return mean_of_lives(self._out, self.of_end[way]) if way in self.of_end else None

    def share_without(self, quarter):
        """Returns the share of the distance that is left without development, or None if there is too little."""
        ways = ("same draws", "without development")
        runs = self.of_end if quarter == kept.PARTS else {way: self.of_quarters.get((quarter, way)) for way in ways}
        whole, rest = (runs.get(way) and mean_of_lives(self._out, runs[way]) for way in ways)
        return answers.share(rest, whole)


def mean_of_lives(out, life):
    """Returns the mean distance of the lives that selection has not seen, 0 if the robot fails in one of all lives, or
    None if they have not been measured."""
    if not life.row(out).exists():
        return None
    shown = rows.read(life.row(out))
    if shown["best"] is None:
        return 0.0
    name = shown["objectives"][0]["name"]
    distances = [life[name] for life in shown["best"]["lives"]][SEEN:]
    return sum(distances) / len(distances)


class Moved:
    """Evolution that goes on in another scene, and what the best robots go there before and after."""

    def __init__(self, out, arm, run, start, scene):
        self._out = out
        setting = SCENES[scene]
        settings = arm.settings(setting, *(f"experiment.{each}" for each in MOVED))
        self.evolution = Continuation(f"moved/{scene}/{arm.name}/{run.name}", arm.experiment, settings, start, seed_of(run))
        self.before = alone(arm, run, f"{scene}-before", start, setting)
        self.after = alone(arm, run, f"{scene}-after", self.evolution.folder(out), setting)

    def numbers(self):
        numbers = {"before": mean_of_lives(self._out, self.before), "after": mean_of_lives(self._out, self.after)}
        return {when: value for when, value in numbers.items() if value is not None}


def stored(row, measure):
    """Returns what is in a row, after measuring it if there is none; None if there is nothing to measure, or if it failed,
    of which the program has said why."""
    if not row.exists():
        try:
            rows.store(row, measure())
        except subprocess.CalledProcessError as error:
            print(f"left out: {row}: {error}", file=sys.stderr)
            return None
    return json.loads(row.read_text())


def signal_of(program, start_of, arm, run):
    start = start_of(arm, run)
    return program.json("signal", start, "--robots", ROBOTS, "--json")["numbers"] if start.exists() else None


def told_of_signal(numbers):
    """Returns what the report tells of the numbers of `evodevo signal`."""
    told = {
        ("repeatability", "one life"): "repeatability of one life",
        ("repeatability", "all lives"): "repeatability of the score",
        ("repeatability", "new draws"): "repeatability with new draws",
        ("heritability", "all children"): "heritability",
    }
    return {
        f"{told[each['quantity'], each['of']]}, {each['population']}": each["value"]
        for each in numbers
        if (each["quantity"], each["of"]) in told and each["scale"] == "rank" and each["value"] is not None
    }


# What is measured of each run alone, on the CPU: its title, of how many runs of each arm (None: of all), how, and what
# the report tells of it.
OF_EACH_RUN = {
    "signal": ("What repeats, and what children inherit", RUNS_OF_SIGNAL, signal_of, told_of_signal),
    "stranger": ("Development of a stranger", None, bodies.with_edits_of_a_stranger, dict),
    "inborn": ("Edits that ancestors had", None, bodies.edits_of_ancestors, dict),
    "diversity": ("Diversity among similar genotypes", RUNS_COMPARED, bodies.diversity, dict),
}
OUTCOMES = ["lives", "moved", *OF_EACH_RUN]


class Study:
    """The runs in the folder of a comparison, and what has been measured of them."""

    def __init__(self, folder, program):
        self.folder, self.out, self.program = folder, folder / "outcomes", program
        self.arms = [Arm(file.parent) for file in sorted(folder.glob("rows/*/made-from.json"))]
        if not self.arms:
            sys.exit(f"{folder}: has no complete runs; give the folder that tools/compare wrote, which holds rows/ and runs/")
        self.of_all = [(arm, run) for arm in self.arms for run in arm.runs]

    def start(self, arm, run):
        return self.folder / "kept" / arm.name / run.name

    def keep(self):
        with concurrent.futures.ThreadPoolExecutor(self.program.jobs) as pool:
            list(pool.map(lambda each: kept.keep(each[1], self.start(*each)), self.of_all))
        for arm, run in self.of_all:
            if not self.start(arm, run).exists():
                print(f"left out: {arm.name}, {run.name}: neither its run nor what was kept of it is there", file=sys.stderr)

    def lives(self):
        lives = {(arm.name, run.name): Lives(self.out, arm, run, self.start(arm, run)) for arm, run in self.of_all}
        self.program.make(self.out, [life for of_run in lives.values() for life in of_run.runs])
        return lives

    def moved(self):
        moved = {
            (arm.name, run.name, scene): Moved(self.out, arm, run, self.start(arm, run), scene)
            for arm in self.arms
            for run in arm.runs[:RUNS_MOVED]
            for scene in SCENES
        }
        self.program.make(self.out, [run for each in moved.values() for run in (each.evolution, each.before)])
        self.program.make(self.out, [each.after for each in moved.values()])
        return moved

    def of_each_run(self, kind):
        """Returns what is told of OF_EACH_RUN[kind], by arm and run."""
        _, count, measure, told = OF_EACH_RUN[kind]
        program = self.program.without_gpus()
        with concurrent.futures.ThreadPoolExecutor(program.jobs) as pool:
            begun = {
                (arm.name, run.name): pool.submit(
                    stored,
                    self.out / "rows" / kind / arm.name / f"{run.name}.json",
                    functools.partial(measure, program, self.start, arm, run),
                )
                for arm in self.arms
                for run in arm.runs[:count]
            }
            return by_arm({key: told(value) for key, future in begun.items() if (value := future.result()) is not None})


def by_arm(numbers):
    """Turns numbers by (arm, run) into numbers by arm and run."""
    grouped = collections.defaultdict(dict)
    for (arm, run), value in numbers.items():
        grouped[arm][run] = value
    return dict(grouped)


def after(quarter):
    return f"after {quarter} of {kept.PARTS}"


def told_of_lives(study, lives):
    """Returns the tables of what the best robots go in lives to come, and of what is left without development."""
    distances, shares = {}, {}
    for (arm, run), ways in lives.items():
        shown = rows.read(next(each for each in study.arms if each.name == arm).row(pathlib.Path(run)))
        if (same := ways.score("same draws")) is None:
            continue
        best = shown["best"]
        if best and not best["verification"]:
            sys.exit(f"{arm}, {run}: its best robot has not been verified; let `evodevo verify` do it, and read its row again")
        record = best["objectives"][shown["objectives"][0]["name"]] if best else 0.0
        new, without = ways.score("new draws"), ways.score("without development")
        left = answers.share(without, same)
        distances[arm, run] = {
            "record": record,
            "same draws": same,
            "new draws": new,
            "without development": without,
            "share of the record": answers.share(same, record, to=None),
            "evaluations": shown["generations"][-1]["evaluations"],
            "generations": len(shown["generations"]),
            "development needed, %": None if left is None else 100 * (left < bodies.ENOUGH),
            "marked, %": 100 * bool(best and MARKS.intersection(best["verification"]["marks"])),
        }
        if without is not None:
            shares[arm, run] = {after(quarter): ways.share_without(quarter) for quarter in range(kept.PARTS + 1)}
    return by_arm(distances), by_arm(shares)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path, help="of the comparison, that is, --out of tools/compare")
    parser.add_argument("--jobs", metavar="N", type=positive, default=1, help="measurements at once (1)")
    parser.add_argument(
        "--only", nargs="+", choices=OUTCOMES, default=OUTCOMES, help="measure nothing but these and the lives"
    )
    parser.add_argument("--repetition", action="store_true", help="answer the questions of a repetition")
    given = parser.parse_args()
    study = Study(given.folder, Program(os.environ.get("EVODEVO_PROGRAM", "evodevo"), given.jobs))
    study.keep()
    distances, shares = told_of_lives(study, study.lives())
    known = {
        "Distance of the best robot in lives to come": distances,
        "Share of the distance that is left without development": shares,
    }
    if "moved" in given.only:
        moved = study.moved()
        for scene in SCENES:
            title = f"Evolution goes on with {scene}" if scene != "slope" else "Evolution goes on on a slope"
            there = {(arm, run): each.numbers() for (arm, run, where), each in moved.items() if where == scene}
            known[title] = by_arm(there)
    for kind in OF_EACH_RUN:
        if kind in given.only:
            known[OF_EACH_RUN[kind][0]] = study.of_each_run(kind)
    study.out.mkdir(exist_ok=True)
    write_csv(known.items(), study.out / "outcomes.csv")
    charts.save(figures.figure(distances, shares), study.out / "lives.svg")
    kind = "repetition" if given.repetition else "study"
    answered = answers.section(distances, shares, after(0), after(kept.PARTS), kind)
    tables = [report(title, of_arms, SHARES) for title, of_arms in known.items()]
    text = "\n".join([answered, answers.beside(distances), *tables])
    (study.out / "report.md").write_text(text)
    print(text)


if __name__ == "__main__":
    main()
