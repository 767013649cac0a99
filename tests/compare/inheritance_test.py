"""Tests the scripts that measure the outcomes of experiments/study/inheritance, with short runs of small robots."""

import collections
import csv
import json
import math
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

STUDY = pathlib.Path(__file__).parents[2] / "experiments" / "study" / "inheritance"
sys.path.append(str(STUDY))

import answers  # noqa: E402
import bodies  # noqa: E402

SCENARIO = '\n[[scenario]]\nname = "flat"\nstart_noise = 0.001\n'


class Outcomes(InOwnFolder):
    def compare(self):
        files = [self.folder / f"{name}.toml" for name in ("evo", "individual", "stress")]
        for file in files:
            text = small_experiment(development=file.stem != "evo", population=6, evaluations=24) + SCENARIO
            if file.stem == "individual":
                text = text.replace("[development]", '[development]\ndraws = "individual"')
            file.write_text(text.replace("evaluations = 24", "evaluations = 24\nbirth_noise = 0.001\nlives = 2"))
        return called(command.main, [*files, "--seeds", "301..302", "--out", self.folder / "out"])

    def measure(self, *words):
        return subprocess.run(
            [sys.executable, STUDY / "outcomes.py", self.folder / "out", *words], capture_output=True, text=True
        )

    def test_questions_are_answered_from_lives_that_selection_has_not_seen(self):
        self.assertEqual(self.compare().returncode, 0)
        done = self.measure("--jobs", "3")
        self.assertEqual(done.returncode, 0, done.stderr)
        with (self.folder / "out" / "outcomes" / "outcomes.csv").open(newline="") as stream:
            told = {tuple(row[:4]): float(row[4]) for row in list(csv.reader(stream))[1:]}
        lives = {key[:2] + key[3:]: value for key, value in told.items() if key[2].startswith("Distance of the best")}
        for arm in ("evo", "individual", "stress"):
            for seed in ("seed-301", "seed-302"):
                file = self.folder / "out" / "outcomes" / "rows" / "lives" / arm / seed / "same-draws.json"
                distances = [life["distance"] for life in json.loads(file.read_text())["best"]["lives"]]
                self.assertEqual(len(distances), 12)
                self.assertAlmostEqual(lives[arm, seed, "same draws"], statistics.fmean(distances[3:]))
                record = json.loads((self.folder / "out" / "rows" / arm / f"{seed}.json").read_text())["best"]
                self.assertAlmostEqual(lives[arm, seed, "record"], record["objectives"]["distance"])
                if arm != "individual":  # whose draws no other individual has
                    seen = [life["distance"] for life in record["lives"]]
                    self.assertEqual(distances[:2], seen)
                self.assertEqual((arm, seed, "new draws") in lives, arm != "evo")
        self.assertIn("`individual` has 2", done.stdout)  # of the 50 runs that the plan asks for
        self.assertIn("`random-places` has 0", done.stdout)
        titles = set(re.findall(r"(?m)^## (.*)$", done.stdout))
        for title in ("Evolution goes on on a slope", "Development of a stranger", "Edits that ancestors had"):
            self.assertIn(title, titles)
        chart = (self.folder / "out" / "outcomes" / "lives.svg").read_text()
        for arm in ("evo", "individual", "stress"):
            self.assertIn(f">{arm}<", chart)
        of_signal = collections.Counter(key[3] for key in told if key[3].endswith(", random"))
        self.assertEqual(
            of_signal,
            {
                "repeatability of one life, random": 6,
                "repeatability of the score, random": 6,
                "repeatability with new draws, random": 4,  # of those that develop
                "heritability, random": 6,
            },
        )
        for key, value in told.items():
            self.assertTrue(math.isfinite(value), key)
            if key[2] in ("Edits that ancestors had",) and key[3] != "ancestors":
                self.assertTrue(0 <= value <= 1, (key, value))
        # what has been measured is not measured again, even if the runs are gone
        files = {file: file.stat().st_mtime_ns for file in (self.folder / "out" / "outcomes" / "rows").rglob("*.json")}
        shutil.rmtree(self.folder / "out" / "runs")
        again = self.measure()
        self.assertEqual((again.stdout, again.returncode), (done.stdout, 0), again.stderr)
        self.assertEqual({file: file.stat().st_mtime_ns for file in files}, files)
        some = set(re.findall(r"(?m)^## (.*)$", self.measure("--only", "inborn").stdout))
        self.assertIn("Edits that ancestors had", some)
        self.assertNotIn("Development of a stranger", some)

    def test_a_folder_without_runs_is_refused(self):
        done = self.measure()
        self.assertEqual(done.returncode, 1)
        self.assertIn(f"{self.folder / 'out'}: has no complete runs", done.stderr)


def runs(*distances, marked=()):
    return {
        f"seed-{i}": {"same draws": distance, "marked, %": 100 * (i in marked)} for i, distance in enumerate(distances)
    }


ARMS = ("individual", "stress-one-life", "evo", "random-places", "shuffled-stress")


