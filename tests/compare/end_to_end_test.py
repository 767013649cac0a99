"""Tests complete comparisons of very short experiments, including interrupted ones."""

import contextlib
import csv
import os
import pathlib
import shlex
import shutil
import signal
import sqlite3
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

from small_experiment import small_experiment

PROGRAM = os.environ["EVODEVO_PROGRAM"]
COMPARE = [sys.executable, "-P", "-m", "compare"]

PLAIN, DEVELOPING = small_experiment(), small_experiment(development=True)


class Comparison(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        """Makes a comparison, of which tests get a copy (finished())."""
        scratch = cls.enterClassContext(tempfile.TemporaryDirectory())
        cls.made = cls()
        cls.made.at(pathlib.Path(scratch))
        done = cls.made.compare()
        cls.made.assertEqual(done.returncode, 0, done.stderr)

    def at(self, folder):
        """Lets commands compare the experiments in a folder."""
        self.folder = folder
        self.plain, self.developing = self.folder / "plain.toml", self.folder / "developing.toml"
        self.plain.write_text(PLAIN)
        self.developing.write_text(DEVELOPING)

    def finished(self, out="out"):
        shutil.copytree(self.made.folder / "out", self.folder / out)

    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.at(pathlib.Path(scratch.name))

    def command(self, *more, out="out"):
        return [*COMPARE, self.plain, self.developing, "--seeds", "2", "--out", self.folder / out, *more]

    def compare(self, *more, out="out"):
        return subprocess.run(self.command(*more, out=out), capture_output=True, text=True)

    def results(self, out="out"):
        """Returns the rows of results.csv without the wall time."""
        with open(self.folder / out / "results.csv", newline="") as stream:
            return [row[:-1] for row in csv.reader(stream)]

    def test_a_comparison_with_a_sweep(self):
        done = self.compare("--sweep", "development.cycle_time=0.05,0.1", "--jobs", "2")
        self.assertEqual(done.returncode, 0, done.stderr)
        report = (self.folder / "out" / "report.md").read_text()
        names = ["plain", "developing,development.cycle_time=0.05", "developing,development.cycle_time=0.1"]
        for name in names:
            self.assertEqual(report.count(f"| `{name}` |"), 3, report)
        self.assertIn("## After 20 evaluations", report)
        self.assertRegex(report, r"\| `plain` \| 8 \| 40 \|.* of 2 \| . of 2 \| . of 2 \|")
        self.assertNotIn("Not all runs", report)
        xml.etree.ElementTree.parse(self.folder / "out" / "chart.svg")
        header, *rows = self.results()
        self.assertEqual(len(rows), len(names) * 2 * 4)  # variants, seeds, generations
        springs = header.index("spring_evaluations")
        cost = {name: sum(int(row[springs]) for row in rows if (row[0], row[2]) == (name, "20")) for name in names}
        # without development, 0.15 s of each life are simulated; with development, two cycles of 0.05 s or 0.1 s are
        # added; bodies have about the same number of springs
        self.assertLess(cost[names[0]], cost[names[1]])
        self.assertLess(cost[names[1]], cost[names[2]])

    def test_what_is_there_is_not_made_again(self):
        self.finished()
        files = list((self.folder / "out").rglob("run.sqlite"))
        self.assertEqual(len(files), 4)
        before = {file: file.stat().st_mtime_ns for file in files}
        self.assertEqual(self.compare("--seeds", "3").returncode, 0)
        self.assertEqual({file: file.stat().st_mtime_ns for file in files}, before)
        self.assertEqual(len(list((self.folder / "out").rglob("run.sqlite"))), 6)

    def test_rows_are_enough_to_go_on(self):
        self.assertEqual(self.compare("--seeds", "3", out="straight").returncode, 0)
        self.finished()
        shutil.rmtree(self.folder / "out" / "runs")
        kept = {file: file.read_bytes() for file in (self.folder / "out" / "rows").rglob("seed-*.json")}
        self.assertEqual(len(kept), 4)
        for row in kept.values():
            self.assertNotIn(os.fsencode(pathlib.Path(PROGRAM).parent), row)  # rows are for other machines, too
        done = self.compare("--seeds", "3")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.results(), self.results("straight"))
        self.assertEqual({file.parent.name for file in (self.folder / "out").rglob("run.sqlite")}, {"seed-3"})
        self.assertEqual({file: file.read_bytes() for file in kept}, kept)

    def test_a_damaged_row_is_named(self):
        self.finished()
        file = self.folder / "out" / "rows" / "plain" / "seed-2.json"
        whole = file.read_text()
        for damaged in (whole[:-37], "[]", whole.replace('"wall_time"', '"time"')):
            file.write_text(damaged)
            refused = self.compare()
            self.assertEqual(refused.returncode, 2, damaged)
            self.assertIn(f"{file}: cannot be read", refused.stderr)
        file.unlink()
        self.assertEqual(self.compare().returncode, 0)
        self.assertEqual(file.read_text(), whole)

    def test_seeds_may_begin_anywhere(self):
        done = self.compare("--seeds", "101..103", "--question", "developing:plain")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual({row[1] for row in self.results()[1:]}, {"101", "102", "103"})
        folders = {folder.name for folder in (self.folder / "out" / "runs" / "plain").iterdir() if folder.is_dir()}
        self.assertEqual(folders, {"seed-101", "seed-102", "seed-103"})
        self.assertIn("3 seeds of each experiment", done.stdout)
        self.assertRegex(done.stdout, r"\| `developing`, beside `plain` \| . of 3 and . of 3 \|")

    def test_killed_runs_go_on(self):
        self.finished(out="straight")
        for seed, lines in ((1, 1), (2, 3)):
            folder = self.folder / "out" / "runs" / "plain" / f"seed-{seed}"
            command = [PROGRAM, "run", self.plain, "--out", folder, "--seed", str(seed)]
            with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as run:
                for _ in range(lines):
                    run.stdout.readline()
                run.kill()
        # a run that was killed before its first transaction
        empty = self.folder / "out" / "runs" / "developing" / "seed-1"
        empty.mkdir(parents=True)
        (empty / "run.sqlite").touch()
        done = self.compare()
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.results(), self.results("straight"))

    def test_runs_killed_before_they_were_verified_are_verified(self):
        self.finished()
        file = self.folder / "out/runs/plain/seed-2/run.sqlite"
        with contextlib.closing(sqlite3.connect(file)) as run, run:
            run.execute("DELETE FROM verifications")
        (self.folder / "out/rows/plain/seed-2.json").unlink()
        others = [other for other in (self.folder / "out").rglob("run.sqlite") if other != file]
        before = {other: other.stat().st_mtime_ns for other in others}
        done = self.compare()
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, r"\| `plain` \| 8 \| 40 \|.* of 2 \| . of 2 \| . of 2 \|")
        self.assertEqual({other: other.stat().st_mtime_ns for other in others}, before)

    def test_what_is_not_to_be_verified_is_finished_without(self):
        self.assertEqual(self.compare("--set", "experiment.verify=0").returncode, 0)
        files = list((self.folder / "out").rglob("run.sqlite"))
        before = {file: file.stat().st_mtime_ns for file in files}
        again = self.compare("--set", "experiment.verify=0", "--against", "developing")
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertEqual({file: file.stat().st_mtime_ns for file in files}, before)
        self.assertIn("the others tested against `developing`", again.stdout)
        self.assertIn("not verified", again.stdout)

    def test_a_stopped_comparison_goes_on(self):
        self.finished(out="straight")
        for number in (signal.SIGINT, signal.SIGTERM):
            with subprocess.Popen(self.command(), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as stopped:
                stopped.stdout.readline()
                stopped.send_signal(number)
                _, said = stopped.communicate()
            self.assertEqual((stopped.returncode, said), (130, "compare: interrupted; the same command goes on\n"))
            self.assertFalse((self.folder / "out" / "report.md").exists())
        done = self.compare()
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.results(), self.results("straight"))

    def test_equal_cost(self):
        self.finished("all")
        header, *rows = self.results("all")
        column = header.index("spring_evaluations")
        budget = min(int(row[column]) for row in rows if row[2] == "10")
        done = self.compare("--set", f"experiment.spring_evaluations={budget}")
        self.assertEqual(done.returncode, 0, done.stderr)
        _, *rows = self.results()
        last = {(row[0], row[1]): int(row[column]) for row in rows}
        before = {(row[0], row[1]): int(row[column]) for row in rows if int(row[column]) < budget}
        self.assertEqual(len(last), 4)
        self.assertGreaterEqual(min(last.values()), budget)
        self.assertLess(max(before.values()), budget)
        self.assertLess(len(rows), 16)

    def test_the_best_are_compared_in_scenarios(self):
        self.plain.write_text(PLAIN + '\n[[scenario]]\nname = "flat"\n')
        uphill = '[[scenario]]\nname = "uphill"\nrepeat = 2\n[scenario.gravity]\nslope = -5\n'
        self.developing.write_text(DEVELOPING + uphill + '[[scenario]]\nname = "flat"\n')
        done = self.compare("--sweep", "fitness.0.over=worst,flat")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(done.stdout.count("| flat |"), 1)
        self.assertNotIn("| uphill |", done.stdout)
        self.assertRegex(done.stdout, 'Not compared: "uphill"')
        xml.etree.ElementTree.parse(self.folder / "out" / "scenarios.svg")
        with open(self.folder / "out" / "scenarios.csv", newline="") as stream:
            rows = list(csv.DictReader(stream))
        self.assertEqual(len(rows), 2 * 2 * (1 + 2))  # values, seeds, scenarios of both experiments
        _, *generations = self.results()
        best = {(row[0], row[1]): float(row[4]) for row in generations}  # of the last generation
        for row in rows:
            if "over=flat" in row["experiment"] and row["scenario"] == "flat":
                self.assertEqual(float(row["score"]), best[row["experiment"], row["seed"]])

    def test_maps_of_niches_are_compared(self):
        described = '\n[[fitness]]\nname = "descriptor"\nrange = [0, 1]\nsettle = 0.05\nwindow = 0.1\n'
        self.plain.write_text(PLAIN + described)
        self.developing.write_text(DEVELOPING + described)
        done = self.compare()
        self.assertEqual(done.returncode, 0, done.stderr)
        section = done.stdout.split("## Coverage and QD score after 20 evaluations")[1].split("\n## ")[0]
        for name in ("plain", "developing"):
            self.assertEqual(section.count(f"| `{name}` |"), 2, section)
        xml.etree.ElementTree.parse(self.folder / "out" / "map.svg")
        header, *rows = self.results()
        column = header.index("coverage")
        for name, seed in {(row[0], row[1]) for row in rows}:
            coverage = [float(row[column]) for row in rows if (row[0], row[1]) == (name, seed)]
            self.assertEqual(coverage, sorted(coverage))  # a cell that is filled stays so
            self.assertGreater(coverage[-1], 0)
            self.assertLessEqual(coverage[-1], 1)

    def test_experiments_are_added_without_a_folder_named(self):
        # --set affects only the second experiment, which has that table; the run of the first one exists already
        for more in ([], [self.developing, "--set", "development.cycles=1"]):
            command = [*COMPARE, self.plain, *more, "--seeds", "1"]
            done = subprocess.run(command, cwd=self.folder, capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
        out = self.folder / "runs" / "compare-plain"
        self.assertEqual({folder.name for folder in (out / "runs").iterdir()}, {"plain", "developing"})
        self.assertIn("| `developing` |", (out / "report.md").read_text())

    def test_runs_of_another_build_are_named(self):
        self.finished()
        with contextlib.closing(sqlite3.connect(self.folder / "out/runs/plain/seed-2/run.sqlite")) as run, run:
            run.execute("UPDATE operators SET hash = 'another' WHERE kind = 'fitness'")
        # a run that another build of the program began and this one resumed
        with contextlib.closing(sqlite3.connect(self.folder / "out/runs/plain/seed-1/run.sqlite")) as run, run:
            run.execute("INSERT INTO provenances SELECT 1, device, evodevo, 'another' FROM provenances")
            run.execute("INSERT INTO operators SELECT 1, kind, name, version, file, hash FROM operators")
            run.execute("UPDATE individuals SET provenance = 1 WHERE born = 0")
        shutil.rmtree(self.folder / "out" / "rows" / "plain")
        done = self.compare()
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("**Not all runs were made by the same builds", done.stdout)
        self.assertEqual(done.stdout.count("  - 0.1.0 (another): 1 of `plain`\n"), 2)  # program, fitness operator
        self.assertRegex(done.stdout, r"- evodevo:\n  - 0.1.0 \([0-9a-f]{16}\): 2 of `plain`, 2 of `developing`\n")

    def test_runs_of_something_else_are_refused(self):
        self.finished()
        refused = self.compare("--set", "experiment.population=4")
        self.assertEqual(refused.returncode, 2)
        self.assertRegex(refused.stderr, "plain: its runs were made from another plain.toml or with another --set")
        self.plain.write_text(PLAIN.replace("population = 5", "population = 6"))
        self.assertEqual(self.compare().returncode, 2)
        for kind in ("rows", "runs"):
            shutil.rmtree(self.folder / "out" / kind / "plain")
        self.assertEqual(self.compare().returncode, 0)

    def test_islands_are_refused_and_nothing_is_lost(self):
        settings = "islands={count=2, topology='ring', every=1, migrants=1, emigrants='best', replaced='worst'}"
        run = self.folder / "out" / "runs" / "plain" / "seed-1" / "island-1" / "run.sqlite"
        run.parent.mkdir(parents=True)
        run.touch()
        refused = self.compare("--set", settings)
        self.assertEqual((refused.returncode, refused.stderr.count("\n")), (2, 1), refused.stderr)
        self.assertIn("--set islands=", refused.stderr)
        self.plain.write_text(f"{PLAIN}\n[islands]\ncount = 2\n")
        refused = self.compare()
        self.assertEqual((refused.returncode, refused.stderr.count("\n")), (2, 1), refused.stderr)
        self.assertIn(f"{self.plain}: islands: ", refused.stderr)
        self.assertTrue(run.exists())

    def test_files_that_cannot_be_read_are_named(self):
        self.finished()
        made_from = self.folder / "out" / "rows" / "plain" / "made-from.json"
        database = self.folder / "out" / "runs" / "plain" / "seed-1" / "run.sqlite"
        (self.folder / "out" / "rows" / "plain" / "seed-1.json").unlink()
        other = self.folder / "a file"
        for file, text, out in ((database, "no database", "out"), (made_from, "{", "out"), (other, "", "a file")):
            file.write_text(text)
            refused = self.compare(out=out)
            self.assertEqual((refused.returncode, refused.stderr.count("\n")), (2, 1), refused.stderr)
            self.assertRegex(refused.stderr, rf"\Acompare: {file}")

    def test_faults_are_found_before_anything_runs(self):
        refused = self.compare("--sweep", "development.cycle_times=1,2")
        self.assertEqual(refused.returncode, 2)
        self.assertIn('did you mean "cycle_time"?', refused.stderr)
        self.assertFalse((self.folder / "out").exists())
        refused = self.compare("--against", "evolving")
        self.assertEqual(refused.returncode, 2)
        self.assertRegex(refused.stderr, r"\Acompare: --against evolving: .*plain, developing\n\Z")
        self.assertFalse((self.folder / "out").exists())
        for pair in ("plain", "plain:plain", "plain:developing:plain", "plain:grown"):
            refused = self.compare("--question", pair)
            self.assertEqual(refused.returncode, 2)
            self.assertIn(f"compare: --question {pair}: ", refused.stderr)
        for seeds in ("0", "-1", "two", "1.5", "5..3", "..7", "3..", "1...4"):
            refused = self.compare(f"--seeds={seeds}")
            self.assertEqual(refused.returncode, 2)
            self.assertIn(f"--seeds: {seeds}: expected a whole number of at least 1", refused.stderr)

    def test_different_objectives_are_not_compared(self):
        self.developing.write_text(DEVELOPING.replace('"distance"', '"actuation-work"'))
        refused = self.compare()
        self.assertEqual(refused.returncode, 2)
        self.assertIn("differ in their first objective: ", refused.stderr)

    def program(self, name, line):
        """Returns a program that does something before it does what evodevo does."""
        program = self.folder / name
        program.write_text(f'#!/bin/sh\n{line}\nexec {shlex.quote(PROGRAM)} "$@"\n')
        program.chmod(0o755)
        return program

    def compare_with(self, program):
        environment = os.environ | {"EVODEVO_PROGRAM": str(program)}
        return subprocess.run(self.command(), env=environment, capture_output=True, text=True)

    def test_a_run_that_fails_once_is_tried_again(self):
        # the first run of all finds no device
        marker = shlex.quote(str(self.folder / "failed"))
        done = self.compare_with(self.program("fails", f'[ "$1" = run ] && mkdir {marker} 2>/dev/null && echo busy && exit 1'))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, "tried once more: .*seed-1: the run ended with 1:\n  busy")

    def test_a_run_that_fails_twice_stops_the_comparison(self):
        # a file with the name of the run's folder
        folder = self.folder / "out" / "runs" / "plain"
        folder.mkdir(parents=True)
        (folder / "seed-1").write_text("in the way")
        refused = self.compare()
        self.assertEqual(refused.returncode, 2)
        self.assertIn("seed-1", refused.stderr)
        self.assertIn("mend that and give the same command again", refused.stderr)

    def test_a_run_that_is_killed_stops_the_comparison(self):
        refused = self.compare_with(self.program("killed", '[ "$1" != run ] || kill -9 $$'))
        self.assertEqual(refused.returncode, 2)
        self.assertIn("ended with -9", refused.stderr)
        self.assertIn("the same command goes on from there", refused.stderr)


if __name__ == "__main__":
    unittest.main()
