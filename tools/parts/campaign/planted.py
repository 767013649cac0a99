"""The part that plants faults in a copy of the sources, to learn whether the tests notice them."""

import random
import time

from common.command_line import Failure

from .faults import KINDS, faults
from .outcomes import Outcome
from .workshop import DoesNotCompile

FOLDERS = ("framework/", "kernels/", "plugins/", "tools/parts/commands/")
NONE = ("does not compile", "changes no program")  # verdicts on what is no fault


class Planted:
    """Each fault follows from its number, which goes on from sitting to sitting, and from the sources. One that no test
    notices is kept as a difference in DIR/found. One with which a source does not compile, or with which all programs
    are the same to the last byte, does not count, and another takes its place."""

    name = "planted"

    def __init__(self, workshop, folder, count):
        self._workshop, self._count = workshop, count
        self._found, self._log = folder.resolve() / "found", folder / "planted" / "log.txt"

    def sitting(self, _seconds, past):
        self._workshop.open()
        places = self._places()
        number, left = len(past), self._count
        while left > 0:
            outcome = self._try(number, *drawn(places, number))
            yield outcome
            number += 1
            left -= outcome.tried

    def _places(self):
        """Returns all faults that can be planted, each with its file, by kind."""
        places = {kind: [] for kind in KINDS}
        for file in self._workshop.source_files():
            if file.startswith(FOLDERS):
                for fault in faults((self._workshop.sources / file).read_text()):
                    places[fault.kind].append((file, fault))
        if not any(places.values()):
            raise Failure(f"{self._workshop.sources}: no program is made of sources in {', '.join(FOLDERS)}")
        return places

    def _try(self, number, file, fault):
        began = time.monotonic()
        source = self._workshop.sources / file
        text = source.read_text()
        source.write_text(fault.in_text(text))
        try:
            difference, verdict = self._workshop.git("diff"), self._verdict()
        finally:
            self._workshop.restore()
        line = text.count("\n", 0, fault.begin) + 1
        what = f"{file}:{line}: {' '.join(text[fault.begin : fault.end].split())} became {fault.new}"
        with self._log.open("a") as log:
            log.write(f"{number}: {what}: {verdict or 'not noticed'}\n")
        counts = verdict not in NONE
        found = () if verdict else (f"{self._kept(number, difference)}: {what}",)
        return Outcome(self.name, fault.kind if counts else verdict, int(counts), found, time.monotonic() - began)

    def _verdict(self):
        """Returns what has noticed the fault, or why it is none; or None if nothing has noticed it."""
        affected = False
        try:
            for group in self._workshop.groups:
                if self._workshop.affected(group):
                    affected = True
                    if failed := self._workshop.failed(group):
                        return failed
        except DoesNotCompile:
            return NONE[0]
        return None if affected else NONE[1]

    def _kept(self, number, difference):
        self._found.mkdir(parents=True, exist_ok=True)
        file = self._found / f"planted-{number}.diff"
        file.write_text(difference)
        return file


def drawn(places, number):
    """Returns the file and the fault of a number. All kinds are equally likely."""
    generator = random.Random(number)
    return generator.choice(places[generator.choice([kind for kind in KINDS if places[kind]])])
