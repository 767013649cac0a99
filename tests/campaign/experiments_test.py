"""Tests that experiments are drawn at random from all operators, that a program that breaks a law is found out, and that
what shows it is made small."""

import collections
import itertools
import os
import pathlib
import random
import re
import shlex
import threading
import tomllib
import unittest
import unittest.mock

import tomlkit

from campaign import command
from campaign.amounts import different
from campaign.bodies import AT_ONCE
from campaign.calls import Broken
from campaign.experiments import BATCH, Experiments, kind, listed_operators
from campaign.laws import Laws
from campaign.outcomes import Outcome
from campaign.random_experiment import Draw, without
from own_folder import PROGRAM, InOwnFolder
from small_experiment import small_experiment

# long enough to be interrupted after its first generation
EXPERIMENT = small_experiment(development=True).replace("evaluations = 20", "evaluations = 400")


class Draws(unittest.TestCase):
    def test_follow_from_their_number_and_name_every_operator(self):
        operators, named = listed_operators(PROGRAM), set()
        for number in range(300):
            tables = Draw(operators, random.Random(number)).experiment()
            self.assertEqual(Draw(operators, random.Random(number)).experiment(), tables)
            text = tomlkit.dumps(tables)
            self.assertEqual(tomllib.loads(text), tables)
            named.update(re.findall(r'\bname = "(.*?)"', text))
        self.assertEqual({each["name"] for each in operators} - named, {"cloud"})  # which needs a file
        self.assertEqual(Draw(operators, random.Random(7), "cuda").experiment()["simulation"]["device"], "cuda")

    def test_variants_lack_one_thing(self):
        a, d = {"b": 1, "c": [2, 3]}, [{"e": 4}, {"f": 5}]
        without_a_part = [{"a": {"c": [2, 3]}, "d": d}, {"a": {"b": 1}, "d": d}]
        without_a_part += [{"a": a, "d": some} for some in ([{"f": 5}], [{}, {"f": 5}], [{"e": 4}], [{"e": 4}, {}])]
        self.assertCountEqual(without({"a": a, "d": d}), [{"d": d}, {"a": a}, *without_a_part])


