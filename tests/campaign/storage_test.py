"""Tests that programs which lose what they have stored are found out: programs that stand in for evodevo, each with one
fault."""

import pathlib
import random
import signal
import subprocess
import sys
import time
import unittest

from campaign.failing_calls import Call, Fault, Faults
from campaign.outcomes import Outcome
from campaign.power_loss import SHARES, Disk
from campaign.storage import DyingRank, Storage
from common.command_line import Failure
from own_folder import PROGRAM, InOwnFolder

LIBRARY = pathlib.Path(PROGRAM).resolve().parents[1] / "lib" / "faults.so"

# Stores three generations as evodevo does. What `fault` names goes wrong.
STAND_IN = """\
#!{python} -P
import argparse, fcntl, json, os, pathlib, shutil, sqlite3, sys, time

fault = {fault!r}


def fails(error):
    if fault == "crashes":
        os.abort()
    if fault == "goes on":
        return
    if fault != "says nothing":
        print(f"stand-in: {{given.out}}: {{error}}; try again", file=sys.stderr)
    sys.exit(1)


def synchronise(folder):
    descriptor = os.open(folder, os.O_RDONLY)
    os.fsync(descriptor)
    os.close(descriptor)


def opened():
    if fault == "begins again":
        shutil.rmtree(given.out, ignore_errors=True)
    given.out.mkdir(exist_ok=True)
    if fault != "forgets folders":
        synchronise(given.out.parent)
    lock = open(given.out / "lock", "w")
    if fault != "does not lock":
        fcntl.lockf(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    run = sqlite3.connect(given.out / "run.sqlite", isolation_level=None, timeout=0)
    run.execute(f"PRAGMA journal_mode={{'OFF' if fault == 'keeps no journal' else given.journal}}")
    run.execute(f"PRAGMA synchronous={{'OFF' if fault == 'does not synchronise' else 'EXTRA'}}")
    run.execute("CREATE TABLE IF NOT EXISTS generations(generation INTEGER, evaluations INTEGER)")
    return lock, run, os.stat(given.out / "run.sqlite")


def log(line, descriptor):
    while line and fault != "writes once":
        line = line[os.write(descriptor, line) :]
    os.write(descriptor, line)


def make():
    begun = time.time()
    lock, run, file = opened()
    descriptor = os.open(given.log, os.O_WRONLY | os.O_CREAT | os.O_APPEND)
    (first,) = run.execute("SELECT count(*) FROM generations").fetchone()
    for generation in range(first, 3):
        if fault == "tells too early":
            log(json.dumps({{"generation": generation}}).encode() + b"\\n", descriptor)
        run.execute("BEGIN IMMEDIATE")
        run.execute("INSERT INTO generations VALUES(?, ?)", (generation, 4 * generation))
        if fault == "trusts the clock" and not -60 < time.time() - begun < 60:
            raise OSError("this takes too long")
        run.execute("COMMIT")
        if fault != "looks away" and not os.path.samestat(os.stat(given.out / "run.sqlite"), file):
            raise OSError("the file was replaced")
        if fault != "tells too early":
            log(json.dumps({{"generation": generation}}).encode() + b"\\n", descriptor)
    run.close()


parser = argparse.ArgumentParser()
parser.add_argument("command", choices=("run", "show"))
parser.add_argument("input", type=pathlib.Path)
parser.add_argument("--out", type=pathlib.Path)
parser.add_argument("--log", type=pathlib.Path)
parser.add_argument("--journal")
given, rest = parser.parse_known_args()
if given.command == "run":
    try:
        make()
    except (OSError, sqlite3.Error) as error:
        fails(error)
elif fault == "cannot show" or not (given.input / "run.sqlite").exists():
    given.out = given.input
    fails("there is no run")
"""


