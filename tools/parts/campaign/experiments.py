"""The part that composes experiments at random, and holds the program to the laws of laws.py."""

import concurrent.futures
import contextlib
import dataclasses
import itertools
import json
import queue
import random
import re
import subprocess
import time

import tomlkit

from common.command_line import Failure

from .calls import Broken
from .outcomes import Outcome, name_on_device
from .random_experiment import Draw, without

BATCH = 20  # experiments of whose first run the page is opened
SHRINKING = 300  # s after which an experiment that breaks a law is small enough
EXPERIMENTS = ("runs", "refused by check")  # cases of which each experiment is one


def listed_operators(program):
    """Returns the operators that the program knows, as `evodevo operators --json` lists them."""
    listed = subprocess.run([program, "operators", "--json"], capture_output=True, text=True)
    if listed.returncode != 0:
        raise Failure(f"{program} operators: {listed.stderr.strip()}")
    return json.loads(listed.stdout)


@dataclasses.dataclass(frozen=True)
class Trial:
    """An experiment that was tried."""

    accepted: bool  # by `evodevo check`
    fault: str | None
    seconds: float


class Experiments:
    """Each experiment follows from its number, which goes on from sitting to sitting. One that breaks a law is made as
    small as it can be while that law stays broken, and kept in DIR/found. As many experiments are tried at once as there
    are `laws`, each of which tries one; on a GPU, each tries a batch, in few processes."""

    def __init__(self, operators, laws, folder, device="cpu"):
        self.name = name_on_device("experiments", device)
        self._operators, self._jobs, self._device = operators, len(laws), device
        self._together, self._at_once = (1, BATCH) if device == "cpu" else (BATCH, BATCH * len(laws))
        self._left_out = laws[0].left_out
        self._free = queue.SimpleQueue()
        for each in laws:
            self._free.put(each)
        self._found = folder.resolve() / "found"

    def sitting(self, seconds, past):
        first = sum(each.tried for each in past if each.case in EXPERIMENTS)
        end = time.monotonic() + seconds

        def tried_in_time(numbers):  # at least the first, however little time there is
            if numbers[0] != first and time.monotonic() >= end:
                return ()
            return [self._try(*numbers)] if len(numbers) == 1 else self._try_together(numbers)

        for law, reason in self._left_out.items():
            yield Outcome(self.name, f"{law}: left out, since {reason}", 0, (), 0)
        with concurrent.futures.ThreadPoolExecutor(self._jobs) as pool:
            for begin in itertools.count(first, self._at_once):
                numbers = range(begin, begin + self._at_once)
                trials = pool.map(tried_in_time, parts_of(numbers, self._together))
                yield from self._counted([*itertools.chain.from_iterable(trials)])
                if time.monotonic() >= end:
                    return
                if "pages" not in self._left_out:
                    for batch in parts_of(numbers, BATCH):
                        yield from self._page(batch)

    def _counted(self, trials):
        for case, accepted in zip(EXPERIMENTS, (True, False)):
            of_case = [each for each in trials if each.accepted == accepted]
            found = tuple(each.fault for each in of_case if each.fault)
            yield Outcome(self.name, case, len(of_case), found, sum(each.seconds for each in of_case))

    def _page(self, numbers):
        """Opens the page of the first of some experiments that is accepted."""
        for number in numbers:
            trial = self._try(number, of_page=True)
            if trial.accepted:
                yield Outcome(self.name, "pages", 1, (trial.fault,) if trial.fault else (), trial.seconds)
                return

    def _try_together(self, numbers):
        """Tries experiments in few processes and, if anything is wrong, each of them alone."""
        began = time.monotonic()
        files = [self._file(number, self._drawn(number)) for number in numbers]
        try:
            with self._borrowed_laws() as laws:
                accepted = laws.hold_together(files)
        except Broken as broken:
            return self._try_alone(numbers, broken)
        for file in files:
            file.unlink()
        return [Trial(each, None, (time.monotonic() - began) / len(numbers)) for each in accepted]

    def _try_alone(self, numbers, broken):
        """Tries each of the experiments that together broke a law. If none does alone, all are kept."""
        trials = [self._try(number) for number in numbers]
        if not any(trial.fault for trial in trials):
            files = " ".join(str(self._file(number, self._drawn(number))) for number in numbers)
            trials[0] = dataclasses.replace(trials[0], fault=f"{files}: together: {broken}")
        return trials

    def _try(self, number, of_page=False):
        began = time.monotonic()
        with self._borrowed_laws() as laws:
            accepted, fault = self._tried(number, laws.page_holds if of_page else laws.hold)
        return Trial(accepted, fault, time.monotonic() - began)

    def _tried(self, number, hold):
        """Returns whether an experiment was accepted, and the fault that it shows, if any. `hold` tries the laws."""
        tables = self._drawn(number)
        file = self._file(number, tables)
        accepted, law = self._broken(tables, file, hold)
        if not law:
            file.unlink()
            return accepted, None
        tables = self._shrunk(tables, kind(law), file, hold, time.monotonic() + SHRINKING)
        _, again = self._broken(tables, file, hold)
        return True, f"{file}: {again or f'{law}; not when it was tried again'}"

    @contextlib.contextmanager
    def _borrowed_laws(self):
        laws = self._free.get()
        try:
            yield laws
        finally:
            self._free.put(laws)

    def _drawn(self, number):
        return Draw(self._operators, random.Random(number), self._device).experiment()

    def _file(self, number, tables):
        """Writes an experiment to its file, and returns that."""
        self._found.mkdir(parents=True, exist_ok=True)
        file = self._found / f"experiment-{number}.toml"
        file.write_text(tomlkit.dumps(tables))
        return file

    @staticmethod
    def _broken(tables, file, hold):
        file.write_text(tomlkit.dumps(tables))
        try:
            return hold(file), None
        except Broken as broken:
            return True, str(broken)

    def _shrunk(self, tables, of_kind, file, hold, end):
        """Returns the experiment without all that can be left out while the law stays broken, as far as that is found
        before `end`."""
        for smaller in without(tables):
            if time.monotonic() >= end:
                break
            _, law = self._broken(smaller, file, hold)
            if law and kind(law) == of_kind:
                return self._shrunk(smaller, of_kind, file, hold, end)
        return tables


def parts_of(numbers, size):
    return [numbers[i : i + size] for i in range(0, len(numbers), size)]


def kind(law):
    """Returns what a message about a broken law says before its particulars."""
    return re.match(r"[^:]*(: exit code -?\d+|: not done)?", law)[0]