class Answers(unittest.TestCase):
    LOW, HIGH = [1 + i / 100 for i in range(20)], [2 + i / 100 for i in range(20)]

    def answer(self, stress, evo):
        arms = {arm: stress for arm in ARMS} | {"stress": stress, "evo": evo}
        text = answers.section(arms, {}, "first", "last", "repetition")
        self.assertNotIn(answers.LEARNT[0], text)
        (line,) = [line for line in text.splitlines() if line.startswith("| Do robots that develop")]
        return line.split(" | ")[-1].removesuffix(" |")

    def test_each_arm_is_told_beside_random_search(self):
        new = {name: run | {"new draws": run["same draws"] - 2} for name, run in runs(*self.HIGH).items()}
        others = {name: run | {"new draws": None} for name, run in runs(*self.LOW).items()}
        text = answers.beside({"random-search": others, "stress": new})
        (line,) = [line for line in text.splitlines() if line.startswith("| `stress`")]
        same, other = (cell.split(" ")[0] for cell in line.split(" | ")[1:])
        self.assertEqual((same, other), ("1.00", "0.00"))

    def test_a_difference_is_told_with_its_direction(self):
        self.assertEqual(self.answer(runs(*self.HIGH), runs(*self.LOW)), "yes: more")
        self.assertEqual(self.answer(runs(*self.LOW), runs(*self.HIGH)), "yes: less")
        self.assertEqual(self.answer(runs(*self.LOW), runs(*self.LOW)), "open")

    def test_a_difference_that_marked_runs_reverse_is_open(self):
        self.assertEqual(self.answer(runs(*self.HIGH, marked=range(13)), runs(*self.LOW)), "open")

    def test_nothing_is_answered_before_all_runs_are_there(self):
        arms = {arm: runs(*self.LOW) for arm in (*ARMS, "stress")} | {"evo": runs(*self.LOW[:19])}
        text = answers.section(arms, {}, "first", "last", "repetition")
        self.assertIn("`evo` has 19.", text)
        compared = [line for line in text.splitlines() if line.endswith(" | - |")]
        self.assertEqual(len(compared), len(answers.QUESTIONS))
        self.assertNotIn("|", answers.section(arms | {"evo": {}}, {}, "first", "last", "repetition"))

    def test_shares_of_too_little_are_not_told(self):
        self.assertIsNone(answers.share(0.1, 0.4))
        self.assertIsNone(answers.share(None, 2.0))
        self.assertEqual(answers.share(1.0, 2.0), 0.5)
        self.assertEqual(answers.share(3.0, 2.0), 1.0)
        self.assertEqual(answers.share(-1.0, 2.0), 0.0)

    def test_what_became_inborn_is_told_by_the_sign_of_the_change(self):
        def said(change, marked=()):
            arms = {arm: runs(*range(50), marked=marked) for arm in (*ARMS, "stress")}
            shares = {f"seed-{i}": {"first": 0.3, "last": 0.3 + change(i)} for i in range(50)}
            return answers.section(arms, {"stress": shares}, "first", "last").rsplit(": ", 1)[1].strip()

        self.assertEqual(said(lambda i: 0.3 + i / 1000), "yes.")
        self.assertEqual(said(lambda i: 0.3 + i / 1000, marked=range(40)), "open.")
        self.assertEqual(said(lambda i: -0.2 - i / 1000), "less.")
        self.assertEqual(said(lambda i: 0 if i < 30 else 0.3 + i / 1000), "yes.")  # although the median is 0
        self.assertEqual(said(lambda i: (-1) ** i * (0.01 + i / 10000)), "no.")
        self.assertEqual(said(lambda i: (-1) ** i * (0.3 + i / 10000)), "open.")


class Bodies(unittest.TestCase):
    BODY = {
        "masses": [{"position": [float(i), 0.0, 0.0]} for i in range(4)],
        "materials": [{"name": "bone"}],
        "springs": [{"a": 0, "b": 1, "rest_length": 1.0, "material": 0}, {"a": 1, "b": 2, "rest_length": 1.0, "material": 0}],
    }

    def test_edits_of_a_stranger_are_made_as_far_as_the_body_has_the_masses(self):
        soft = {"stiffness": 10.0, "amplitude": 0.0, "frequency": 0.0, "phase": 0.0, "damping": 0.0}
        edits = [
            {"event": "gone", "spring": [1, 0]},
            {"event": "gone", "spring": [0, 3]},  # it has none
            {"event": "come", "spring": [3, 1], "rest_length": 7.0, "material": soft},
            {"event": "come", "spring": [2, 1], "rest_length": 7.0, "material": soft},  # it has one
            {"event": "come", "spring": [0, 4], "rest_length": 7.0, "material": soft},  # there is no such mass
        ]
        body = bodies.edited(self.BODY, edits)
        springs = {(spring["a"], spring["b"]): spring for spring in body["springs"]}
        self.assertEqual(set(springs), {(1, 2), (3, 1)})
        self.assertEqual(springs[3, 1]["rest_length"], 2.0)  # as long as the places of its masses are apart
        self.assertEqual(body["materials"][springs[3, 1]["material"]]["stiffness"], 10.0)
        self.assertEqual(len(self.BODY["springs"]), 2)

    def test_a_body_has_an_edit_if_its_springs_are_as_after_it(self):
        edits = {(1, "come", frozenset((0, 1))), (1, "gone", frozenset((0, 2))), (2, "come", frozenset((2, 3)))}
        self.assertAlmostEqual(bodies.had(edits, {frozenset((0, 1)), frozenset((1, 2))}), 2 / 3)


unittest.main()
