"""Tests complete races of very short experiments, including interrupted ones."""

import csv
import os
import pathlib
import shlex
import signal
import subprocess
import sys
import tempfile
import tomllib
import unittest
import xml.etree.ElementTree

from small_experiment import small_experiment

PROGRAM = os.environ["EVODEVO_PROGRAM"]
TUNE = [sys.executable, "-P", "-m", "tune"]

EXPERIMENT = "# robots of two voxels\n" + small_experiment(evaluations=12, population="4  # individuals")


class Tune(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)
        self.experiment = self.folder / "small.toml"
        self.experiment.write_text(EXPERIMENT)

    def command(self, *over, budget=36, out="out", more=()):
        ranges = [word for each in over or ("encoding.edge=0.25..1.0",) for word in ("--over", each)]
        return [*TUNE, self.experiment, *ranges, "--budget", str(budget), "--out", self.folder / out, *more]

    def tune(self, *over, program=PROGRAM, **more):
        environment = os.environ | {"EVODEVO_PROGRAM": str(program)}
        return subprocess.run(self.command(*over, **more), env=environment, capture_output=True, text=True)

    def refused(self, *over, **more):
        done = self.tune(*over, **more)
        self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
        return done.stderr

    def results(self, out="out"):
        with open(self.folder / out / "results.csv", newline="") as stream:
            return list(csv.DictReader(stream))

    def program(self, script):
        """Returns a program that runs a script before it calls evodevo with the same arguments."""
        file = self.folder / "evodevo"
        file.write_text(f'#!/bin/sh\n{script}\nexec {shlex.quote(PROGRAM)} "$@"\n')
        file.chmod(0o755)
        return file

    def test_a_race_over_a_number_and_an_operator(self):
        over = ["encoding.edge=0.25..1.0:log", "selection.name=elitist,age-fitness-pareto"]
        done = self.tune(*over, budget=75, more=["--jobs", "2"])
        self.assertEqual(done.returncode, 0, done.stderr)
        rows = self.results()
        self.assertLessEqual(len(rows), 75)
        self.assertGreater(len(rows), 40)
        self.assertEqual({row["evaluations"] for row in rows}, {"12"})
        self.assertTrue(all(bool(row["marks"]) <= (row["score"] == "") for row in rows))
        own = [row for row in rows if row["configuration"] == "1"]
        self.assertEqual({row["encoding.edge"] for row in own}, {"0.5"})
        self.assertEqual([row["seed"] for row in own[:5]], list("12345"))
        self.assertEqual(len(list((self.folder / "out").rglob("run.sqlite"))), len(rows))

        report = (self.folder / "out" / "report.md").read_text()
        self.assertIn(f"{len(rows)} runs of a budget of 75", report)
        for key in ("encoding.edge", "selection.name"):
            self.assertIn(f"### `{key}`", report)
        self.assertEqual(report.count("| best"), 1)
        xml.etree.ElementTree.parse(self.folder / "out" / "chart.svg")

        best = (self.folder / "out" / "best.toml").read_text()
        self.assertIn("population = 4  # individuals", best)
        values = tomllib.loads(best)
        number = next(line.split("|")[1].strip() for line in report.splitlines() if "| best" in line)
        row = next(row for row in rows if row["configuration"] == number)
        self.assertEqual(values["encoding"]["edge"], float(row["encoding.edge"]))
        self.assertEqual(values["selection"]["name"], row["selection.name"].strip('"'))
        checked = subprocess.run([PROGRAM, "check", self.folder / "out" / "best.toml"], capture_output=True)
        self.assertEqual(checked.returncode, 0, checked.stderr)

    def test_a_stopped_race_goes_on(self):
        self.assertEqual(self.tune(out="straight").returncode, 0)
        for number in (signal.SIGINT, signal.SIGTERM):
            with subprocess.Popen(self.command(), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as stopped:
                while ", seed 2 (" not in stopped.stdout.readline():
                    pass
                stopped.send_signal(number)
                _, said = stopped.communicate()
            self.assertEqual((stopped.returncode, said), (130, "tune: interrupted; the same command goes on\n"))
            self.assertFalse((self.folder / "out" / "report.md").exists())
        done = self.tune()
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.results(), self.results("straight"))

    def test_a_finished_race_is_not_run_again(self):
        self.assertEqual(self.tune().returncode, 0)
        files = list((self.folder / "out").rglob("run.sqlite"))
        before = {file: file.stat().st_mtime_ns for file in files}
        results = self.results()
        self.assertEqual(self.tune().returncode, 0)
        self.assertEqual({file: file.stat().st_mtime_ns for file in (self.folder / "out").rglob("run.sqlite")}, before)
        self.assertEqual(self.results(), results)

    def test_configurations_that_check_refuses_are_told_and_replaced(self):
        done = self.tune("encoding.name=voxel,nothing-such,direct")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn('is refused: encoding.name="nothing-such"', done.stdout)
        self.assertIn("not accepted by `evodevo check`", (self.folder / "out" / "report.md").read_text())
        self.assertEqual({row["encoding.name"] for row in self.results()}, {'"voxel"', '"direct"'})

    def test_a_configuration_whose_run_fails_drops_alone(self):
        # relative paths lead elsewhere from the folder of best.toml
        self.experiment.write_text(EXPERIMENT + '[plugins]\npaths = ["mine"]\n')
        (self.folder / "mine").mkdir()
        fails = self.program('case "$*" in run*population=7*) echo no such luck; exit 1;; esac')
        done = self.tune("experiment.population=4,7,5", program=fails)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, "configuration [23] drops out, .*seed-1: the run ended with 1:\n  no such luck")
        self.assertEqual({row["experiment.population"] for row in self.results()}, {"4", "5"})
        self.assertRegex(done.stdout, f"best.toml is not accepted where it lies; copy it to {self.folder},(.|\n)*mine is n")
        self.assertEqual((self.folder / "out" / "report.md").read_text().count("| failed |"), 1)

    def test_a_race_whose_runs_all_fail_says_so(self):
        said = self.refused(program=self.program('[ "$1" != run ] || exit 1'))
        self.assertRegex(said, r"^tune: .*small.toml: no configurations to compare are left(.|\n)*the run ended with 1")

    def test_a_run_that_is_killed_stops_the_race(self):
        said = self.refused(program=self.program('[ "$1" != run ] || kill -9 $$'))
        self.assertIn("the same command goes on from there", said)

    def test_a_marked_robot_is_no_fitness(self):
        # the program reports that every best robot is an artefact
        mark = """sed 's/"marks": \\[\\]/"marks": ["artefact"]/'"""
        script = f'[ "$1" != show ] || {{ {shlex.quote(PROGRAM)} "$@" | {mark}; exit; }}'
        done = self.tune(program=self.program(script))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual({row["score"] for row in self.results()}, {""})
        self.assertTrue(all(row["marks"] for row in self.results()))
        self.assertRegex(done.stdout, r"\| 1 \| .* \| none \|")

    def test_faults_are_found_before_anything_runs(self):
        for over, said in (
            (["encoding.edges=0.25..1.0"], r'(.|\n)*did you mean "edge"\?'),
            (["encoding.edge=0.25..1.0", "encoding.edge=1..2"], "encoding.edge: encoding.edge is given as well; give one"),
            (["encoding.size=[1,1,1],[2,1,1]", "encoding.size.0=1..3"], "encoding.size is given as well"),
            (["development.cycles=1..3"], r"--over development.cycles: the experiment has no table \[development\]; add it"),
            (["selection={name='elitist'},{name='comma'}"], "--over selection: this is a table; give one of its keys"),
            (["fitness.1.window=0.1..0.3"], r"--over fitness.1.window: the experiment has no table \[fitness.1\]; add it"),
            (["encoding.edge=1.0..0.25"], "--over encoding.edge=1.0..0.25: 1.0 is not below 0.25"),
        ):
            self.assertRegex(self.refused(*over), f"^tune: .*{said}")
        self.assertRegex(self.refused(budget=35), r"--budget 35: too few runs to tune 1 key; give at least 36")
        self.assertRegex(self.refused(more=["--set", "encoding.edge=0.5"]), "--set encoding.edge: encoding.edge is given as well")
        self.assertIn("evaluations = -3: expected", self.refused(more=["--set", "experiment.evaluations=-3"]))
        self.experiment.write_text("[")
        self.assertRegex(self.refused(), "small.toml: cannot be read")
        self.assertFalse((self.folder / "out").exists())


if __name__ == "__main__":
    unittest.main()
