#!/usr/bin/env python3
"""Analyses the champions of the runs in this folder as Kriegman, Cheney & Bongard did in 2018.

  tools/compare experiments/published/kriegman-2018/*.toml --seeds 30 --out runs/kriegman-2018
  export EVODEVO_PROGRAM=build/cpu/bin/evodevo PYTHONPATH=build/cpu/lib/python3.11/site-packages
  python3 experiments/published/kriegman-2018/analyses.py runs/kriegman-2018

Lets the best robot of each run live again, also with its development removed, that is, with the sizes and phases that it
has at birth, in midlife or at death; lets mutants of it live, in each of which one voxel has new random sizes (body) or
new random phases (control); measures by how much sizes and phases change over a life; and counts who rolls. Prints
medians with their intervals, and writes every life to analyses.csv in the folder. tools/compare itself draws medians
over generations and tests the difference at the end.

Needs evodevo's Python package with its compiled module (tools/python/README.md), and SciPy.
"""

import argparse
import csv
import dataclasses
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.append(str(ROOT / "tools/parts"))

try:
    import numpy as np
    import pandas as pd

    import evodevo
    from compare.standings import median_with_interval
    from evodevo import core
except ImportError as error:
    sys.exit(f"analyses: {error}; this needs NumPy, pandas, SciPy and evodevo's Python package with its compiled module, "
             "in PYTHONPATH: see tools/python/README.md")

STEP = 0.05  # s; how often rotations are measured, of which a cycle of development has a whole number
TURN = 2 * np.pi
MOMENTS = {"at birth": 0.0, "in midlife": 0.5, "at death": 1.0}  # progress of development
COLUMNS = ["experiment", "seed", "individual", "life", "distance", "turns", "change_of_sizes", "change_of_phases"]


class Genes:
    """Where a run keeps the sizes and the phases of voxels: for each gene at birth that at the end, which is the same
    if robots do not develop. `run`: an evodevo.Run of one of these experiments; `individual`: whose genes these are."""

    def __init__(self, run, individual):
        self.individual = individual
        table = run.genes(individual)
        self.low, self.high = table["low"].to_numpy(), table["high"].to_numpy()
        self._block = table["block"].to_numpy()
        self._of = {}
        for kind in ("size", "phase"):
            birth = np.flatnonzero(table["gene"] == f"{kind} at birth")
            end = np.flatnonzero(table["gene"] == f"{kind} at the end")
            self._of[kind] = birth, (end if len(end) else birth)

    def at(self, genes, progress):
        """Returns a copy of genes ([genes] float32) whose robot has, from birth to death, the sizes and phases that
        that of `genes` has when this share of its development, 0 to 1, is over."""
        still = genes.copy()
        for birth, end in self._of.values():
            still[birth] = still[end] = genes[birth] + progress * (genes[end] - genes[birth])
        return still

    def change(self, genes, kind):
        """Returns by how much the sizes or phases of a robot change over its life: their mean absolute change, relative
        to the range that genes have. That of random genes is a third; that of robots which have assimilated what
        develops is 0."""
        birth, end = self._of[kind]
        return float(np.mean(np.abs(genes[end] - genes[birth]) / (self.high - self.low)[birth]))

    def mutant(self, genes, kind, random):
        """Returns a copy of genes in which one voxel has new random sizes or phases."""
        changed = genes.copy()
        birth, end = self._of[kind]
        voxel = random.choice(self._block[birth])
        for of in (birth, end):
            mine = of[self._block[of] == voxel]
            changed[mine] = random.uniform(self.low[mine], self.high[mine])
        return changed


@dataclasses.dataclass(frozen=True)
class Life:
    """What a robot did while its way was measured."""

    distance: float  #: along y, body lengths; NaN if the simulation failed
    turns: float  #: about x, the horizontal axis at right angles to the way, full turns


def rotation(before, after):
    """Returns the angle (rad) about x of the rotation that fits best between positions [masses, 3] (Kabsch 1976)."""
    u, _, v = np.linalg.svd((before - before.mean(axis=0)).T @ (after - after.mean(axis=0)))
    turned = v.T @ np.diag([1, 1, np.sign(np.linalg.det(v.T @ u.T))]) @ u.T
    return np.arctan2(turned[2, 1] - turned[1, 2], turned[1, 1] + turned[2, 2])


class Course:
    """A body and its development: lengths go from those of `newborn` to those of `matured`, the same robot as it would
    be if it were born at the end of its development, after each `cycle` (s), and phases go linearly with time. `first`
    and `last`: the times between which they do, s."""

    def __init__(self, newborn, matured, first, last, cycle):
        self._lengths = newborn.rest_lengths, matured.rest_lengths
        self._first, self._last, self._cycle = first, last, cycle
        one = newborn.materials.iloc[newborn.material_of].reset_index(drop=True)
        other = matured.materials.iloc[matured.material_of].reset_index(drop=True)
        rate = (other["phase"] - one["phase"]) / (last - first)
        # a phase that changes linearly is another frequency
        self._developing = one.assign(frequency=one["frequency"] + rate / TURN, phase=one["phase"] - rate * first)
        self.body = dataclasses.replace(newborn, materials=one, material_of=np.arange(len(one)))

    def go_on(self, result):
        """Continues the life of the body from a simulation that ended well. `result`: a core.SimulationResult."""
        changed = self._cycle * np.floor((result.time + STEP / 2) / self._cycle)
        progress = np.clip((changed - self._first) / (self._last - self._first), 0, 1)
        lengths = self._lengths[0] + progress * (self._lengths[1] - self._lengths[0])
        begun = result.time > self._first - STEP / 2
        self.body = dataclasses.replace(
            self.body, positions=result.positions, velocities=result.velocities, time=result.time,
            rest_lengths=lengths, materials=self._developing if begun else self.body.materials)


