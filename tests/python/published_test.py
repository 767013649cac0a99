"""Tests the analyses of experiments/published: the lives that they let robots live again are those of the runs, and runs
are compared at equal numbers of generations."""

import contextlib
import importlib.util
import io
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np
from package import ROOT, evodevo

if importlib.util.find_spec("evodevo.core") is None:
    print("skipped: the module evodevo.core is not built for this Python; apt-get install pybind11-dev python3-dev, "
          "and configure again")
    sys.exit(77)

FOLDER = ROOT / "experiments/published/kriegman-2018"


def script(name):
    spec = importlib.util.spec_from_file_location(name, FOLDER / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


analyses, progress = script("analyses"), script("progress")

SHORT = ["experiment.evaluations=24", "experiment.population=8", "fitness.0.settle=0.5", "fitness.0.window=0.75"]
SHORT_DEVELOPMENT = ["development.cycles=5"]


def make_run(name, folder, *more):
    """Makes a short run of an experiment in folder/runs, as tools/compare does, and returns its folder. `more`: settings
    of this run alone."""
    out = Path(folder, "runs", name, "seed-1")
    out.parent.mkdir(parents=True, exist_ok=True)
    settings = [*SHORT, *(SHORT_DEVELOPMENT if name == "evo-devo" else []), *more]
    evodevo("run", FOLDER / f"{name}.toml", "--out", out, "--device", "cpu", "--no-report", "--quiet",
            *(word for setting in settings for word in ("--set", setting)))
    return out


class Rotations(unittest.TestCase):
    def test_are_about_the_axis_at_right_angles_to_the_way(self):
        cloud = np.random.default_rng(1).normal(size=(30, 3))
        for angle in (0.3, -1.2):
            c, s = np.cos(angle), np.sin(angle)
            turned = cloud @ np.array([[1, 0, 0], [0, c, -s], [0, s, c]]).T + [0.2, 3, 1]
            self.assertAlmostEqual(analyses.rotation(cloud, turned), angle)
        self.assertAlmostEqual(analyses.rotation(cloud, cloud @ np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]]).T), 0)


class Lives(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        scratch = cls.enterClassContext(tempfile.TemporaryDirectory())
        cls.runs = {name: make_run(name, scratch) for name in ("evo", "evo-devo")}
        cls.run_ = analyses.evodevo.Run(cls.runs["evo-devo"])

    def test_are_those_of_the_runs(self):
        for name, run in self.runs.items():
            with self.subTest(name):
                rows = analyses.lives_of_champion(run, 2)
                lives = {life: distance for _, _, _, life, distance, *_ in rows}
                # in steps of the same length, but with the length of a spring rounded in another way
                self.assertAlmostEqual(lives["as it is"], lives["in the run"], places=4)
                self.assertGreater(lives["in the run"], 0.01)
                frozen = [lives[f"as {moment}"] for moment in analyses.MOMENTS]
                if name == "evo":
                    self.assertEqual(frozen, 3 * [lives["as it is"]])
                else:
                    self.assertEqual(len({lives["as it is"], *frozen}), 4)
                self.assertEqual(len(rows), 1 + 1 + 3 + 2 * 2)

    def test_change_as_their_genes_say(self):
        run = self.run_
        genes, own, table = analyses.Genes(run, 3), run.genome(3), run.genes(3)
        random = [genes.change(run.genome(i), kind) for i in run.individuals.index for kind in ("size", "phase")]
        self.assertAlmostEqual(np.mean(random), 1 / 3, delta=0.03)
        for kind, range_of_genes in (("size", 1.5), ("phase", 2.0)):
            at_birth, at_the_end = (table[table["gene"] == f"{kind} {when}"]["value"].to_numpy()
                                    for when in ("at birth", "at the end"))
            expected = np.mean(np.abs(at_the_end - at_birth)) / range_of_genes
            self.assertAlmostEqual(genes.change(own, kind), expected, places=5)
            self.assertEqual(genes.change(genes.at(own, 0.5), kind), 0)

    def test_mutants_differ_in_one_voxel(self):
        table, own = self.run_.genes(3), self.run_.genome(3)
        for kind in ("size", "phase"):
            mutant = analyses.Genes(self.run_, 3).mutant(own, kind, np.random.default_rng(2))
            changed = table[mutant != own]
            self.assertEqual(set(changed["gene"]), {f"{kind} at birth", f"{kind} at the end"})
            self.assertEqual(changed["block"].nunique(), 1)


class Progress(unittest.TestCase):
    def test_compares_runs_after_equal_numbers_of_generations(self):
        with tempfile.TemporaryDirectory() as scratch:
            best = {}
            small, large = ["experiment.population=4", "experiment.children=4"], ["experiment.children=8"]
            for name, more in (("evo", small), ("evo-devo", large)):
                best[name] = progress.evodevo.Run(make_run(name, scratch, *more)).generations["best"].to_list()
            self.assertEqual([*map(len, best.values())], [6, 3])
            text = io.StringIO()
            with contextlib.redirect_stdout(text):
                progress.report(progress.histories_of(Path(scratch)))
        medians = (progress.standings.number(max(of_arm[:3])) for of_arm in best.values())
        self.assertIn(f"| 3 | {' | '.join(medians)} |", text.getvalue())
        self.assertIn("evo: 1 runs of 6 to 6 generations, 0 robots failed, 24 lives", text.getvalue())


unittest.main()