class StandIns(InOwnFolder):
    def stand_in(self, fault=""):
        return self.script(STAND_IN.format(python=sys.executable, fault=fault), "stand-in")

    def cases(self, program):
        storage = Storage(program, LIBRARY, self.folder / "out")
        return {case.name: case for case in storage.cases() if not isinstance(case, DyingRank)}

    def found(self, fault, case):
        """Returns the first fault that a case finds in a stand-in, beginning with the last call."""
        case = self.cases(self.stand_in(fault))[case]
        return next((found for number in range(case.count() - 1, -1, -1) for found in case.faults(number)), "nothing")

    def test_a_sound_one_holds(self):
        for name, case in self.cases(self.stand_in()).items():
            for number in (0, 25) if case.count() else ():
                self.assertEqual(case.faults(number), [], name)

    def test_each_fault_is_found(self):
        deleting = "run with journal delete"
        after_loss = "show: |lost: |damaged|the same command again"
        for fault, case, said in (
            *(("goes on", f"run{case}", r"\): exit code 0: ")
              for case in (": EIO", ": full", " with journal delete: EIO", ": ENOMEM")),
            ("crashes", "run: EIO", r"call \d+ \(.*: exit code -6: "),
            ("says nothing", "run: EIO", ": exit code 1: "),
            ("writes once", "run: short", "a line of the log that is no generation"),
            ("trusts the clock", "run: clock forward", ": exit code 1: "),
            ("trusts the clock", "run: clock back", ": exit code 1: "),
            ("tells too early", "run: kill", r"lost: generation \d "),
            ("begins again", "run: kill", r"lost: generation \d "),
            ("keeps no journal", f"{deleting}: torn", "again: |damaged"),
            ("cannot show", "run: kill", "show: exit code 1: "),
            ("does not synchronise", "run: loss of power", after_loss),
            ("forgets folders", "run: loss of power", after_loss),
            ("does not lock", f"{deleting}: two writers", "generations differs"),
            ("looks away", "run: moved and replaced files", ": exit code 0: "),
        ):
            with self.subTest(f"{fault}, {case}"):
                self.assertRegex(self.found(fault, case), said)

    def test_what_is_found_can_be_repeated(self):
        again = self.found("crashes", "run: EIO").rpartition("; again: ")[2]
        repeated = subprocess.run(["sh", "-c", again], stderr=subprocess.DEVNULL)
        self.assertIn(repeated.returncode, (-signal.SIGABRT, 128 + signal.SIGABRT))

    def test_a_library_that_is_missing_is_named(self):
        missing = self.folder / "faults.so"
        with self.assertRaisesRegex(Failure, f"{missing}: .*evodevo_faults"):
            Storage(self.stand_in(), missing, self.folder / "out")

    def test_the_next_sitting_goes_on(self):
        storage = Storage(self.stand_in("crashes"), LIBRARY, self.folder / "out")
        first = next(storage.sitting(1000, []))
        names = {case.name for case in storage.cases()} - {first.case}
        others = [Outcome(first.part, name, 1000, (), 1) for name in names]
        second = next(storage.sitting(1000, [first, *others]))
        calls = [[found.partition(" (")[0] for found in outcome.found] for outcome in (first, second)]
        self.assertEqual((second.case, second.tried), (first.case, first.tried))
        self.assertTrue(calls[0] and calls[1] and not set(calls[0]) & set(calls[1]), calls)


class Evodevo(InOwnFolder):
    def test_can_be_tried_with_each_case(self):
        for case in Storage(PROGRAM, LIBRARY, self.folder).cases():
            for number in (3, 104) if case.count() else ():
                self.assertEqual(case.faults(number), [], case.name)

    def test_what_is_reported_survives_a_loss_of_power(self):
        nothing_else = next(number for number in range(99) if random.Random(number).choice(SHARES) == 0)
        cases = {case.name: case for case in Storage(PROGRAM, LIBRARY, self.folder).cases()}
        for name in ("run: loss of power", "run with journal delete: loss of power"):
            case, run = cases[name], cases[name].run_of(1)
            reports = [point for point in case.points(run) if point[1].name == "write" and point[1].file == "/log"]
            self.assertEqual(len(reports), 4)
            for point in reports:
                case.attempt(run, point, nothing_else)

    def test_a_build_without_mpi_leaves_ranks_out_by_name(self):
        library = self.folder / "lib" / "faults.so"
        library.parent.mkdir()
        library.touch()
        ranks = [case for case in Storage(PROGRAM, library, self.folder).cases() if isinstance(case, DyingRank)]
        for case in ranks:
            self.assertEqual(case.count(), 0)
            self.assertRegex(case.missing, "built without MPI|no mpirun")
        self.assertEqual(len(ranks), 2)

    def test_a_rank_whose_death_costs_generations_is_found(self):
        program = self.program('[ -n "$OMPI_COMM_WORLD_RANK" ] || rm -rf "${5%log}run"')  # $5 is the log beside the run
        case = next(case for case in Storage(program, LIBRARY, self.folder).cases() if isinstance(case, DyingRank))
        if case.count() == 0:
            self.skipTest(case.missing)
        found = [found for number in range(8, 40, 8) for found in case.faults(number)]
        self.assertRegex(" ".join(found), r"rank 0 at message \d+ \((send|receive)\): lost: generation 0")


