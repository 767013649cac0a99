"""The part that composes experiments at random, and holds the program to the laws of laws.py."""

import json
import random
import subprocess
import time

import tomlkit

from common.command_line import Failure

from .laws import Broken
from .outcomes import Outcome
from .random_experiment import Draw, without

BATCH = 20  # experiments of one outcome


def listed_operators(program):
    """Returns the operators that the program knows, as `evodevo operators --json` lists them."""
    listed = subprocess.run([program, "operators", "--json"], capture_output=True, text=True)
    if listed.returncode != 0:
        raise Failure(f"{program} operators: {listed.stderr.strip()}")
    return json.loads(listed.stdout)


class Experiments:
    """Each experiment follows from its number, which goes on from sitting to sitting. One that breaks a law is made as
    small as it can be while that law stays broken, and kept in DIR/found."""

    name = "experiments"

    def __init__(self, operators, laws, folder):
        self._operators, self._laws = operators, laws
        self._found = folder.resolve() / "found"

    def sitting(self, seconds, past):
        number = sum(each.tried for each in past)
        end = time.monotonic() + seconds
        while True:  # at least one, however little time there is
            began, counts, found = time.monotonic(), {"runs": 0, "refused by check": 0}, []
            for number in range(number, number + BATCH):
                accepted, fault = self._try(number)
                counts["runs" if accepted else "refused by check"] += 1
                found += [fault] * bool(fault)
                if time.monotonic() >= end:
                    break
            number += 1
            spent = (time.monotonic() - began) / sum(counts.values())
            for case, tried in counts.items():
                yield Outcome(self.name, case, tried, tuple(found) if case == "runs" else (), spent * tried)
            if time.monotonic() >= end:
                return

    def _try(self, number):
        """Returns whether an experiment was accepted, and the fault that it shows, if any."""
        tables = Draw(self._operators, random.Random(number)).experiment()
        self._found.mkdir(parents=True, exist_ok=True)
        file = self._found / f"experiment-{number}.toml"
        accepted, law = self._broken(tables, file)
        if not law:
            file.unlink()
            return accepted, None
        tables = self._shrunk(tables, kind(law), file)
        _, law = self._broken(tables, file)
        return True, f"{file}: {law}"

    def _broken(self, tables, file):
        file.write_text(tomlkit.dumps(tables))
        try:
            return self._laws.hold(file), None
        except Broken as broken:
            return True, str(broken)

    def _shrunk(self, tables, of_kind, file):
        """Returns the experiment without all that can be left out while the law stays broken."""
        for smaller in without(tables):
            _, law = self._broken(smaller, file)
            if law and kind(law) == of_kind:
                return self._shrunk(smaller, of_kind, file)
        return tables


def kind(law):
    """Returns what a message about a broken law says before its particulars."""
    return law.partition(":")[0]
