"""Tests the script that measures the outcomes of experiments/study/development, with short runs of small robots."""

import csv
import pathlib
import re
import shutil
import statistics
import subprocess
import sys
import unittest

from compare import command
from own_folder import InOwnFolder, called
from small_experiment import small_experiment

SCRIPT = pathlib.Path(__file__).parents[2] / "experiments" / "study" / "development" / "outcomes.py"


class Outcomes(InOwnFolder):
    def compare(self):
        files = [self.folder / "plain.toml", self.folder / "developing.toml"]
        for file in files:
            file.write_text(small_experiment(development=file.stem == "developing"))
        return called(command.main, [*files, "--seeds", "101..102", "--out", self.folder / "out"])

    def measure(self, *words):
        return subprocess.run([sys.executable, SCRIPT, self.folder / "out", *words], capture_output=True, text=True)

    def test_best_robots_are_measured_in_all_scenes_and_only_once(self):
        self.assertEqual(self.compare().returncode, 0)
        done = self.measure("--jobs", "3")
        self.assertEqual(done.returncode, 0, done.stderr)
        reborn, scenes, slope, bodies, line = re.split(r"(?m)^## .*\n", done.stdout)[1:]
        scenarios = re.findall(r'(?m)^name = "(.*)"', (SCRIPT.parent / "scenarios.txt").read_text())
        self.assertGreater(len(scenarios), 5)
        self.assertIn(f"|  | runs | {' | '.join(scenarios)} |", scenes)
        self.assertIn("after 5 evaluations | after 10 evaluations | after 20 evaluations", slope)
        # nothing is drawn at random without development, and verification lets only robots that develop be born again
        ((in_run, life, kept, elsewhere), (_, _, _, developing)) = self.cells(reborn)
        self.assertAlmostEqual(life, in_run)
        self.assertEqual((kept, elsewhere), (100, None))
        self.assertTrue(0 <= developing <= 100, developing)
        with (self.folder / "out" / "outcomes" / "outcomes.csv").open(newline="") as stream:
            numbers = {(row["arm"], row["run"], row["quantity"]): float(row["value"]) for row in csv.DictReader(stream)}
        of_runs = [numbers["plain", f"seed-{seed}", "in the run"] for seed in (101, 102)]
        self.assertAlmostEqual(statistics.median(of_runs), in_run, delta=0.01 * abs(in_run))
        for text in (scenes, slope):
            plain, developing = self.cells(text)
            self.assertNotEqual(plain, developing)
        (shape, at_birth, matured), (_, _, developed) = self.cells(bodies)
        self.assertGreater(shape, 0)
        self.assertGreater(at_birth, 0)
        self.assertEqual(at_birth, matured)
        self.assertNotEqual(at_birth, developed)
        for began, born in self.cells(line):
            self.assertTrue(0 <= began <= born <= 100, (began, born))
        files = {file: file.stat().st_mtime_ns for file in (self.folder / "out" / "outcomes" / "rows").rglob("*.json")}
        self.assertEqual(len(files), 2 * 2 * (3 + 1 + 1))  # arms, runs; lives in the scenarios, the slope, bodies
        shutil.rmtree(self.folder / "out" / "runs")
        again = self.measure()
        self.assertEqual((again.stdout, again.stderr), (done.stdout, ""))
        self.assertEqual({file: file.stat().st_mtime_ns for file in files}, files)
        for name in ("slope/plain/seed-101", "bodies/plain/seed-101", "scenarios/plain/seed-101-life-2"):
            (self.folder / "out" / "outcomes" / "rows" / f"{name}.json").unlink()
        rest = self.measure()
        self.assertEqual(rest.returncode, 0, rest.stderr)
        self.assertEqual(re.findall(r"(?m)^\| `plain` \| (\d) \|", rest.stdout), ["1", "1", "1", "1", "2"])

    def cells(self, text):
        """Returns the medians in the lines of both arms, or None where there are none."""
        lines = dict(re.findall(r"(?m)^\| `(plain|developing)` \| 2 \| (.*) \|$", text))
        cells = [[cell.split()[0] for cell in lines[arm].split(" | ")] for arm in ("plain", "developing")]
        return [[None if cell == "-" else float(cell) for cell in of_arm] for of_arm in cells]

    def test_a_folder_without_runs_is_refused(self):
        done = self.measure()
        self.assertEqual(done.returncode, 1)
        self.assertIn(f"{self.folder / 'out'}: has no complete runs", done.stderr)


unittest.main()
