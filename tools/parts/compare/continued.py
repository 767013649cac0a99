"""Runs that begin with the population of another run, as scripts of studies make them after a comparison."""

import contextlib
import dataclasses
import json
import os
import pathlib
import subprocess
import sys

from . import rows
from .together import run_many

NO_FITNESS = 3  # exit code of a complete run


@dataclasses.dataclass(frozen=True)
class Continuation:
    """A run that begins with the population of another one."""

    name: str
    experiment: str
    settings: tuple
    start: pathlib.Path
    seed: int

    def row(self, out):
        return out / "rows" / f"{self.name}.json"

    def folder(self, out):
        return out / "runs" / self.name

    def arguments(self, out):
        """Returns the arguments of the program, after writing the experiment."""
        file = out / "experiments" / f"{self.name}.toml"
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(self.experiment)
        settings = (*self.settings, f"experiment.start={self.start.resolve()}")
        words = [word for setting in settings for word in ("--set", setting)]
        return [file, *words, "--seed", self.seed, "--out", self.folder(out), "--resume", "--no-report"]


class Program:
    """The program evodevo, of which up to `jobs` processes or runs work at once."""

    def __init__(self, path, jobs, gpus=True):
        self._path, self.jobs, self._gpus = path, jobs, gpus

    def without_gpus(self):
        """Returns the program for commands that simulate a few robots: no GPU is worth its start then, and the contexts
        of many processes fill its memory."""
        return Program(self._path, min(self.jobs, os.cpu_count()), gpus=False)

    def call(self, *words):
        """Returns what a command prints."""
        command = [self._path, *map(str, words)]
        environment = os.environ if self._gpus else os.environ | {"CUDA_VISIBLE_DEVICES": ""}
        return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True, env=environment).stdout

    def json(self, *words):
        """Returns what a command prints, as JSON."""
        return json.loads(self.call(*words))

    def make(self, out, runs):
        """Makes those of the runs that have no row, as far as the runs with which they begin are there."""
        waiting = [run for run in runs if not run.row(out).exists() and run.start.exists()]
        arguments = [run.arguments(out) for run in waiting]
        with contextlib.closing(run_many(self._path, arguments, self.jobs)) as ended:
            for index, code in ended:
                run = waiting[index]
                if code not in (0, NO_FITNESS):
                    sys.exit(f"{run.folder(out)}: the run ended with {code}; see {run.folder(out)}.log")
                rows.write(run.row(out), self.json("show", run.folder(out), "--json"))


class Arm:
    """The runs of one experiment in the folder of a comparison."""

    def __init__(self, folder):
        made_from = json.loads((folder / "made-from.json").read_text())
        self.name, self.experiment, self._settings = folder.name, made_from["experiment"], made_from["set"]
        self._rows = folder
        runs = folder.parents[1] / "runs" / folder.name
        self.runs = [runs / file.stem for file in sorted(folder.glob("seed-*.json"))]

    @property
    def develops(self):
        return "[development]" in self.experiment

    def row(self, run):
        return self._rows / f"{run.name}.json"

    def settings(self, *more):
        return (*self._settings, *more)
