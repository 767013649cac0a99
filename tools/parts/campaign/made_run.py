"""A small run that is made again and again, with faults, in the same folder, and the laws that hold then."""

import contextlib
import dataclasses
import functools
import json
import shlex
import shutil
import sqlite3

from common.command_line import Failure

from .calls import RANKS, Broken, require
from .failing_calls import Fault
from .laws import made, same_rows

MESSAGES = ("send", "receive")  # of MPI
ENDED = (1, 2)  # exit codes of a program that ends with a message
EXPERIMENT = """\
[experiment]
evaluations = 16
population = 4
seed = {seed}

[encoding]
name = "voxel"
size = [2, 1, 1]
edge = 0.5

[[mutation]]
name = "reset-weight"

[scene.gravity]
[scene.floor]
[scene.friction]
[scene.damping]

[simulation]
device = "cpu"

[development]
cycles = 2
cycle_time = 0.05

[[development.operator]]
name = "spring-turnover"
springs = 2

[[fitness]]
name = "distance"
settle = 0.05
window = 0.1

[selection]
name = "age-fitness-pareto"
"""
ISLANDS = """
[islands]
count = 2
every = 2
"""


@dataclasses.dataclass(frozen=True)
class Kind:
    """A kind of runs. `interrupted`: whether they begin from what a killed process has left. `ranks`: how many mpirun
    starts; without mpirun if 0."""

    name: str
    journal: str = "wal"
    interrupted: bool = False
    islands: bool = False
    ranks: int = 0


@dataclasses.dataclass(frozen=True)
class Straight:
    """The run without faults, with which everything else is compared."""

    calls: list  # in its record, without messages
    messages: list  # of each rank
    generations: dict  # how many of each island, as reported() tells


class MadeRun:
    """The folder DIR/case holds the folder of the run, `run`, and the log of its generations, `log`. Without faults,
    the run ends as that in DIR/straight."""

    def __init__(self, program, faults, kind, seed):
        self.program, self.faults, self.kind = program, faults, kind
        self.case = faults.folder
        self.run, self.log = self.case / "run", self.case / "log"
        self.beginning, self._straight = self.case.with_name("beginning"), self.case.with_name("straight")
        file = self.case.with_name("experiment.toml")
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(EXPERIMENT.format(seed=seed) + ISLANDS * kind.islands)
        options = ("--resume", "--log", self.log, "--journal", kind.journal)
        self.alone = [program, "run", file, *options, *made(self.run, 1)]
        self.command = [*RANKS, kind.ranks, *self.alone] if kind.ranks else self.alone

    @functools.cached_property
    def straight(self):
        shutil.rmtree(self.beginning, ignore_errors=True)
        self.beginning.mkdir()
        if self.kind.interrupted:
            self._interrupt()
        self.begin()
        self._make_without_faults()
        shutil.rmtree(self._straight, ignore_errors=True)
        self.run.rename(self._straight)
        messages = [
            [call for call in self.faults.recorded(rank) if call.name in MESSAGES] for rank in range(self.kind.ranks)
        ]
        return Straight(self.faults.recorded(), messages, self.reported())

    def _make_without_faults(self):
        ended = self.faults.call(self.command)
        if ended.returncode != 0:
            command, said = shlex.join(map(str, self.command)), ended.stderr.strip()[-500:]
            raise Failure(f"{command}: exit code {ended.returncode} without a fault: {said}")

    def _interrupt(self):
        """Lets the runs begin from what a process left that was killed when it had stored half of its generations."""
        self.begin()
        self._make_without_faults()
        writes = [number for number, call in files(self.faults.recorded()) if call.name == "write"]
        self.begin()
        self.faults.call(self.command, Fault("kill", writes[len(writes) * 2 // 3]))
        shutil.rmtree(self.beginning)
        self.case.rename(self.beginning)

    def begin(self):
        """Puts the folder into the state from which each case begins."""
        shutil.rmtree(self.case, ignore_errors=True)
        shutil.copytree(self.beginning, self.case)

    def again(self, fault=Fault(), beginning=None):
        """Returns a line for a shell that makes the run again with a fault."""
        commands = (["rm", "-rf", self.case], ["cp", "-a", beginning or self.beginning, self.case])
        prepared = "; ".join(shlex.join(map(str, command)) for command in commands)
        return f"{prepared}; {self.faults.text(self.command, fault)}"

    def reported(self):
        """Returns how many generations of each island the log says are stored."""
        return reported_in(self.log.read_bytes() if self.log.exists() else b"")

    def ends_well(self, ended, by_signal=None, must_succeed=False):
        """The program has ended with success and the right rows or, unless it must succeed, with a message that names
        the place or by the signal with which it was killed."""
        if ended.returncode == 0:
            self.is_complete("exit code 0")
        elif by_signal is None or ended.returncode != -by_signal:
            said = ended.stderr.strip()
            if ended.returncode not in ENDED or not said or must_succeed:
                raise Broken(f"exit code {ended.returncode}: {said[-300:]}")
            if str(self.case) not in said or ";" not in said:
                raise Broken(f"a message without a place or a remedy: {said[-300:]}")

    def can_be_shown(self, reported):
        """`show` reads the run, unless nothing was stored."""
        shown = self.faults.call([self.program, "show", self.run, "--json"])
        if shown.returncode != 0 and (reported or shown.returncode not in ENDED or str(self.run) not in shown.stderr):
            require(shown, "show")

    def goes_on(self, reported):
        """The same command completes the run, and evolves no generation again that was reported as stored."""
        self.log.unlink(missing_ok=True)
        require(self.faults.call(self.alone), "the same command again")
        for line in self.log.read_text().splitlines() if self.log.exists() else ():  # none if the run was complete
            again = json.loads(line)
            if again["generation"] < reported.get(again.get("island", 0), 0):
                raise Broken(f"lost: generation {again['generation']} was reported as stored, and then evolved again")
        self.is_complete("the same command again")

    def is_whole(self):
        try:
            self.is_complete("now")
        except Broken:
            return False
        return True

    def is_complete(self, how):
        for straight in sorted(self._straight.rglob("run.sqlite")):
            file = self.run / straight.relative_to(self._straight)
            if not file.is_file():
                raise Broken(f"{how}: there is no {file}")
            try:
                with contextlib.closing(sqlite3.connect(file)) as run:
                    (checked,) = run.execute("PRAGMA integrity_check(1)").fetchone()
                if checked != "ok":
                    raise Broken(f"{how}: damaged: {checked}")
                same_rows(straight.parent, file.parent, how)
            except sqlite3.Error as error:
                raise Broken(f"{how}: damaged: {error}") from None


def reported_in(log):
    """Returns how many generations of each island are in a log; 0 is the island of a run that has none."""
    reported = {}
    for line in log[: log.rfind(b"\n") + 1].splitlines():
        try:
            generation = json.loads(line)
            reported[generation.get("island", 0)] = generation["generation"] + 1
        except (ValueError, KeyError, TypeError):
            raise Broken(f"a line of the log that is no generation: {line}") from None
    return reported


def files(calls):
    """Returns the calls in a record that use a file, with their numbers."""
    of_files = [call for call in calls if call.name not in ("clock", "fault", *MESSAGES)]
    return list(enumerate(of_files, 1))
