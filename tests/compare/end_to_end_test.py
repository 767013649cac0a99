"""Tests complete comparisons of very short experiments, including interrupted ones."""

import contextlib
import csv
import itertools
import json
import os
import pathlib
import re
import shlex
import shutil
import signal
import sqlite3
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

from compare import command
from own_folder import PROGRAM, InOwnFolder, called, stopped
from small_experiment import small_experiment

COMPARE = [sys.executable, "-P", "-m", "compare"]

PLAIN, DEVELOPING = small_experiment(), small_experiment(development=True)

# tables of an archive that are empty before its first generation
OF_GENERATIONS = "individuals scores life_scores tests lives generations immigrants emigrants verifications signal".split()


class Comparison(InOwnFolder):
    @classmethod
    def setUpClass(cls):
        """Makes a comparison, of which tests get a copy (finished())."""
        cls.made = cls()
        cls.made.at(pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory())))
        cls.made.compared()

    def at(self, folder):
        """Lets commands compare the experiments in a folder."""
        self.folder = folder
        self.plain, self.developing = self.folder / "plain.toml", self.folder / "developing.toml"
        self.plain.write_text(PLAIN)
        self.developing.write_text(DEVELOPING)

    def finished(self, out="out"):
        shutil.copytree(self.made.folder / "out", self.folder / out)

    def setUp(self):
        super().setUp()
        self.at(self.folder)

    def words(self, *more, out="out"):
        return [self.plain, self.developing, "--seeds", "2", "--out", self.folder / out, *more]

    def compare(self, *more, out="out", program=PROGRAM):
        return called(command.main, self.words(*more, out=out), program)

    def compared(self, *more, **others):
        """Makes a comparison that has no fault, and returns its report."""
        done = self.compare(*more, **others)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def refused(self, *more, **others):
        """Returns what is said of a comparison that is refused."""
        done = self.compare(*more, **others)
        self.assertEqual(done.returncode, 2, done.stderr)
        return done.stderr

    def results(self, out="out"):
        """Returns the rows of results.csv without the wall time."""
        with open(self.folder / out / "results.csv", newline="") as stream:
            return [row[:-1] for row in csv.reader(stream)]

    def runs(self, out="out"):
        """Returns the times at which the files of all runs were last written."""
        return {file: file.stat().st_mtime_ns for file in (self.folder / out).rglob("run.sqlite")}

    @contextlib.contextmanager
    def changed(self, run):
        """Opens the file of a run, to change it."""
        with contextlib.closing(sqlite3.connect(self.folder / "out/runs" / run / "run.sqlite")) as file, file:
            yield file

    def test_a_comparison_with_a_sweep(self):
        self.compared("--sweep", "development.cycle_time=0.05,0.1", "--jobs", "2")
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

    def test_runs_are_measured_beside_random_search(self):
        words = ("--random", "--signal", "16", "--jobs", "2", "--set", "experiment.population=10")
        report = self.compared(*words)
        rows = report.split("## What repeats")[1].split("\n## ")[0]
        names = ["plain", "plain,random", "developing", "developing,random"]
        for name in names:
            self.assertRegex(rows, rf"\| `{name}` \|( [^|]+ \|){{10}}\n")
        for name in ("plain,random", "developing,random"):
            made_by = self.read(name, 1, "SELECT DISTINCT made_by FROM individuals")
            self.assertEqual(made_by, [("random",)])
        before = self.runs()
        shutil.rmtree(self.folder / "out" / "runs" / "plain")  # its rows have what was measured
        self.assertEqual(self.compared(*words).split("## ")[1:], report.split("## ")[1:])
        self.assertEqual(self.runs().items() & before.items(), self.runs().items())
        self.assertIn("plain/seed-1", self.refused_without_numbers(words))

    def read(self, name, seed, query):
        with contextlib.closing(sqlite3.connect(self.folder / "out/runs" / name / f"seed-{seed}" / "run.sqlite")) as file:
            return file.execute(query).fetchall()

    def refused_without_numbers(self, words):
        """Returns what is said if the row of a run that is gone has no numbers."""
        row = self.folder / "out" / "rows" / "plain" / "seed-1.json"
        row.write_text(json.dumps(json.loads(row.read_text()) | {"robots": 0}))
        return self.refused(*words)

    def test_what_is_there_is_not_made_again(self):
        self.finished("straight")
        before = self.runs("straight")
        self.assertEqual(len(before), 4)
        self.compared("--seeds", "3", out="straight")
        self.assertEqual(self.runs("straight") | before, self.runs("straight"))
        self.assertEqual(len(self.runs("straight")), 6)

        self.finished()
        shutil.rmtree(self.folder / "out" / "runs")  # rows are enough to go on
        kept = {file: file.read_bytes() for file in (self.folder / "out" / "rows").rglob("seed-*.json")}
        self.assertEqual(len(kept), 4)
        for row in kept.values():
            self.assertNotIn(os.fsencode(pathlib.Path(PROGRAM).parent), row)  # rows are for other machines, too
        self.compared("--seeds", "3")
        self.assertEqual(self.results(), self.results("straight"))
        self.assertEqual({file.parent.name for file in self.runs()}, {"seed-3"})
        self.assertEqual({file: file.read_bytes() for file in kept}, kept)

    def test_a_damaged_row_is_named(self):
        self.finished()
        file = self.folder / "out" / "rows" / "plain" / "seed-2.json"
        whole = file.read_text()
        for damaged in (whole[:-37], "[]", whole.replace('"wall_time"', '"time"')):
            file.write_text(damaged)
            self.assertIn(f"{file}: cannot be read", self.refused(), damaged)
        file.unlink()
        self.compared()
        self.assertEqual(file.read_text(), whole)

    def test_seeds_may_begin_anywhere(self):
        said = self.compared("--seeds", "101..103", "--question", "developing:plain")
        self.assertEqual({row[1] for row in self.results()[1:]}, {"101", "102", "103"})
        folders = {folder.name for folder in (self.folder / "out" / "runs" / "plain").iterdir() if folder.is_dir()}
        self.assertEqual(folders, {"seed-101", "seed-102", "seed-103"})
        self.assertIn("3 seeds of each experiment", said)
        self.assertRegex(said, r"\| `developing`, beside `plain` \| . of 3 and . of 3 \|")

    def test_killed_runs_go_on(self):
        # one was killed before it was verified, two amid their generations, and one before its first transaction
        run = "out/runs/plain/seed-2"
        shutil.copytree(self.made.folder / run, self.folder / run)
        with self.changed("plain/seed-2") as file:
            file.execute("DELETE FROM verifications")
        for experiment, seed, lines in ((self.plain, 1, 1), (self.developing, 2, 3)):
            folder = self.folder / "out" / "runs" / experiment.stem / f"seed-{seed}"
            command = [PROGRAM, "run", experiment, "--out", folder, "--seed", str(seed)]
            with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as killed:
                for _ in range(lines):
                    killed.stdout.readline()
                killed.kill()
        empty = self.folder / "out" / "runs" / "developing" / "seed-1"
        empty.mkdir(parents=True)
        (empty / "run.sqlite").touch()
        self.assertRegex(self.compared(), r"\| `plain` \| 8 \| 40 \|.* of 2 \| . of 2 \| . of 2 \|")
        self.assertEqual(self.results(), self.made.results())

    def test_what_is_not_to_be_verified_is_finished_without(self):
        self.compared("--set", "experiment.verify=0")
        before = self.runs()
        again = self.compared("--set", "experiment.verify=0", "--against", "developing")
        self.assertEqual(self.runs(), before)
        self.assertIn("the others tested against `developing`", again)
        self.assertIn("not verified", again)

    def test_a_stopped_comparison_goes_on(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            said = "compare: interrupted; the same command goes on\n"
            self.assertEqual(stopped("compare", self.words(), number), (130, said))
            self.assertFalse((self.folder / "out" / "report.md").exists())
        self.compared()
        self.assertEqual(self.results(), self.made.results())

    def test_the_best_are_compared_in_scenarios(self):
        self.plain.write_text(PLAIN + '\n[[scenario]]\nname = "flat"\n')
        uphill = '[[scenario]]\nname = "uphill"\nrepeat = 2\nstart_noise = 0.01\n[scenario.gravity]\nslope = -5\n'
        self.developing.write_text(DEVELOPING + uphill + '[[scenario]]\nname = "flat"\n')
        said = self.compared("--sweep", "fitness.0.over=worst,flat")
        self.assertEqual(said.count("| flat |"), 1)
        self.assertNotIn("| uphill |", said)
        self.assertRegex(said, 'Not compared: "uphill"')
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
        section = self.compared().split("## Coverage and QD score after 20 evaluations")[1].split("\n## ")[0]
        for name in ("plain", "developing"):
            self.assertEqual(section.count(f"| `{name}` |"), 2, section)
        xml.etree.ElementTree.parse(self.folder / "out" / "map.svg")
        header, *rows = self.results()
        for row in rows:
            self.assertTrue(0 < float(row[header.index("coverage")]) <= 1, row)

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
        with self.changed("plain/seed-2") as file:
            file.execute("UPDATE operators SET hash = 'another' WHERE kind = 'fitness'")
        # a run that another build of the program began and this one resumed
        with self.changed("plain/seed-1") as file:
            file.execute("INSERT INTO provenances SELECT 1, device, evodevo, 'another' FROM provenances")
            file.execute("INSERT INTO operators SELECT 1, kind, name, version, file, hash FROM operators")
            file.execute("UPDATE individuals SET provenance = 1 WHERE born = 0")
        shutil.rmtree(self.folder / "out" / "rows" / "plain")
        said = self.compared()
        self.assertIn("**Not all runs were made by the same builds", said)
        self.assertEqual(said.count("  - 0.1.0 (another): 1 of `plain`\n"), 2)  # program, fitness operator
        self.assertRegex(said, r"- evodevo:\n  - 0.1.0 \([0-9a-f]{16}\): 2 of `plain`, 2 of `developing`\n")

    def test_runs_of_something_else_are_refused(self):
        self.finished()
        said = "plain: its runs were made from another plain.toml or with another --set"
        self.assertRegex(self.refused("--set", "experiment.population=4"), said)
        self.plain.write_text(PLAIN.replace("population = 5", "population = 6"))
        self.assertRegex(self.refused(), said)
        for kind in ("rows", "runs"):
            shutil.rmtree(self.folder / "out" / kind / "plain")
        self.compared()

    def test_a_run_with_islands_counts_as_one(self):
        self.plain.write_text(PLAIN.replace("evaluations = 20", "evaluations = 31") + "\n[islands]\ncount = 2\nevery = 1\n")
        runs = self.folder / "out" / "runs" / "plain"
        words = ("--random", "--signal", "16", "--against", "developing,random")
        report = self.compared(*words)
        standings = report.split("## What repeats")[1].split("\n## ")[0]
        self.assertEqual(re.findall(r"^\| `(.*?)`", standings, re.M), ["plain", "developing", "developing,random"])
        for seed in (1, 2):
            row = json.loads((self.folder / "out" / "rows" / "plain" / f"seed-{seed}.json").read_text())
            islands = self.shown_islands(runs / f"seed-{seed}")
            objective = row["objectives"][0]["name"]
            bests = [island["best"]["objectives"][objective] for island in islands]
            self.assertEqual(row["best"]["objectives"][objective], max(bests))
            self.assertIsNotNone(row["best"]["verification"])
            self.assertEqual(row["signal"], islands[bests.index(max(bests))]["signal"]["numbers"])
            generations = [island["generations"] for island in islands]
            self.assertEqual(sorted(map(len, generations)), [3, 4])  # 15 and 16 evaluations
            self.assertEqual(row["generations"]["evaluations"], [10, 20, 30, 31])
            self.assertEqual(
                sum(row["generations"]["spring_evaluations"]),
                sum(each["spring_evaluations"] for each in itertools.chain.from_iterable(generations)),
            )
            self.assertEqual(
                row["generations"]["best"],
                [max(each["best"] for each in there if each) for there in itertools.zip_longest(*generations)],
            )

        # without rows, complete runs are read again, and one that was killed between its islands goes on
        shutil.rmtree(self.folder / "out" / "rows")
        shutil.rmtree(runs / "seed-1" / "island-2")
        with self.changed("plain/seed-1/island-1") as island:
            for table in OF_GENERATIONS:
                island.execute(f"DELETE FROM {table}")
        self.assertEqual(self.compared(*words).split("## ")[1:4], report.split("## ")[1:4])

    def shown_islands(self, run):
        said = subprocess.run([PROGRAM, "show", run, "--json"], check=True, capture_output=True, text=True).stdout
        return json.loads(said)["islands"]

    def test_files_that_cannot_be_read_are_named(self):
        self.finished()
        made_from = self.folder / "out" / "rows" / "plain" / "made-from.json"
        database = self.folder / "out" / "runs" / "plain" / "seed-1" / "run.sqlite"
        (self.folder / "out" / "rows" / "plain" / "seed-1.json").unlink()
        other = self.folder / "a file"
        for file, text, out in ((database, "no database", "out"), (made_from, "{", "out"), (other, "", "a file")):
            file.write_text(text)
            self.assertRegex(self.refused(out=out), rf"\Acompare: {file}.*\n\Z")

    def test_faults_are_found_before_anything_runs(self):
        for said, *words in (
            ('did you mean "cycle_time"\\?', "--sweep", "development.cycle_times=1,2"),
            (r"\Acompare: --against evolving: .*plain, developing\n\Z", "--against", "evolving"),
            ("compare: --question plain:grown: ", "--question", "plain:grown"),
            *(
                (f"--seeds: {seeds}: expected a whole number of at least 1", f"--seeds={seeds}")
                for seeds in ("0", "-1", "two", "1.5", "5..3", "..7", "3..", "1...4")
            ),
        ):
            self.assertRegex(self.refused(*words), said)
            self.assertFalse((self.folder / "out").exists())

    def test_different_objectives_are_not_compared(self):
        self.developing.write_text(DEVELOPING.replace('"distance"', '"actuation-work"'))
        self.assertIn("differ in their first objective: ", self.refused())

    def test_a_run_that_fails_once_is_tried_again(self):
        # the first run of all finds no device
        marker = shlex.quote(str(self.folder / "failed"))
        program = self.program(f'[ "$1" = run ] && mkdir {marker} 2>/dev/null && echo busy && exit 1')
        self.assertRegex(self.compared(program=program), "tried once more: .*seed-1: the run ended with 1:\n  busy")

    def test_a_run_that_fails_twice_or_is_killed_stops_the_comparison(self):
        # a file with the name of the run's folder
        folder = self.folder / "out" / "runs" / "plain"
        folder.mkdir(parents=True)
        (folder / "seed-1").write_text("in the way")
        said = self.refused()
        self.assertIn("seed-1", said)
        self.assertIn("mend that and give the same command again", said)
        said = self.refused(out="killed", program=self.program('[ "$1" != run ] || kill -9 $$'))
        self.assertRegex(said, "ended with -9(.|\n)*the same command goes on from there")


if __name__ == "__main__":
    unittest.main()
