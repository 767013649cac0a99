"""Tests that experiments are drawn at random from all operators, that a program that breaks a law is found out, and that
what shows it is made small."""

import collections
import os
import pathlib
import random
import shlex
import tempfile
import tomllib
import unittest

import tomlkit

from campaign.experiments import Experiments, listed_operators
from campaign.laws import Broken, Laws
from campaign.random_experiment import Draw, without
from small_experiment import small_experiment

PROGRAM = os.environ["EVODEVO_PROGRAM"]
# long enough to be interrupted after its first generation
EXPERIMENT = small_experiment(development=True).replace("evaluations = 20", "evaluations = 400")


class Draws(unittest.TestCase):
    def test_follow_from_their_number_and_name_every_operator(self):
        operators = listed_operators(PROGRAM)
        named = collections.Counter()

        def count(node):
            for value in node.values() if isinstance(node, dict) else node if isinstance(node, list) else ():
                count(value)
            if isinstance(node, dict) and isinstance(node.get("name"), str):
                named[node["name"]] += 1

        for number in range(300):
            tables = Draw(operators, random.Random(number)).experiment()
            self.assertEqual(Draw(operators, random.Random(number)).experiment(), tables)
            self.assertEqual(tomllib.loads(tomlkit.dumps(tables)), tables)
            count(tables)
        missing = {each["name"] for each in operators} - set(named)
        self.assertEqual(missing, {"cloud"})  # which needs a file

    def test_variants_lack_one_thing(self):
        tables = {"a": {"b": 1, "c": [2, 3]}, "d": [{"e": 4}, {"f": 5}]}
        self.assertCountEqual(
            without(tables),
            [
                {"d": [{"e": 4}, {"f": 5}]},
                {"a": {"b": 1, "c": [2, 3]}},
                {"a": {"c": [2, 3]}, "d": [{"e": 4}, {"f": 5}]},
                {"a": {"b": 1}, "d": [{"e": 4}, {"f": 5}]},
                {"a": {"b": 1, "c": [2, 3]}, "d": [{"f": 5}]},
                {"a": {"b": 1, "c": [2, 3]}, "d": [{}, {"f": 5}]},
                {"a": {"b": 1, "c": [2, 3]}, "d": [{"e": 4}]},
                {"a": {"b": 1, "c": [2, 3]}, "d": [{"e": 4}, {}]},
            ],
        )


class Programs(unittest.TestCase):
    """Programs that break one law each."""

    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)
        self.file = self.folder / "experiment.toml"
        self.file.write_text(EXPERIMENT)

    def program(self, lines):
        """Returns a program. `lines`: what it does before it does what evodevo does."""
        program = self.folder / "program"
        program.write_text(f"#!/bin/sh\n{lines}\nexec {shlex.quote(PROGRAM)} \"$@\"\n")
        program.chmod(0o755)
        return program

    def laws(self, program, **limits):
        return Laws(program, self.folder / "runs", **limits)

    def broken(self, lines, **limits):
        """Returns the law that such a program breaks."""
        with self.assertRaises(Broken) as caught:
            self.laws(self.program(lines), **limits).hold(self.file)
        return str(caught.exception)

    def test_a_sound_program_holds_all(self):
        self.assertTrue(self.laws(PROGRAM).hold(self.file))

    def test_what_is_refused_with_its_place_is_no_fault(self):
        self.file.write_text(EXPERIMENT.replace('"voxel"', '"voxels"'))
        self.assertFalse(self.laws(PROGRAM).hold(self.file))

    def test_a_refusal_without_a_place_is_one(self):
        self.assertRegex(self.broken("[ $1 != check ] || { echo no >&2; exit 2; }"), "^check: exit code 2: no")

    def test_crashes(self):
        self.assertRegex(self.broken("[ $1 != check ] || kill -SEGV $$"), "^check: exit code -11")
        self.assertRegex(self.broken("[ $1 != run ] || exit 7"), "^run: exit code 7")

    def test_commands_that_do_not_end(self):
        self.assertRegex(self.broken("[ $1 != check ] || exec sleep 1000", seconds=1), "^check: not done after 1 s")
        deaf = self.program("trap '' INT; echo generation 0; exec sleep 1000")
        with self.assertRaisesRegex(Broken, "^run, interrupted: not done after 1 s"):
            self.laws(deaf, seconds=1).run_in_parts(self.file, self.folder / "parts")

    def test_what_cannot_be_shown(self):
        self.assertRegex(self.broken("[ $1 != show ] || exit 7"), "^show: exit code 7")

    def test_results_that_depend_on_threads(self):
        fault = 'case "$*" in *"--threads 3"*) set -- "$@" --seed 99 ;; esac'
        self.assertRegex(self.broken(fault), "^with 3 threads instead of 1: .* differs: ")

    def test_runs_that_are_not_resumed(self):
        self.assertRegex(self.broken("[ $1 != resume ] || exit 0"), "^with an interruption: .* differs: ")

    def test_scores_that_are_not_repeated(self):
        other = r's/("trial": "again".*"value": )[^,]*/\17/; /"trial": "again"/,/"value"/ s/("value": )[^,]*/\17/'
        fault = f"[ $1 != show ] || {{ {shlex.quote(PROGRAM)} \"$@\" | sed -E '{other}'; exit; }}"
        self.assertRegex(self.broken(fault), "^verification: again 7")


class Shrinking(unittest.TestCase):
    class NothingRests:
        """Laws that every experiment breaks whose bodies return to rest."""

        def hold(self, file):
            tables = tomllib.loads(file.read_text())
            if tables.get("development", {}).get("reset"):
                raise Broken("rest: not reached")
            return "scenario" not in tables

    def test_only_what_breaks_the_law_is_left(self):
        with tempfile.TemporaryDirectory() as scratch:
            folder = pathlib.Path(scratch)
            part = Experiments(listed_operators(PROGRAM), self.NothingRests(), folder)
            outcomes = []
            while not any(each.found for each in outcomes):
                outcomes += part.sitting(1e-9, outcomes)  # one experiment
            fault = outcomes[-2].found[0]
            file, _, law = fault.partition(": ")
            self.assertEqual(law, "rest: not reached")
            self.assertEqual(tomllib.loads(pathlib.Path(file).read_text()), {"development": {"reset": True}})
            self.assertEqual([each.name for each in (folder / "found").iterdir()], [pathlib.Path(file).name])
            self.assertEqual(sum(each.tried for each in outcomes), len(outcomes) / 2)


if __name__ == "__main__":
    unittest.main()
