"""The part that composes experiments at random, and holds the program to the laws of laws.py."""

import concurrent.futures
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

BATCH = 20  # experiments of one outcome, of whose first run the page is opened
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
    are `laws`, each of which tries one."""

    def __init__(self, operators, laws, folder, device="cpu"):
        self.name = name_on_device("experiments", device)
        self._operators, self._jobs, self._device = operators, len(laws), device
        self._left_out = laws[0].left_out
        self._free = queue.SimpleQueue()
        for each in laws:
            self._free.put(each)
        self._found = folder.resolve() / "found"

    def sitting(self, seconds, past):
        first = sum(each.tried for each in past if each.case in EXPERIMENTS)
        end = time.monotonic() + seconds

        def tried_in_time(number):  # at least one, however little time there is
            return self._try(number) if number == first or time.monotonic() < end else None

        for law, reason in self._left_out.items():
            yield Outcome(self.name, f"{law}: left out, since {reason}", 0, (), 0)
        with concurrent.futures.ThreadPoolExecutor(self._jobs) as pool:
            for begin in itertools.count(first, BATCH):
                numbers = range(begin, begin + BATCH)
                yield from self._counted([*filter(None, pool.map(tried_in_time, numbers))])
                if time.monotonic() >= end:
                    return
                if "pages" not in self._left_out:
                    yield from self._page(numbers)

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

    def _try(self, number, of_page=False):
        began = time.monotonic()
        laws = self._free.get()
        try:
            accepted, fault = self._tried(number, laws.page_holds if of_page else laws.hold)
        finally:
            self._free.put(laws)
        return Trial(accepted, fault, time.monotonic() - began)

    def _tried(self, number, hold):
        """Returns whether an experiment was accepted, and the fault that it shows, if any. `hold` tries the laws."""
        tables = Draw(self._operators, random.Random(number), self._device).experiment()
        self._found.mkdir(parents=True, exist_ok=True)
        file = self._found / f"experiment-{number}.toml"
        accepted, law = self._broken(tables, file, hold)
        if not law:
            file.unlink()
            return accepted, None
        tables = self._shrunk(tables, kind(law), file, hold, time.monotonic() + SHRINKING)
        _, again = self._broken(tables, file, hold)
        return True, f"{file}: {again or f'{law}; not when it was tried again'}"

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


def kind(law):
    """Returns what a message about a broken law says before its particulars."""
    return re.match(r"[^:]*(: exit code -?\d+|: not done)?", law)[0]