class Programs(InOwnFolder):
    """Programs that break one law each."""

    def setUp(self):
        super().setUp()
        self.file = self.folder / "experiment.toml"
        self.file.write_text(EXPERIMENT)

    def laws(self, program, **limits):
        return Laws(program, self.folder / "runs", built=pathlib.Path(PROGRAM).parent.parent, **limits)

    def broken(self, lines, **limits):
        """Returns the law that such a program breaks."""
        with self.assertRaises(Broken) as caught:
            self.laws(self.program(lines), **limits).hold(self.file)
        return str(caught.exception)

    def test_a_sound_program_holds_all_and_a_table_of_defaults_may_be_left_out(self):
        self.assertTrue(self.laws(PROGRAM).hold(self.file))
        tables = tomllib.loads(EXPERIMENT)
        del tables["simulation"]
        self.file.write_text(tomlkit.dumps(tables))
        self.assertTrue(self.laws(PROGRAM).hold(self.file))

    def held_together(self, lines):
        """Returns which of four experiments a program accepts, of which the second must be refused. `lines` as above."""
        files = [self.folder / f"experiment-{i}.toml" for i in range(4)]
        for file in files:
            file.write_text(EXPERIMENT)
        files[1].write_text(EXPERIMENT.replace('"voxel"', '"voxels"'))
        return self.laws(self.program(lines)).hold_together(files)

    def test_a_sound_program_holds_all_together(self):
        self.assertEqual(self.held_together(""), [True, False, True, True])

    def test_faults_in_what_is_made_together(self):
        in_runs, last = "[ $1 != run-many ] || sed -i -E '{}' \"$2\"", "/experiment-3/"
        smaller = '/random-places/ s/]$/, "--set", "encoding.size=[1,1,1]"]/'
        for lines, law in (
            ("[ $1 != run-many ] || ! grep -q /one $2 || exit 7", "^run, 2 runs in one process: exit code 7"),
            (f"[ $1:${{2##*{last}}} != show:one ] || exit 7", "^show: exit code 7"),
            (in_runs.format('s/"--threads", "3"/&, "--seed", "99"/'), "^with 3 threads instead of 1: .* differs: "),
            (in_runs.format(smaller), "^random-places: born with .*8.*, not .*12"),
            (in_runs.format('/"--resume"/ s|/parts"|/elsewhere"|'), "^there is no .*/parts/run.sqlite"),
            (in_runs.format('/"--resume"/ s/]$/, "--seed", "99"]/'), "^with an interruption: .* differs: "),
            (
                f"case $* in simulate*{last}*=float*) set -- \"$@\" --set scene.gravity.acceleration=15 ;; esac",
                "^precision: float on cpu differs",
            ),
        ):
            with self.subTest(law), self.assertRaisesRegex(Broken, law):
                self.held_together(lines)

    def test_what_is_refused_with_its_place_is_no_fault(self):
        self.file.write_text(EXPERIMENT.replace('"voxel"', '"voxels"'))
        self.assertFalse(self.laws(PROGRAM).hold(self.file))

    def test_each_law(self):
        other = r's/("trial": "again".*"value": )[^,]*/\17/; /"trial": "again"/,/"value"/ s/("value": )[^,]*/\17/'
        evodevo = f'{shlex.quote(PROGRAM)} "$@"'
        for lines, law in (
            ("[ $1 != check ] || { echo no >&2; exit 2; }", "^check: exit code 2: no"),  # a refusal without a place
            ("[ $1 != check ] || kill -SEGV $$", "^check: exit code -11"),
            ("[ $1 != run ] || exit 7", "^run: exit code 7"),
            (
                'case "$1" in run-many) sed -i \'s/"--threads", "2"/&, "--seed", "99"/\' "$2" ;; esac',
                "^beside another run: .* differs: ",
            ),
            (
                'case "$*" in *"--threads 3"*) set -- "$@" --seed 99 ;; esac',
                "^with 3 threads instead of 1: .* differs: ",
            ),
            ("[ $1 != resume ] || exit 0", "^with an interruption: .* differs: "),
            (f"[ $1 != show ] || {{ {evodevo} | sed -E '{other}'; exit; }}", "^verification: again 7"),
            (
                f"case $1:$2 in life:*/random-places) {evodevo} | sed '0,/\"gone\"/s//\"come\"/'; exit ;; esac",
                "^random-places: spring come 3 instead of 2",
            ),
            (
                'case "$*" in simulate*=float*) set -- "$@" --set scene.gravity.acceleration=15 ;; esac',
                "^precision: float on cpu differs from double on cpu by [0-9.e+]+ .* after 20 steps",
            ),
        ):
            with self.subTest(law):
                self.assertRegex(self.broken(lines), law)

    def test_commands_that_do_not_end(self):
        self.assertRegex(self.broken("[ $1 != check ] || exec sleep 1000", seconds=1), "^check: not done after 1 s")
        for deaf_or_silent in ("trap '' INT; echo generation 0; exec sleep 1000", "exec sleep 1000"):
            with self.assertRaisesRegex(Broken, "^run, interrupted: not done after 1 s"):
                self.laws(self.program(deaf_or_silent), seconds=1).run_in_parts(self.file, self.folder / "parts")

    def test_results_that_depend_on_ranks(self):
        self.needs("3 ranks")
        fault = '[ "$OMPI_COMM_WORLD_SIZE" != 3 ] || set -- "$@" --seed 99'
        self.assertRegex(self.broken(fault), "^with 3 ranks instead of 1: .* differs: ")

    def needs(self, law):
        if law in self.laws(PROGRAM).left_out:
            self.skipTest(f"{law}: {self.laws(PROGRAM).left_out[law]}")

    def test_pages_with_errors(self):
        self.needs("pages")
        self.file.write_text(small_experiment())
        self.assertTrue(self.laws(PROGRAM).page_holds(self.file))
        broken = r"s/<\/script>/<\/script><script>broken(<\/script>/"
        reported = f"{shlex.quote(PROGRAM)} \"$@\" && sed -i '{broken}' \"$4\""
        with self.assertRaisesRegex(Broken, "^page: "):
            self.laws(self.program(f"[ $1 != report ] || {{ {reported}; exit; }}")).page_holds(self.file)

    def test_laws_that_need_what_is_not_there_are_left_out_by_name(self):
        with unittest.mock.patch.dict(os.environ, PATH="/nowhere"):
            self.assertRegex(" ".join(sorted(self.laws(PROGRAM).left_out.items())[0]), "^3 ranks there is no mpirun")
            self.assertIn("Node.js", self.laws(PROGRAM).left_out["pages"])
        self.assertEqual(set(Laws(PROGRAM, self.folder / "runs", built=self.folder).left_out), {"3 ranks", "pages"})


