"""The parts that simulate random bodies, most of which no experiment would make, with the program hostile_bodies
(tests/hostile): as many as time allows, and few of each kind under compute-sanitizer."""

import collections
import concurrent.futures
import itertools
import json
import os
import select
import shutil
import signal
import subprocess
import time

from .outcomes import Outcome, name_on_device

BODIES = {"cpu": 256, "cuda": 8192}  # in a batch; more on a GPU, because each batch needs kernels that must be compiled
BATCHES = 24  # of one process: each method in both precisions, with tame bodies and with others
SECONDS = 120  # without a word, after which a process hangs
KEPT = 60  # s of outcomes that become one
# processes on a GPU: of 16 on an H200, some failed; and of 20 on four H200s, each waited for minutes, since the driver lets
# processes make their contexts one after another
AT_ONCE = 8
SANITIZERS = ("memcheck", "racecheck", "initcheck", "synccheck")
FORMS = 96  # batches after which each kind has been there
SANITIZED = 6  # bodies in a batch under a sanitizer
FAULTY = 9  # exit code of a sanitizer that found something


class Bodies:
    """Batches follow from their numbers, which go on from sitting to sitting."""

    def __init__(self, program, device, seconds=SECONDS):
        self.name = name_on_device("bodies", device)
        self._program, self._device, self._seconds = program, device, seconds
        self._bodies = BODIES[device]

    def sitting(self, seconds, past):
        if not self._program.exists():
            yield Outcome(self.name, f"left out, since {obstacle(self._program)}", 0, (), 0)
            return
        end, jobs = time.monotonic() + seconds, processes(self._device)
        first = itertools.count(sum(each.tried for each in past) // self._bodies, BATCHES)
        with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
            told, kept = time.monotonic(), []
            while True:  # at least once, however little time there is
                for outcomes in pool.map(self._try, itertools.islice(first, jobs)):
                    kept += outcomes
                now = time.monotonic()
                if now >= min(end, told + KEPT):
                    yield from merged(kept)
                    told, kept = now, []
                if now >= end:
                    return

    def _try(self, first):
        """Returns the outcomes of some batches. After a batch with which the program does not end well, it goes on with
        the next one."""
        outcomes, end = [], first + BATCHES
        while first < end:
            began = time.monotonic()
            told, fault = output([self._program, self._device, first, end - first, self._bodies], self._seconds)
            results = results_in(told)
            if fault:
                found = [f"{fault}{first_complaint(told)}"]
                batch = first + len(results)
                results.append({"batch": batch, "what": "not done", "tried": self._bodies, "found": found})
            spent = (time.monotonic() - began) / max(1, len(results))
            for each in results:
                found = tuple(f"{self._command(each['batch'])}: {fault}" for fault in each["found"])
                outcomes.append(Outcome(self.name, each["what"], each["tried"], found, spent))
            first += max(1, len(results))
        return outcomes

    def _command(self, batch):
        return f"{self._program.name} {self._device} {batch} 1 {self._bodies}"


class Sanitizers:
    """Few bodies of each kind, under each tool of compute-sanitizer. What does not end in time is named."""

    name = "sanitizers"

    def __init__(self, program, device, seconds=SECONDS):
        self._program, self._device, self._seconds = program, device, seconds

    def sitting(self, seconds, past):
        missing = None if shutil.which("compute-sanitizer") else "there is no compute-sanitizer"
        if missing or not self._program.exists():
            yield Outcome(self.name, f"left out, since {missing or obstacle(self._program)}", 0, (), 0)
            return
        end, jobs = time.monotonic() + seconds, processes(self._device)
        tried = collections.Counter()
        for each in past:
            tried[each.case] += each.tried // SANITIZED
        cases = sorted(itertools.product(SANITIZERS, range(FORMS)), key=lambda case: case[1])
        waiting = [case for case in cases if case[1] >= tried[case[0]]]
        with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
            for some in (waiting[i : i + jobs] for i in range(0, len(waiting), jobs)):
                yield from pool.map(self._try, some)
                if time.monotonic() >= end:
                    return

    def _try(self, case):
        tool, batch = case
        began = time.monotonic()
        words = [self._program, self._device, batch, 1, SANITIZED]
        sanitizer = ["compute-sanitizer", "--tool", tool, "--error-exitcode", FAULTY]
        told, fault = output([*sanitizer, *words], self._seconds)
        results = results_in(told)
        found = [each for result in results for each in result["found"]]
        if fault or not results:
            found.append(f"{fault or 'no result'}{first_complaint(told)}")
        named = tuple(f"{tool}: {self._program.name} {self._device} {batch} 1 {SANITIZED}: {each}" for each in found)
        return Outcome(self.name, tool, SANITIZED, named, time.monotonic() - began)


def merged(outcomes):
    """Returns one outcome for each case."""
    by_case = {}
    for each in outcomes:
        by_case.setdefault(each.case, []).append(each)
    return [
        Outcome(
            group[0].part,
            case,
            sum(each.tried for each in group),
            tuple(fault for each in group for fault in each.found),
            sum(each.seconds for each in group),
        )
        for case, group in by_case.items()
    ]


def processes(device):
    """Returns how many processes simulate at once."""
    cores = os.cpu_count() or 1
    return cores if device == "cpu" else min(cores, AT_ONCE)


def obstacle(program):
    return f"there is no {program}; configure with -D EVODEVO_TESTS=ON and build the target {program.name}"


def output(command, seconds):
    """Returns what a command prints, and why it did not end well, or None. A command that prints nothing for so many
    seconds is ended, with the programs that it runs."""
    pipes = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.STDOUT}
    with subprocess.Popen([*map(str, command)], **pipes, process_group=0) as process:
        told = b""
        while select.select([process.stdout], [], [], seconds)[0]:
            some = os.read(process.stdout.fileno(), 1 << 16)
            if not some:
                process.wait()
                fault = f"exit code {process.returncode}" if process.returncode else None
                return told.decode(errors="replace"), fault
            told += some
        os.killpg(process.pid, signal.SIGKILL)
        return told.decode(errors="replace"), f"not done after {seconds} s"


def results_in(told):
    """Returns the result of each batch that the program tells, of which it may not have told the last one to the end."""
    return [json.loads(line) for line in told.splitlines() if line.startswith("{") and line.endswith("}")]


def first_complaint(told):
    """Returns the first line of a sanitizer that says what is wrong, or the first line of the program."""
    lines = [line.strip("= ") for line in told.splitlines() if line.strip("= ") and not line.startswith("{")]
    complaints = [line for line in lines if not line.startswith("COMPUTE-SANITIZER")]
    return f": {complaints[0]}" if complaints else ""
