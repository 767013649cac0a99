"""Tests that a campaign notices what a long run takes and does not give back."""

import contextlib
import pathlib
import sqlite3
import sys
import unittest

from campaign.soak import Sample, Soak, archived
from own_folder import PROGRAM, InOwnFolder

# Stands in for evodevo: a run of 400 generations, each of which adds 100 kB to the archive and may leak.
RUN = """\
#!{python}
import pathlib, sys, threading
word, *rest = sys.argv[1:]
assert "--no-report" in rest
folder = pathlib.Path(rest[rest.index("--out") + 1] if word == "run" else rest[0])
folder.mkdir(exist_ok=(word == "resume"))
archive = folder / "run.sqlite"
first = archive.stat().st_size // 100_000 if word == "resume" else 0
kept, end = [], threading.Event()
for generation in range(first, first + 400):
    size = 100_000
    {leak}
    with archive.open("ab") as file:
        file.write(bytes(size))
    print("generation", generation, " " * 100_000, flush=True)  # more than a pipe holds, so that a reader keeps up
end.set()
"""


class Soaks(InOwnFolder):
    def sit(self, leak, past=()):
        """Returns the outcome of a run that ends by itself, long before the sitting does."""
        program = self.script(RUN.format(python=sys.executable, leak=leak))
        (outcome,) = Soak(program, self.folder / "out", pause=0).sitting(600, past)
        return outcome

    def found(self, leak):
        """Returns what is said of the one fault."""
        (fault,) = self.sit(leak).found or ("nothing",)
        file, _, text = fault.partition(": ")
        self.assertEqual(pathlib.Path(file), self.folder / "out" / "soak" / "samples.csv")
        return text

    def test_evodevo_is_asked_to_stop_when_the_time_is_over_and_goes_on(self):
        soak = Soak(PROGRAM, self.folder / "out", pause=0)
        (first,) = soak.sitting(1, [])
        (second,) = soak.sitting(0, [first])  # at least one generation, however little time there is
        self.assertEqual((first.found, second.found), ((), ()))
        self.assertGreater(min(first.tried, second.tried), 0)
        with contextlib.closing(sqlite3.connect(self.folder / "out" / "soak" / "run" / "run.sqlite")) as archive:
            ((generations,),) = archive.execute("SELECT count(*) FROM generations")
        self.assertGreaterEqual(generations, first.tried + second.tried)

    def test_a_run_that_holds_the_same_is_sound_and_goes_on(self):
        first = self.sit("pass")
        self.assertEqual((first.part, first.case, first.tried, first.found), ("soak", "generations", 400, ()))
        self.assertEqual(self.sit("pass", [first]).tried, 400)
        samples = (self.folder / "out" / "soak" / "samples.csv").read_text().splitlines()
        self.assertRegex(samples[1], "^0,0,")
        self.assertRegex(samples[-1], "^1,79[78],")  # when the last line is read, the process may have ended

    def test_leaks(self):
        for name, leak in (
            ("memory", "kept.append(bytearray(b'x') * 100_000)"),
            ("files", "kept.append(open('/dev/null'))"),
            ("threads", "generation % 20 or threading.Thread(target=end.wait).start()"),
        ):
            with self.subTest(name):
                self.setUp()
                self.assertRegex(self.found(leak), rf"^{name} grew from [\d,]+ to [\d,]+ between generations \d+ and \d+$")

    def test_an_archive_that_grows_faster_and_faster(self):
        self.assertRegex(self.found("size = 2_000 * generation"), "^archive grew by [\d,]+ bytes .* and by [\d,]+ up to 39[78]$")

    def test_an_archive_that_grows_with_each_sitting(self):
        size = lambda sitting, i: 100_000 * (100 * sitting + i) * (1 + sitting)
        samples = [Sample(sitting, 100 * sitting + i, 1, 1, 1, size(sitting, i)) for sitting in range(2) for i in range(100)]
        self.assertEqual(list(archived(samples[:100])), [])
        self.assertEqual(len(list(archived(samples))), 1)

    def test_a_run_that_crashes(self):
        crash = "if generation == 7: print('out of', 'luck', sep='\\n', file=sys.stderr); sys.exit(7)"
        self.assertEqual(self.found(crash), "exit code 7: out of / luck")


unittest.main()