class Amounts(unittest.TestCase):
    def test_must_be_equal_where_nothing_can_make_them_differ(self):
        large, small = {"masses": 60, "springs": 300}, {"masses": 12, "springs": 50}
        turnover = {"spring gone": 2, "spring come": 2, "spring changed": 1}
        masses = {"mass gone": 3, "mass come": 3, "spring gone": 20, "spring come": 24}
        for expected, given, born, wrong in (
            (turnover, turnover, large, ""),
            (turnover, turnover | {"spring gone": 1}, large, "spring gone 1 instead of 2"),
            (turnover, turnover | {"spring changed": 2}, large, "spring changed 2 instead of 1"),
            (turnover, turnover | {"spring come": 1}, large, "spring come 1 instead of 2"),
            (turnover, turnover | {"spring come": 1}, small, ""),  # there may be no other pair
            (turnover, turnover | {"spring come": 3}, small, "spring come 3 instead of 2"),
            (masses, masses | {"spring gone": 25}, large, ""),  # those of other masses
            (masses, masses | {"mass gone": 2}, large, "mass gone 2 instead of 3"),
            (masses, masses | {"mass come": 4}, large, "mass come 4 instead of 3"),
        ):
            self.assertEqual(different(*map(collections.Counter, (expected, given)), born), wrong)