class Libraries(InOwnFolder):
    """What the library does to the calls of a program, here of this Python."""

    def setUp(self):
        super().setUp()
        self.faults = Faults(LIBRARY, self.folder / "case")
        self.faults.folder.mkdir()
        self.file = self.faults.folder / "file"

    def call(self, lines, fault=Fault()):
        return self.faults.call([sys.executable, "-c", f"import os\nfile = {str(self.file)!r}\n{lines}"], fault)

    WRITES = "f = os.open(file, os.O_WRONLY | os.O_CREAT)\nprint(os.write(f, b'abcd'), os.write(f, b'ef'))"

    def test_calls_are_recorded(self):
        self.assertEqual(self.call(f"{self.WRITES}\nos.fsync(f)\nos.unlink(file)").stdout, "4 2\n")
        opened, *rest = [call for call in self.faults.recorded() if call.name != "clock"]
        self.assertEqual(opened, Call("open", opened.result, "/file", "new", b""))
        writes = [Call("write", 4, "/file", "0", b"abcd"), Call("write", 2, "/file", "4", b"ef")]
        self.assertEqual(rest, [*writes, Call("fsync", 0, "/file", "", b""), Call("unlink", 0, "/file", "", b"")])

    def test_one_call_fails(self):
        for kind in ("EIO", "EINTR", "ENOMEM", "full"):
            self.assertRegex(self.call("os.mkdir(file)", Fault(kind, 1)).stderr, "Error: ")
            self.assertFalse(self.file.exists())
        self.assertEqual(self.call("os.mkdir(file)", Fault("EIO", 2)).returncode, 0)
        self.file.rmdir()

        # a full disk stays full
        self.assertIn("No space", self.call(self.WRITES, Fault("full", 1)).stderr)
        lines = self.WRITES.replace("print", "\ntry: os.write(f, b'x')\nexcept OSError: pass\nprint")
        self.assertIn("No space", self.call(lines, Fault("full", 2)).stderr)

    def test_writes_are_cut_and_programs_are_killed(self):
        self.assertEqual(self.call(self.WRITES, Fault("short", 2)).stdout, "2 2\n")
        self.assertEqual(self.file.read_bytes(), b"abef")
        self.file.unlink()
        self.assertEqual(self.call(self.WRITES, Fault("torn", 3)).returncode, -9)
        self.assertEqual(self.file.read_bytes(), b"abcde")
        self.file.unlink()
        self.assertEqual(self.call(self.WRITES, Fault("kill", 3)).returncode, -9)
        self.assertEqual(self.file.read_bytes(), b"abcd")

    def test_clocks_jump(self):
        for kind, hours in (("forward", (1, 1)), ("back", (-1, 0))):
            told = self.call("import time\nprint(time.time(), time.monotonic())", Fault(kind, 1)).stdout.split()
            jumps = float(told[0]) - time.time(), float(told[1]) - time.monotonic()
            self.assertEqual(tuple(round(jump / 3600) for jump in jumps), hours)


class Disks(InOwnFolder):
    """What may be on a disk after a loss of power."""

    def states(self, *calls):
        """Returns all that is left in some of 300 losses of power."""
        states = []
        for number in range(300):
            disk = Disk(self.folder)
            for call in calls:
                disk.play(call)
            left = disk.after_loss(random.Random(number))
            if left not in states:
                states.append(left)
        return states

    NEW = Call("open", 3, "/a", "new", b"")
    FOLDER_SYNC, FILE_SYNC = Call("fsync", 0, "", "", b""), Call("fdatasync", 0, "/a", "", b"")

    def test_what_is_synchronised_is_certain(self):
        write = Call("write", 2, "/a", "0", b"xy")
        self.assertEqual(self.states(self.NEW, self.FOLDER_SYNC, write, self.FILE_SYNC), [{"": None, "/a": b"xy"}])
        whole = {"": None, "/a": b"xy"}
        self.assertCountEqual(self.states(self.NEW, write, self.FILE_SYNC), [{"": None}, whole])
        self.assertCountEqual(self.states(self.NEW, self.FOLDER_SYNC, write), [{"": None, "/a": b""}, whole])

    def test_sectors_are_written_in_any_order_and_sizes_may_be_old(self):
        (self.folder / "a").write_bytes(b"o" * 1024)
        states = self.states(Call("write", 1024, "/a", "0", b"n" * 1024))
        expected = [a * 512 + b * 512 for a in (b"o", b"n") for b in (b"o", b"n")]
        self.assertCountEqual([state["/a"] for state in states], expected)
        states = self.states(Call("write", 4, "/a", "510", b"nnnn"))  # across the border of two sectors
        self.assertEqual(len(states), 4)
        (self.folder / "a").write_bytes(b"abc")
        states = self.states(Call("ftruncate", 0, "/a", "1", b""))
        self.assertCountEqual([state["/a"] for state in states], [b"abc", b"a"])

    def test_entries_keep_their_order(self):
        (self.folder / "a").write_bytes(b"a")
        states = self.states(Call("rename", 0, "/a", "/b", b""), Call("mkdir", 0, "/c", "", b""))
        renamed = {"": None, "/b": b"a"}
        self.assertCountEqual(states, [{"": None, "/a": b"a"}, renamed, renamed | {"/c": None}])

    def test_calls_that_failed_change_nothing(self):
        self.assertEqual(self.states(Call("open", -1, "/a", "new", b"")), [{"": None}])


unittest.main()
