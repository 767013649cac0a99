"""The part that lets a run of tiny robots go on from sitting to sitting, and watches what it holds."""

import csv
import dataclasses
import os
import pathlib
import signal
import subprocess
import tempfile
import threading
import time

from common.command_line import NO_FITNESS, STOPPED

from .outcomes import Outcome

EXPERIMENT = """\
[experiment]
evaluations = 1_000_000_000
population = 6
random_individuals = 1
verify_front = "trials"

[encoding]
name = "voxel"
size = [2, 1, 1]
edge = 0.5

[[mutation]]
name = "reset-weight"

[[crossover]]
name = "two-point"

[scene.gravity]
[scene.floor]
[scene.friction]
[scene.damping]

[simulation]
device = "cpu"
threads = 2

[development]
cycles = 1
cycle_time = 0.01

[[development.operator]]
name = "spring-turnover"
springs = 1

[[fitness]]
name = "distance"
settle = 0.01
window = 0.02

[selection]
name = "age-fitness-pareto"
"""
PATIENCE = 60  # s that a run may take to end after it was asked to
MEBIBYTE = 1 << 20
SLACK = {"memory": 4 * MEBIBYTE, "files": 0, "threads": 0}  # by which what a process holds may grow
ARCHIVE_SLACK = 8 * MEBIBYTE  # how much larger than by linear growth an archive may be
LEAST = 40  # samples, with fewer of which nothing is said about growth


@dataclasses.dataclass(frozen=True)
class Sample:
    """What a run held after a generation."""

    sitting: int
    generation: int
    memory: int  # bytes in RAM
    files: int
    threads: int
    archive: int  # bytes on disk


class Soak:
    """The run goes on from sitting to sitting, each of which is a process of its own. Memory, files and threads of a
    process must not grow after the first quarter of a sitting, and the archive must grow by the same amount with each
    generation. All samples are in DIR/soak/samples.csv."""

    name = "soak"

    def __init__(self, program, folder, pause=0.2):
        self._program, self._pause = program, pause  # s between samples
        self._folder = folder.resolve() / "soak"

    def sitting(self, seconds, past):
        self._folder.mkdir(parents=True, exist_ok=True)
        earlier, began = self._read(), time.monotonic()
        samples, generations, fault = self._watched(seconds, len(past))
        self._write(earlier + samples)
        faults = [fault] if fault else [*held(samples), *archived(earlier + samples)]
        found = tuple(f"{self._folder / 'samples.csv'}: {each}" for each in faults)
        yield Outcome(self.name, "generations", generations, found, time.monotonic() - began)

    def _watched(self, seconds, sitting):
        """Lets the run go on for some time from its first generation on; returns samples, the number of generations, and
        what went wrong, if anything did."""
        samples, generations = [], 0
        with tempfile.TemporaryFile("w+") as said:
            options = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": said, "text": True}
            run = subprocess.Popen(self._command(), **options)
            stop = threading.Timer(seconds, run.send_signal, [signal.SIGINT])
            kill = threading.Timer(seconds + PATIENCE, run.kill)
            try:
                kill.start()
                last = -self._pause
                for line in run.stdout:
                    if not line.startswith("generation "):
                        continue
                    generations += 1
                    if generations == 1:
                        stop.start()
                    if time.monotonic() - last >= self._pause:
                        samples += self._sample(sitting, int(line.split()[1]), run.pid)
                        last = time.monotonic()
                code = run.wait()
            finally:
                stop.cancel()
                kill.cancel()
                run.kill()
                run.stdout.close()
                run.wait()
            said.seek(0)
            end = " / ".join(said.read().strip().splitlines()[-2:])
        fault = None if code in (0, NO_FITNESS, STOPPED) else f"exit code {code}: {end}"
        return samples[:-1], generations, fault  # the last sample may be of a process that was already giving back

    def _command(self):
        run = self._folder / "run"
        if (run / "run.sqlite").exists():
            return [self._program, "resume", run, "--no-report"]
        experiment = self._folder / "tiny.toml"
        experiment.write_text(EXPERIMENT)
        return [self._program, "run", experiment, "--out", run, "--no-report"]

    def _sample(self, sitting, generation, process):
        """Returns a sample, or none if the process has ended."""
        taken = pathlib.Path("/proc") / str(process)
        try:
            pages = int((taken / "statm").read_text().split()[1])
            files, threads = (len(os.listdir(taken / name)) for name in ("fd", "task"))
            archive = sum(file.stat().st_size for file in (self._folder / "run").glob("run.sqlite*"))
        except (FileNotFoundError, ProcessLookupError, PermissionError):
            return []
        return [Sample(sitting, generation, pages * os.sysconf("SC_PAGE_SIZE"), files, threads, archive)] if pages else []

    def _read(self):
        file = self._folder / "samples.csv"
        if not file.exists():
            return []
        with file.open(newline="") as rows:
            return [Sample(**{name: int(value) for name, value in row.items()}) for row in csv.DictReader(rows)]

    def _write(self, samples):
        with (self._folder / "samples.csv").open("w", newline="") as rows:
            table = csv.DictWriter(rows, [field.name for field in dataclasses.fields(Sample)])
            table.writeheader()
            table.writerows(map(dataclasses.asdict, samples))


def held(samples):
    """Yields what has grown in one process, which was never as low in the last quarter of the samples as in the second.
    In the first quarter, the process warms up."""
    if len(samples) < LEAST:
        return
    quarter = len(samples) // 4
    early, late = samples[quarter : 2 * quarter], samples[-quarter:]
    for name, slack in SLACK.items():
        most, least = max(getattr(each, name) for each in early), min(getattr(each, name) for each in late)
        if least > most + slack:
            between = f"between generations {early[-1].generation} and {late[0].generation}"
            yield f"{name} grew from {most:,} to {least:,} {between}"


def archived(samples):
    """Yields that the archive grows faster than in proportion to the generations, if it does."""
    if len(samples) < LEAST:
        return
    first, last = samples[0], samples[-1]
    half = min(samples, key=lambda each: abs(2 * each.generation - first.generation - last.generation))
    growth = lambda a, b: (b.archive - a.archive) / max(1, b.generation - a.generation)
    earlier, later = growth(first, half), growth(half, last)
    if (later - earlier) * (last.generation - half.generation) > ARCHIVE_SLACK:
        yield (f"archive grew by {earlier:,.0f} bytes with each generation up to {half.generation}, "
               f"and by {later:,.0f} up to {last.generation}")  # fmt: skip
