"""The part that lets libFuzzer make inputs for the targets in tests/fuzz."""

import pathlib
import re
import subprocess
import time

from common.command_line import Failure

from .outcomes import Outcome

CORPUS = pathlib.Path(__file__).resolve().parents[3] / "tests" / "fuzz" / "corpus"
MEGABYTES = 2048  # of memory of a target, and
SECONDS = 10  # of an input, beyond which it counts as a fault


class Fuzz:
    """Runs each program fuzz_TARGET in a folder for an equal time. Inputs that reach new code go to DIR/corpus/TARGET,
    from where the next sitting goes on, and those that show a fault to DIR/found."""

    name = "fuzz"

    def __init__(self, programs, folder):
        self._programs = sorted(programs.glob("fuzz_*"))
        self._folder = folder.resolve()
        if not self._programs:
            raise Failure(f"{programs}: there is no program fuzz_TARGET; build the target fuzz_targets")

    def sitting(self, seconds, past):
        for program in self._programs:
            yield self._run(program, max(1, round(seconds / len(self._programs))))

    def _run(self, program, seconds):
        target = program.name.removeprefix("fuzz_")
        corpus, found = self._folder / "corpus" / target, self._folder / "found"
        for folder in (corpus, found):
            folder.mkdir(parents=True, exist_ok=True)
        before = set(found.iterdir())
        began = time.monotonic()
        log = self._output(program, seconds, corpus, found / f"{target}-")
        spent = time.monotonic() - began
        faults = sorted(set(found.iterdir()) - before)
        tried, covered = counts(log)
        if not faults and tried == 0:
            raise Failure(f"{program} made no inputs; it says: {' '.join(log.split())[-500:]}")
        return Outcome(self.name, target, tried, tuple(f"{each}: {fault(log)}" for each in faults), spent, covered)

    def _output(self, program, seconds, corpus, prefix):
        command = [
            program,
            f"-max_total_time={seconds}",
            f"-rss_limit_mb={MEGABYTES}",
            f"-timeout={SECONDS}",
            f"-artifact_prefix={prefix}",
            "-print_final_stats=1",
            corpus,
            CORPUS / program.name.removeprefix("fuzz_"),
        ]
        ended = subprocess.run(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        return ended.stdout.decode(errors="replace")


def counts(log):
    """Returns how many inputs libFuzzer has tried, and how many edges they covered."""
    tried = re.findall(r"^stat::number_of_executed_units: (\d+)$", log, re.MULTILINE)
    covered = re.findall(r" cov: (\d+) ", log)
    return int(tried[-1]) if tried else 0, int(covered[-1]) if covered else None


def fault(log):
    """Returns the line that says what is wrong."""
    said = re.search(r"^SUMMARY: .*$|^.*runtime error: .*$", log, re.MULTILINE)
    return said.group().removeprefix("SUMMARY: ") if said else "the program ended early"
