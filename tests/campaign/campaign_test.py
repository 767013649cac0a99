"""Tests campaigns with parts and targets that stand in for real ones."""

import contextlib
import io
import unittest
import unittest.mock

from campaign import arguments
from campaign.command import campaign, chosen
from campaign.fuzz import Fuzz
from campaign.outcomes import Outcome, Record
from common.command_line import Failure
from own_folder import InOwnFolder

SOUND = """\
#!/bin/sh
echo "#7: cov: 31 ft: 40 corp: 2 exec/s: 7 oom/timeout/crash: 0/0/0 time: 1s job: 1 dft_time: 0"
echo "#977: cov: 43 ft: 51 corp: 5 exec/s: 400 oom/timeout/crash: 0/0/0 time: 2s job: 2 dft_time: 0"
"""
# finds one fault twice, others once, and one that it does not show again
FAULTY = """\
#!/bin/sh
for argument; do
  case $argument in -artifact_prefix=*) prefix=${argument#*=} ;; esac
  last=$argument
done
if [ -z "$prefix" ]; then
  case $(cat "$last") in
    bool*) echo "wire.hpp:99:12: runtime error: load of value $(wc -c <"$last"), which is no value for type 'bool'" ;;
    other) echo "wire.hpp:11:3: runtime error: load of value 5, which is no value for type 'bool'" ;;
    law*) echo "fault: $PWD/small.toml: what was written reads back as something else" ;;
  esac
  exit 77
fi
for input in bool-long bool other law-long law again; do printf $input >"${prefix}crash-$input"; done
echo "#13: cov: 9 ft: 9 corp: 1 exec/s: 1 oom/timeout/crash: 0/0/4 time: 1s job: 3 dft_time: 0"
"""
OPERATORS = [
    {"name": "voxel", "parameters": [{"name": "edge", "type": "number", "allowed": "0 to 1"}]},
    {"name": "neural", "parameters": [{"name": "pairing", "type": "option", "allowed": '"before", "after-mapping"'}]},
]


class Counting:
    """A part that finds a fault in every third case."""

    name = "counting"

    def __init__(self, cases, stops_after=None):
        self._cases, self._stops_after = cases, stops_after
        self.seconds = []

    def sitting(self, seconds, past):
        self.seconds.append(seconds)
        for number in range(len(past), len(past) + self._cases):
            if number == self._stops_after:
                raise KeyboardInterrupt
            yield Outcome(self.name, "number", 5, (f"number {number}",) if number % 3 == 2 else (), 30)


