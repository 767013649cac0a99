"""The part that lets libFuzzer make inputs for the targets in tests/fuzz."""

import concurrent.futures
import os
import pathlib
import re
import subprocess
import tempfile
import time

from common.command_line import Failure

from .outcomes import Outcome

CORPUS = pathlib.Path(__file__).resolve().parents[3] / "tests" / "fuzz" / "corpus"
MEGABYTES = 2048  # of memory of a target, and
SECONDS = 10  # of an input, beyond which it counts as a fault
# in what is said of a fault: quoted texts, the names of temporary folders, addresses, and numbers other than those of
# lines and columns; without them, the same is said of the same fault
PARTICULARS = re.compile(r'".*?"|\bevodevo-fuzz-\w+|(?<!\+)\b0x[0-9a-f]+|(?<![:\w])\d[\d.]*')
OF_WORDS = ("experiment",)  # targets to which the names of operators and parameters are given


class Fuzz:
    """Runs each program fuzz_TARGET in a folder for an equal time, on as many cores as there are. Inputs that reach new
    code go to DIR/corpus/TARGET, from where the next sitting goes on, and those that show a fault to DIR/found, one for
    each fault. After a fault, libFuzzer starts the program again, as long as there is time."""

    name = "fuzz"

    def __init__(self, built, operators, folder):
        """`built`: builds the programs, and returns their folder; called when a sitting begins."""
        self._built = built
        self._folder = folder.resolve()
        self._words = dictionary(operators)

    def sitting(self, seconds, past):
        folder = self._built()
        programs = sorted(folder.glob("fuzz_*"))
        if not programs:
            raise Failure(f"{folder}: there is no program fuzz_TARGET; build the target fuzz_targets")
        cores, count = os.cpu_count() or 1, len(programs)
        at_once = min(cores, count)
        each = max(1, round(seconds * at_once / count))
        with concurrent.futures.ThreadPoolExecutor(at_once) as pool:
            yield from pool.map(lambda program: self._run(program, each, cores // at_once), programs)

    def _run(self, program, seconds, processes):
        target = program.name.removeprefix("fuzz_")
        corpus, found = self._folder / "corpus" / target, self._folder / "found"
        for folder in (corpus, found):
            folder.mkdir(parents=True, exist_ok=True)
        before = set(found.glob(f"{target}-*"))
        began = time.monotonic()
        log = self._made_inputs(program, seconds, processes, corpus, found / f"{target}-")
        spent = processes * (time.monotonic() - began)
        faults = self._distinct_faults(program, set(found.glob(f"{target}-*")) - before)
        tried, covered = counts(log)
        if not faults and tried == 0:
            raise Failure(f"{program} made no inputs; it says: {' '.join(log.split())[-500:]}")
        return Outcome(self.name, target, tried, tuple(f"{file}: {fault}" for file, fault in faults), spent, covered)

    def _made_inputs(self, program, seconds, processes, corpus, prefix):
        """Lets libFuzzer make inputs in so many processes, and returns what it says."""
        target = program.name.removeprefix("fuzz_")
        options = [
            f"-fork={processes}",
            "-ignore_crashes=1",
            "-ignore_timeouts=1",
            "-ignore_ooms=1",
            f"-max_total_time={seconds}",
            f"-artifact_prefix={prefix}",
        ]
        if target in OF_WORDS:
            words = self._folder / "words"
            words.write_text(self._words)
            options.append(f"-dict={words}")
        return output(program, *options, corpus, CORPUS / target)

    @staticmethod
    def _distinct_faults(program, files):
        """Returns each fault with the smallest of the files that show it, and removes the other files."""
        faults = {}
        for file in sorted(files, key=lambda each: (each.stat().st_size, each)):
            said = fault(output(program, file))
            if faults.setdefault(PARTICULARS.sub("", said), (file, said))[0] != file:
                file.unlink()
        return sorted(faults.values())


def output(program, *words):
    """Returns what a program of libFuzzer says."""
    with tempfile.TemporaryDirectory(prefix="evodevo-fuzz-") as scratch:  # where programs that crash leave files
        ended = subprocess.run(
            [program, f"-rss_limit_mb={MEGABYTES}", f"-timeout={SECONDS}", *words],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            env={**os.environ, "TMPDIR": scratch},
            cwd=scratch,
        )
    return ended.stdout.decode(errors="replace")


def dictionary(operators):
    """Returns the names of operators, of their parameters and of options, in the form of libFuzzer's dictionaries."""
    words = {each["name"] for each in operators}
    for parameter in (parameter for each in operators for parameter in each["parameters"]):
        words.add(parameter["name"])
        if parameter["type"] == "option":
            words.update(re.findall('"(.*?)"', parameter["allowed"]))
    return "".join(f'"{word}"\n' for word in sorted(words))


def counts(log):
    """Returns how many inputs libFuzzer has tried, and how many edges they covered."""
    lines = re.findall(r"^#(\d+): cov: (\d+) ", log, re.MULTILINE)
    return (int(lines[-1][0]), int(lines[-1][1])) if lines else (0, None)


def fault(log):
    """Returns the line that says what is wrong: that of a law that does not hold, that of an exception that nobody
    catches, or that of a sanitizer."""
    for pattern in (r"^fault: (.*)$", r"^ +what\(\): +(.*)$", r"^.*runtime error: .*$", r"^SUMMARY: (.*)$"):
        if said := re.search(pattern, log, re.MULTILINE):
            return said[said.lastindex or 0]
    return "it is not shown again"
