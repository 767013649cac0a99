"""The part that lets storage and processes fail: at each call of a small run in turn, by all orders in which a disk may
write before it loses power, by other processes, and by ranks that die."""

import collections
import functools
import random
import shutil
import signal
import time

from common.command_line import Failure

from .calls import Broken, obstacle_to_ranks
from .failing_calls import Fault, Faults
from .made_run import Kind, MadeRun, files, reported_in
from .outcomes import Outcome
from .power_loss import CHANGES, Disk

BATCH = 10  # tries of one outcome
RUN, RUN_DELETE = Kind("run"), Kind("run with journal delete", "delete")
KINDS = (
    RUN,
    RUN_DELETE,
    Kind("resumed run", interrupted=True),
    Kind("resumed run with journal delete", "delete", interrupted=True),
    Kind("run with islands", islands=True),
)
OF_RANKS = (Kind("run of three ranks", ranks=3), Kind("run with islands of three ranks", islands=True, ranks=3))
STRUCK = {  # the calls that each kind of fault strikes
    "EIO": None,  # all that use files
    "EINTR": None,
    "ENOMEM": ("mmap",),
    "full": ("write", "ftruncate", "mkdir", "open"),
    "short": ("write",),
    "torn": ("write",),
    "kill": CHANGES,
}
DEADLY = ("torn", "kill")
HARMLESS = ("short", "forward", "back")  # with which the run must succeed
KEPT = ("run.sqlite", "run.sqlite-wal", "run")  # which can be put back where they were before they were moved


class Storage:
    """Each case goes through the calls of a run, and then through those of the run with the next seed."""

    name = "storage"

    def __init__(self, program, library, folder):
        self._program, self._library = program, library
        self._folder = folder.resolve() / "storage"
        self._found = folder.resolve() / "found"
        if not library.is_file():
            raise Failure(f"{library}: the library of faults is missing; build the target evodevo_faults")

    def sitting(self, seconds, past):
        end = time.monotonic() + seconds
        tried = collections.Counter()
        for each in past:
            tried[each.case] += each.tried
        cases = self.cases()
        while time.monotonic() < end and cases:
            case = min(cases, key=lambda case: tried[case.name])
            began, found = time.monotonic(), []
            if case.count() == 0:
                yield Outcome(self.name, f"{case.name}: left out, since {case.missing}", 0, (), 0)
                cases.remove(case)
                continue
            first = tried[case.name]
            while tried[case.name] < first + BATCH and (tried[case.name] == first or time.monotonic() < end):
                found += case.faults(tried[case.name])
                tried[case.name] += 1
            yield Outcome(self.name, case.name, tried[case.name] - first, tuple(found), time.monotonic() - began)

    def cases(self):
        cases = [
            Struck(self._run_of(kind), f"{kind.name}: {fault}", fault)
            for kind in KINDS
            for fault in STRUCK
            if fault != "ENOMEM" or kind.journal == "wal"  # the other journal shares no memory
        ]
        cases += [Jump(self._run_of(RUN), f"{RUN.name}: clock {way}", way) for way in ("forward", "back")]
        cases += [PowerLoss(self._run_of(kind), f"{kind.name}: loss of power", self._found) for kind in KINDS]
        for kind in (RUN, RUN_DELETE):
            cases.append(TwoWriters(self._run_of(kind), f"{kind.name}: two writers"))
            cases.append(MovedFiles(self._run_of(kind), f"{kind.name}: moved and replaced files"))
        obstacle = obstacle_to_ranks(self._library.parents[1])
        return cases + [DyingRank(self._run_of(kind), f"{kind.name}: a rank dies", obstacle) for kind in OF_RANKS]

    def _run_of(self, kind):
        """Returns a function that returns the run with a seed."""
        return functools.partial(self._run, kind)

    @functools.cache
    def _run(self, kind, seed):
        folder = self._folder / kind.name.replace(" ", "-") / str(seed)
        return MadeRun(self._program, Faults(self._library, folder / "case"), kind, seed)


class Case:
    """What can happen at each of some calls of a run. A subclass has points(run), which returns at which;
    attempt(run, point, number), which lets it happen and raises Broken if a law does not hold then; and
    again(run, point, number), which returns a line for a shell that lets it happen again."""

    missing = "the run makes no such call"

    def __init__(self, run_of, name):
        self.run_of, self.name = run_of, name

    def count(self):
        """Returns how much can be tried with the first run."""
        return len(self._points(self.run_of(1)))

    def faults(self, number):
        """Tries what has this number. Returns the faults that it finds."""
        run, point = self._place(number)
        try:
            self.attempt(run, point, number)
        except Broken as broken:
            return [f"{self.name}: {self.told(point)}: {broken}; again: {self.again(run, point, number)}"]
        return []

    def _place(self, number):
        """Returns the run and the point that have a number."""
        rounds, position = divmod(number, self.count())
        run = self.run_of(1 + rounds)
        points = self._points(run)
        return run, points[position % len(points)]

    @functools.cache
    def _points(self, run):
        return self.points(run)

    def told(self, point):
        number, call = point
        return f"call {number} ({call.name} {call.file})"


