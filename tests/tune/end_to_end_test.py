"""Tests complete races of very short experiments, including interrupted ones."""

import csv
import shlex
import signal
import subprocess
import tomllib
import unittest
import xml.etree.ElementTree

from own_folder import PROGRAM, InOwnFolder, called, stopped
from small_experiment import small_experiment
from tune import command

EXPERIMENT = "# robots of two voxels\n" + small_experiment(evaluations=12, population="4  # individuals")


class Tune(InOwnFolder):
    def setUp(self):
        super().setUp()
        self.experiment = self.folder / "small.toml"
        self.experiment.write_text(EXPERIMENT)

    def words(self, *over, budget=36, out="out", more=()):
        ranges = [word for each in over or ("encoding.edge=0.25..1.0",) for word in ("--over", each)]
        return [self.experiment, *ranges, "--budget", str(budget), "--out", self.folder / out, *more]

    def tuned(self, *over, program=PROGRAM, code=0, **more):
        """Makes a race, and returns what is said of it."""
        done = called(command.main, self.words(*over, **more), program)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done.stderr if code else done.stdout

    def refused(self, *over, **more):
        return self.tuned(*over, code=2, **more)

    def results(self, out="out"):
        with open(self.folder / out / "results.csv", newline="") as stream:
            return list(csv.DictReader(stream))

    def test_a_race_over_a_number_and_an_operator(self):
        over = ["encoding.edge=0.25..1.0:log", "selection.name=elitist,age-fitness-pareto"]
        self.tuned(*over, budget=75, more=["--jobs", "2"])
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

    def test_a_stopped_race_goes_on_and_a_finished_one_is_not_run_again(self):
        self.tuned(out="straight")
        for number in (signal.SIGINT, signal.SIGTERM):
            said = "tune: interrupted; the same command goes on\n"
            self.assertEqual(stopped("tune", self.words(), number, ", seed 2 ("), (130, said))
            self.assertFalse((self.folder / "out" / "report.md").exists())
        self.tuned()
        self.assertEqual(self.results(), self.results("straight"))

        before = {file: file.stat().st_mtime_ns for file in (self.folder / "out").rglob("run.sqlite")}
        self.tuned()
        self.assertEqual({file: file.stat().st_mtime_ns for file in (self.folder / "out").rglob("run.sqlite")}, before)
        self.assertEqual(self.results(), self.results("straight"))

    def test_refused_configurations_are_replaced_and_a_marked_robot_is_no_fitness(self):
        # the program reports that every best robot is an artefact
        mark = """sed 's/"marks": \\[\\]/"marks": ["artefact"]/'"""
        program = self.program(f'[ "$1" != show ] || {{ {shlex.quote(PROGRAM)} "$@" | {mark}; exit; }}')
        said = self.tuned("encoding.name=voxel,nothing-such,direct", program=program)
        self.assertIn('is refused: encoding.name="nothing-such"', said)
        self.assertIn("not accepted by `evodevo check`", (self.folder / "out" / "report.md").read_text())
        self.assertEqual({row["encoding.name"] for row in self.results()}, {'"voxel"', '"direct"'})
        self.assertEqual({row["score"] for row in self.results()}, {""})
        self.assertTrue(all(row["marks"] for row in self.results() if row["encoding.name"] == '"voxel"'))
        self.assertRegex(said, r"\| 1 \| .* \| none \|")

    def test_a_configuration_whose_run_fails_drops_alone(self):
        # relative paths lead elsewhere from the folder of best.toml
        self.experiment.write_text(EXPERIMENT + '[plugins]\npaths = ["mine"]\n')
        (self.folder / "mine").mkdir()
        fails = self.program('case "$*" in run*population=7*) echo no such luck; exit 1;; esac')
        said = self.tuned("experiment.population=4,7,5", program=fails)
        self.assertRegex(said, "configuration [23] drops out, .*seed-1: the run ended with 1:\n  no such luck")
        self.assertEqual({row["experiment.population"] for row in self.results()}, {"4", "5"})
        self.assertRegex(said, f"best.toml is not accepted where it lies; copy it to {self.folder},(.|\n)*mine is n")
        self.assertEqual((self.folder / "out" / "report.md").read_text().count("| failed |"), 1)

    def test_a_race_whose_runs_all_fail_or_of_which_one_is_killed_says_so(self):
        said = self.refused(program=self.program('[ "$1" != run ] || exit 1'))
        self.assertRegex(said, r"^tune: .*small.toml: no configurations to compare are left(.|\n)*the run ended with 1")
        said = self.refused(out="killed", program=self.program('[ "$1" != run ] || kill -9 $$'))
        self.assertIn("the same command goes on from there", said)

    def test_faults_are_found_before_anything_runs(self):
        for over, said in (
            (["encoding.edges=0.25..1.0"], r'(.|\n)*did you mean "edge"\?'),
            (["encoding.edge=0.25..1.0", "encoding.edge=1..2"], "encoding.edge: encoding.edge is given as well; give one"),
            (["encoding.size=[1,1,1],[2,1,1]", "encoding.size.0=1..3"], "encoding.size is given as well"),
            (["development.cycles=1..3"], r"--over development.cycles: the experiment has no table \[development\]; add it"),
            (["selection={name='elitist'},{name='comma'}"], "--over selection: this is a table; give one of its keys"),
            (["fitness.1.window=0.1..0.3"], r"--over fitness.1.window: the experiment has no table \[fitness.1\]; add it"),
        ):
            self.assertRegex(self.refused(*over), f"^tune: .*{said}")
        self.assertRegex(self.refused(budget=35), r"--budget 35: too few runs to tune 1 key; give at least 36")
        self.assertRegex(self.refused(more=["--set", "encoding.edge=0.5"]), "--set encoding.edge: encoding.edge is given as well")
        self.assertIn("evaluations = -3: expected", self.refused(more=["--set", "experiment.evaluations=-3"]))
        self.experiment.write_text("[")
        self.assertRegex(self.refused(), "small.toml: cannot be read")
        self.assertFalse((self.folder / "out").exists())


unittest.main()