class Campaigns(InOwnFolder):
    def sit(self, *parts):
        with contextlib.redirect_stdout(io.StringIO()) as told:
            campaign(60, self.folder / "out", parts)
        self.assertEqual(told.getvalue().strip(), str(self.folder / "out" / "report.md"))
        return self.page()

    def test_one_part_can_be_chosen(self):
        counting, other = Counting(1), Counting(1)
        other.name = "other"
        self.assertEqual(chosen([counting, other], None), [counting, other])
        self.assertEqual(chosen([counting, other], "other"), [other])
        with self.assertRaisesRegex(Failure, "--only soak: .*counting, other"):
            chosen([counting, other], "soak")

    def test_planted_faults_have_no_parts(self):
        for option in (["--only", "fuzz"], ["--gpu"]):
            with contextlib.redirect_stderr(io.StringIO()) as told, self.assertRaises(SystemExit):
                arguments.parse(["--planted", "3", *option])
            self.assertRegex(told.getvalue(), "--planted: .*--only.*--gpu")

    def page(self):
        return (self.folder / "out" / "report.md").read_text()

    def fuzz(self):
        return Fuzz(lambda: self.folder, OPERATORS, self.folder / "out")

    def target(self, name, text):
        self.script(text, f"fuzz_{name}")

    def test_sittings_add_up_and_parts_share_the_time(self):
        self.assertIn("| counting | 20 | 19 | 1 | 2.0 |", self.sit(Counting(4)))
        page = self.sit(Counting(3))
        self.assertIn("| counting | 35 | 33 | 2 | 3.5 |", page)
        self.assertIn("\n- number 5\n", page)
        parts = [Counting(1), Counting(1)]
        self.sit(*parts)
        self.assertEqual([part.seconds for part in parts], [[30], [30]])

    def test_what_was_tried_before_an_interruption_counts(self):
        with self.assertRaises(KeyboardInterrupt), contextlib.redirect_stdout(io.StringIO()):
            campaign(60, self.folder / "out", [Counting(4, stops_after=2)])
        self.assertIn("| counting | 10 | 10 | 0 | 1.0 |", self.page())

    def test_a_line_that_was_cut_is_dropped(self):
        self.sit(Counting(2))
        file = self.folder / "out" / "outcomes.jsonl"
        file.write_text(file.read_text() + '{"part": "coun')
        self.assertIn("| counting | 15 | 14 | 1 | 1.5 |", self.sit(Counting(1)))
        self.assertEqual(len(Record(self.folder / "out").outcomes), 3)

    def test_a_line_that_is_no_outcome_is_refused_by_its_place(self):
        self.sit(Counting(1))
        file = self.folder / "out" / "outcomes.jsonl"
        for line in ("[]", "{}", "7", '{"part": "a", "found": 3}', "part"):
            file.write_text(file.read_text().splitlines()[0] + f"\n{line}\n")
            with self.assertRaisesRegex(Failure, f"{file}:2: .*--out"):
                Record(self.folder / "out")

    def test_a_faulty_target_is_found_and_others_hold(self):
        self.target("faulty", FAULTY)
        self.target("sound", SOUND)
        page = self.sit(self.fuzz())
        self.assertIn("| fuzz | 990 | 986 | 4 |", page)
        self.assertRegex(page, r"\| sound \| 977 \| 977 \| 0 \| [\d.]+ \| 43 \|")
        found = (self.folder / "out" / "found").resolve()
        self.assertIn(f"- {found}/faulty-crash-bool: wire.hpp:99:12: runtime error: load of value 4, ", page)
        self.assertRegex(page, f"- {found}/faulty-crash-law: /.*: what was written reads back as something else\n")
        self.assertIn(f"- {found}/faulty-crash-again: it is not shown again\n", page)
        self.assertIn(f"- {found}/faulty-crash-other: wire.hpp:11:3: ", page)
        names = {each.name.removeprefix("faulty-crash-") for each in found.iterdir()}
        self.assertEqual(names, {"bool", "other", "law", "again"}, "the smallest of each")

    def test_targets_share_the_cores(self):
        # each target waits for the other, and tells in how many processes it should run
        meet = (
            f'touch "{self.folder}/$(basename "$0").here"\n'
            f'cd "{self.folder}" && timeout 60 sh -c "until [ -e fuzz_one.here -a -e fuzz_two.here ]; do :; done" || exit\n'
            f'for argument; do case $argument in -fork=*) echo "${{argument#*=}}" >>"{self.folder}/forks" ;; esac; done\n'
        )
        for name in ("one", "two"):
            self.target(name, f"#!/bin/sh\n{meet}{SOUND}")
        with unittest.mock.patch("os.cpu_count", return_value=7):
            page = self.sit(self.fuzz())
        self.assertEqual((self.folder / "forks").read_text().split(), ["3", "3"])
        self.assertIn("| fuzz | 1,954 | 1,954 | 0 |", page)

    def test_names_of_operators_and_parameters_are_given_to_the_target_that_reads_them(self):
        words = self.folder / "words"
        given = f'for argument; do case $argument in -dict=*) cp "${{argument#*=}}" "{words}" ;; esac; done\n'
        self.target("body", SOUND + given)
        self.sit(self.fuzz())
        self.assertFalse(words.exists())
        self.target("experiment", SOUND + given)
        self.sit(self.fuzz())
        expected = ["after-mapping", "before", "edge", "neural", "pairing", "voxel"]
        self.assertEqual(words.read_text().split(), [f'"{word}"' for word in expected])

    def test_a_folder_without_targets_and_a_target_that_makes_no_inputs_are_refused(self):
        with self.assertRaisesRegex(Failure, f"{self.folder}: .*fuzz_targets"):
            self.sit(self.fuzz())
        self.target("silent", "#!/bin/sh\necho this is no fuzzer\n")
        with self.assertRaisesRegex(Failure, "fuzz_silent.*this is no fuzzer"):
            self.sit(self.fuzz())


unittest.main()