class Struck(Case):
    """A fault at each call that uses a file."""

    def __init__(self, run_of, name, kind):
        super().__init__(run_of, name)
        self._kind = kind

    def points(self, run):
        struck = STRUCK[self._kind]
        return [(number, call) for number, call in files(run.straight.calls) if not struck or call.name in struck]

    def attempt(self, run, point, number):
        run.begin()
        ended = run.faults.call(run.command, self._fault(point))
        run.ends_well(ended, signal.SIGKILL if self._kind in DEADLY else None, self._kind in HARMLESS)
        reported = run.reported()
        if number % 2:  # the others let `run` recover what is left
            run.can_be_shown(reported)
        run.goes_on(reported)

    def again(self, run, point, number):
        return run.again(self._fault(point))

    def _fault(self, point):
        return Fault(self._kind, point[0])


class Jump(Struck):
    """A clock that jumps at each reading."""

    def points(self, run):
        return list(enumerate((call for call in run.straight.calls if call.name == "clock"), 1))


class PowerLoss(Case):
    """A loss of power after each call that changes a file: what the disk then holds is drawn at random."""

    def __init__(self, run_of, name, found):
        super().__init__(run_of, name)
        self._found = found

    def points(self, run):
        return [(number, call) for number, call in files(run.straight.calls) if call.name in CHANGES]

    def attempt(self, run, point, number):
        reported = self._lose_power(run, point, number, run.case)
        if number % 2:
            run.can_be_shown(reported)
        run.goes_on(reported)

    def again(self, run, point, number):
        kept = self._found / f"{self.name}-{number}".replace(" ", "-").replace(":", "")
        self._lose_power(run, point, number, kept)
        return run.again(beginning=kept)

    @staticmethod
    def _lose_power(run, point, number, folder):
        """Makes the folder what the disk may hold, and returns how many generations were reported as stored."""
        disk, log = Disk(run.beginning), run.beginning / "log"
        told = log.read_bytes() if log.exists() else b""
        for _, call in files(run.straight.calls)[: point[0]]:
            disk.play(call)
            if call.name == "write" and call.file == "/log":
                told += call.data
        shutil.rmtree(folder, ignore_errors=True)
        for path, content in sorted(disk.after_loss(random.Random(number)).items()):
            if content is None:
                (folder / path[1:]).mkdir(parents=True)
            elif path != "/log":
                (folder / path[1:]).write_bytes(content)
        return reported_in(told)


class Stopped(Case):
    """What other processes do while a run stands still at each call that changes a file. A subclass has meanwhile(run,
    number), which may return what is to be done when the run has ended: a function of the run and its exit code that
    returns whether the laws hold for what is there then."""

    def points(self, run):
        return [(number, call) for number, call in files(run.straight.calls) if call.name in CHANGES]

    def attempt(self, run, point, number):
        run.begin()
        put_back = None
        with run.faults.begun(run.command, Fault("stop", point[0])) as process:
            try:
                if run.faults.is_stopped(process):
                    put_back = self.meanwhile(run, number)
            finally:
                process.send_signal(signal.SIGCONT)
            ended = run.faults.ended(process, run.command)
        if put_back and not put_back(run, ended.returncode):
            return
        run.ends_well(ended)
        run.goes_on(run.reported())

    def again(self, run, point, number):
        return run.again(Fault("stop", point[0]))


class TwoWriters(Stopped):
    """The same command a second time."""

    def meanwhile(self, run, number):
        run.ends_well(run.faults.call(run.command))


class MovedFiles(Stopped):
    """A file of the run, or its folder, is moved elsewhere, and replaced by a copy in half of the cases."""

    def meanwhile(self, run, number):
        if not run.run.exists():
            return None
        is_all_stored = run.reported() == run.straight.generations
        target = random.Random(number).choice([*sorted(run.run.iterdir()), run.run])
        elsewhere = run.case / "elsewhere"
        target.rename(elsewhere)
        if number % 2:
            (shutil.copytree if elsewhere.is_dir() else shutil.copy)(elsewhere, target)
        return functools.partial(self._put_back, target, elsewhere, is_all_stored)

    @staticmethod
    def _put_back(target, elsewhere, is_all_stored, run, code):
        """Puts back what was moved, unless the run went on without it: then it must have stored all where it should.
        Returns whether the laws hold for what is there now."""
        if code == 0 and (not is_all_stored or run.is_whole()):
            return True
        if target.name in KEPT:
            shutil.rmtree(target) if target.is_dir() else target.unlink(missing_ok=True)
            elsewhere.rename(target)
        return code == 0 or target.name != "run.sqlite-journal"


class DyingRank(Case):
    """A rank dies at each message that it sends or receives."""

    def __init__(self, run_of, name, obstacle):
        """`obstacle`: why there are no runs of several ranks, or None."""
        super().__init__(run_of, name)
        self._obstacle, self.missing = obstacle, obstacle or self.missing

    def points(self, run):
        if self._obstacle:
            return []
        return [
            (number, rank, call)
            for rank, messages in enumerate(run.straight.messages)
            for number, call in enumerate(messages, 1)
        ]

    def told(self, point):
        number, rank, call = point
        return f"rank {rank} at message {number} ({call.name})"

    def attempt(self, run, point, number):
        run.begin()
        ended = run.faults.call(run.command, self._fault(point))
        if ended.returncode == 0:
            run.is_complete("exit code 0")
        run.goes_on(run.reported())

    def again(self, run, point, number):
        return run.again(self._fault(point))

    @staticmethod
    def _fault(point):
        number, rank, _ = point
        return Fault("message-kill", number, str(rank))