class Shrinking(InOwnFolder):
    def test_faults_of_the_same_kind_are_told_from_others(self):
        crash, hang = "run: exit code -11: ", "run: not done after 60 s"
        same = "with 3 threads instead of 1: scores differs: (0, 1)", "with 3 threads instead of 1: notes differs: 7"
        self.assertEqual(kind(same[0]), kind(same[1]))
        self.assertEqual(kind(crash), kind("run: exit code -11: no memory"))
        others = crash, hang, "run: exit code 1: no", "show: exit code 1: no", same[0]
        self.assertEqual(len(set(map(kind, others))), len(others))

    def until_found(self):
        """Returns the outcomes of sittings of one experiment each, until one breaks the law; and the fault."""
        part, outcomes = Experiments(listed_operators(PROGRAM), [self.NothingRests()], self.folder), []
        while not any(each.found for each in outcomes):
            outcomes += part.sitting(1e-9, outcomes)
        return outcomes, outcomes[-2].found[0]

    def test_shrinking_ends_in_time(self):
        with unittest.mock.patch("campaign.experiments.SHRINKING", 0):
            _, fault = self.until_found()
        self.assertGreater(len(tomllib.loads(pathlib.Path(fault.partition(": ")[0]).read_text())), 1)

    class NothingRests:
        """Laws that every experiment breaks whose bodies return to rest."""

        left_out = {}

        def hold(self, file):
            tables = tomllib.loads(file.read_text())
            if tables.get("development", {}).get("reset"):
                raise Broken("rest: not reached")
            return "scenario" not in tables

    def test_only_what_breaks_the_law_is_left(self):
        outcomes, fault = self.until_found()
        file, _, law = fault.partition(": ")
        self.assertEqual(law, "rest: not reached")
        self.assertEqual(tomllib.loads(pathlib.Path(file).read_text()), {"development": {"reset": True}})
        self.assertEqual(self.found(), [pathlib.Path(file).name])
        self.assertEqual(sum(each.tried for each in outcomes), len(outcomes) / 2)

    def found(self):
        """Returns the names of the files that are kept since they show a fault."""
        return [each.name for each in (self.folder / "found").iterdir()]

    def test_what_is_not_shown_again_is_found_nevertheless(self):
        laws = unittest.mock.Mock(left_out={})
        laws.hold.side_effect = [Broken("rest: not reached"), *[True] * 1000]
        outcomes = list(Experiments(listed_operators(PROGRAM), [laws], self.folder).sitting(1e-9, ()))
        self.assertRegex(outcomes[0].found[0], "experiment-0.toml: rest: not reached; not ")

    class BrokenTogether:
        """Laws that only the experiments with some numbers break, and all when they are tried together."""

        left_out = {"pages": "there is no browser"}

        def __init__(self, numbers=()):
            self._names = {f"experiment-{number}.toml" for number in numbers}

        def hold_together(self, files):
            raise Broken("scores: nan is not finite")

        def hold(self, file):
            if file.name in self._names:
                raise Broken("rest: not reached")
            return True

    def on_gpu(self, laws):
        """Returns the first outcomes of a sitting on a GPU, of which no experiment is made smaller: what was accepted, and
        what was refused."""
        part = Experiments(listed_operators(PROGRAM), [laws], self.folder, "cuda")
        with unittest.mock.patch("campaign.experiments.without", lambda tables: ()):
            return [*itertools.islice(part.sitting(1e-9, ()), 1, 3)]

    def test_what_is_broken_together_is_looked_for_alone(self):
        runs, refused = self.on_gpu(self.BrokenTogether([7]))
        self.assertEqual((runs.tried, refused.tried), (BATCH, 0))
        self.assertRegex(" ".join(runs.found), "^[^ ]*experiment-7.toml: rest: not reached$")
        self.assertEqual(self.found(), ["experiment-7.toml"])

    def test_what_is_only_broken_together_is_kept(self):
        runs, _ = self.on_gpu(self.BrokenTogether())
        self.assertRegex(" ".join(runs.found), "experiment-0.toml .*experiment-19.toml: together: scores: nan")
        self.assertEqual(len(self.found()), BATCH)

    def test_on_a_gpu_a_batch_is_tried_together(self):
        laws = unittest.mock.Mock(left_out={"pages": "there is no browser"})
        laws.hold_together.side_effect = lambda files: [i % 4 > 0 for i, _ in enumerate(files)]
        runs, refused = self.on_gpu(laws)
        self.assertEqual(self.found(), [])
        self.assertEqual((runs.tried, refused.tried, runs.found + refused.found), (BATCH * 3 // 4, BATCH // 4, ()))
        laws.hold.assert_not_called()

    class WaitsForAnother:
        """A law that holds once two experiments are tried at the same time, each with laws of its own."""

        left_out = {"pages": "there is no browser"}

        def __init__(self, barrier):
            self._barrier, self._alone = barrier, threading.Lock()

        def hold(self, file):
            if not self._alone.acquire(blocking=False):
                raise Broken("laws: two experiments at once")
            self._barrier.wait(timeout=60)
            self._alone.release()
            return True

    def test_as_many_are_tried_at_once_as_there_are_laws(self):
        barrier = threading.Barrier(2)
        laws = [self.WaitsForAnother(barrier) for _ in range(2)]
        part = Experiments(listed_operators(PROGRAM), laws, self.folder)
        outcomes = list(itertools.islice(part.sitting(1e9, ()), 3))
        self.assertEqual([(each.case, each.tried) for each in outcomes[1:]], [("runs", BATCH), ("refused by check", 0)])
        self.assertEqual([fault for each in outcomes for fault in each.found], [])

    def test_a_gpu_serves_few_at_once(self):
        counts = []
        for cores, device in itertools.product((1, AT_ONCE, 8 * AT_ONCE), ("cpu", "cuda")):
            with unittest.mock.patch("os.cpu_count", return_value=cores), unittest.mock.patch("campaign.command.Laws"):
                counts.append(len(command.laws(PROGRAM, pathlib.Path(), device)))
        self.assertEqual(counts, [1, 1, AT_ONCE // 2, AT_ONCE // 2, 4 * AT_ONCE, AT_ONCE])

    class NoPageOpens:
        """Laws of which the last is broken, and one is left out."""

        left_out = {"3 ranks": "there is no mpirun"}

        def __init__(self):
            self.tried, self.opened = 0, []

        def hold(self, file):
            self.tried += 1
            return self.tried % 3 == 0

        def page_holds(self, file):
            self.opened.append(file.name)
            if file.name == f"experiment-{100 + BATCH + 1}.toml":
                raise Broken("page: does not open")
            return len(self.opened) == 2

    def test_a_page_of_each_batch_is_opened_and_what_is_left_out_is_named(self):
        with unittest.mock.patch("campaign.experiments.without", lambda tables: ()):
            part = Experiments(listed_operators(PROGRAM), [self.NoPageOpens()], self.folder)
            past = [Outcome("experiments", case, tried, (), 1) for case, tried in (("runs", 100), ("pages", 5))]
            outcomes = list(itertools.islice(part.sitting(1e9, past), 7))
        cases = [(each.case, each.tried, len(each.found)) for each in outcomes]
        self.assertEqual(cases[0], ("3 ranks: left out, since there is no mpirun", 0, 0))
        self.assertEqual(cases[1:4], [("runs", 6, 0), ("refused by check", 14, 0), ("pages", 1, 0)])
        self.assertEqual(cases[4:], [("runs", 7, 0), ("refused by check", 13, 0), ("pages", 1, 1)])
        self.assertIn(f"experiment-{100 + BATCH + 1}.toml: page: does not open", outcomes[-1].found[0])


unittest.main()