def live(experiment, genes, genomes):
    """Lets robots live from birth to the end of the window of the first fitness. `experiment`: a core.Experiment;
    `genes`: their Genes; `genomes`: a list of [genes] float32. Returns a Life for each."""
    settings = experiment.settings
    fitness = settings["fitness"][0]
    first, last = fitness["settle"], fitness["settle"] + fitness["window"]
    cycle = settings.get("development", {}).get("cycle_time", STEP)

    def bodies(progress):
        made = []
        for values in genomes:
            made.append(experiment.genome(genes.individual))
            made[-1].genes = genes.at(values, progress)
        return experiment.decode(made)

    courses = [Course(*pair, first, last, cycle) for pair in zip(bodies(0), bodies(1))]
    centres, turns, failed = [[] for _ in courses], np.zeros(len(courses)), set()
    for step in range(round(last / STEP)):
        results = core.simulate([course.body for course in courses], STEP, scene=settings["scene"],
                                simulation=settings["simulation"])
        for i, (course, result) in enumerate(zip(courses, results)):
            if i in failed or result.status != "ok":
                failed.add(i)
                continue
            if step * STEP >= first - STEP / 2:
                turns[i] += rotation(course.body.positions, result.positions) / TURN
            course.go_on(result)
            if (step + 1) * STEP >= first - STEP / 2:
                centres[i].append(np.average(result.positions, axis=0, weights=result.masses)[1])
    return [Life(np.nan, np.nan) if i in failed else Life((y[-1] - y[0]) / fitness["length"], turns[i])
            for i, y in enumerate(centres)]


def lives_of_champion(folder, mutants):
    """Returns a row of COLUMNS for each life that the best robot of a run lives again, in one way or another."""
    run = evodevo.Run(folder)
    champion = int(run.best().index[0])
    experiment, genes = core.Experiment(folder), Genes(run, champion)
    own = run.genome(champion)
    lives = [("as it is", own), *((f"as {moment}", genes.at(own, progress)) for moment, progress in MOMENTS.items())]
    random = np.random.default_rng(int(run.record["seed"]))
    for kind, name in (("size", "body"), ("phase", "control")):
        lives += [(f"{name} mutated", genes.mutant(own, kind, random)) for _ in range(mutants)]
    who = run.record["name"], int(run.record["seed"]), champion
    in_run = run.individuals.loc[champion, run.objective_columns[0]]
    lived = live(experiment, genes, [values for _, values in lives])
    changes = genes.change(own, "size"), genes.change(own, "phase")
    return [(*who, "in the run", in_run, np.nan, *changes),
            *((*who, life, lived[i].distance, lived[i].turns, np.nan, np.nan) for i, (life, _) in enumerate(lives))]


def text(values):
    """Returns the median of values and its interval."""
    return median_with_interval([float(value) for value in values])


def report(table):
    """Prints the medians over champions for each experiment, in which failed lives count as lives without a way.
    `table`: a DataFrame of COLUMNS."""
    table = table.fillna({"distance": 0.0})
    for experiment, rows in table.groupby("experiment", sort=False):
        again = rows[rows["life"] == "as it is"]
        print(f"{experiment}: {len(again)} champions, {(again['turns'].abs() >= 1).sum()} of which roll, that is, turn "
              "over once or more")
        for life, lived in rows.groupby("life", sort=False):
            champions = lived.groupby("seed")["distance"]
            print(f"  {life:16} {text(champions.median())} body lengths")
        for kind in ("sizes", "phases"):
            changes = rows[f"change_of_{kind}"].dropna()
            print(f"  change of {kind} over a life: {text(changes)} of their range; that of random genes is 1/3")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path, help="of the comparison, that is, --out of tools/compare")
    parser.add_argument("--mutants", type=int, default=20, help="of each champion and kind (%(default)s)")
    arguments = parser.parse_args()
    folders = sorted(file.parent for file in arguments.folder.glob("runs/*/seed-*/run.sqlite"))
    if not folders:
        sys.exit(f"{arguments.folder}: has no runs; give the folder that tools/compare wrote, which holds runs/")
    rows = [row for folder in folders for row in lives_of_champion(folder, arguments.mutants)]
    with open(arguments.folder / "analyses.csv", "w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows([COLUMNS, *rows])
    report(pd.DataFrame(rows, columns=COLUMNS))


if __name__ == "__main__":
    main()
