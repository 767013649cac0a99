"""The laws that hold for every experiment that `evodevo check` accepts."""

import contextlib
import json
import math
import pathlib
import shutil
import signal
import sqlite3
import subprocess

STOPPED = 130  # exit code of a run that was asked to stop
NOT_COMPARED = ("record", "provenances", "operators", "files")  # tables that tell where and how a run was made
OTHERWISE = {"generations": ("wall_time",), "individuals": ("provenance",)}  # columns that do, too


class Broken(Exception):
    """A law that does not hold, with what shows it."""


class Laws:
    """Tries experiments with a program, in a folder whose content it removes. A command that takes more than `seconds`
    breaks a law, too."""

    def __init__(self, program, folder, seconds=60):
        self._program, self._folder, self._seconds = program, folder, seconds

    def hold(self, file):
        """Returns whether the program accepts the experiment in a file; raises Broken if it does, and a law does not
        hold, or if the program refuses it in any way but with a message."""
        shutil.rmtree(self._folder, ignore_errors=True)
        self._folder.mkdir(parents=True)
        checked = self._evodevo("check", file)
        if checked.returncode == 2 and str(file) in checked.stderr:
            return False
        require(checked, "check")
        one, three, parts = (self._folder / name for name in ("one", "three", "parts"))
        require(self._evodevo("run", file, *made(one, 1)), "run")
        self._makes_sense(one)
        require(self._evodevo("run", file, *made(three, 3)), "run --threads 3")
        same_rows(one, three, "with 3 threads instead of 1")
        self.run_in_parts(file, parts)
        same_rows(one, parts, "with an interruption")
        return True

    def _evodevo(self, *words):
        command = [self._program, *map(str, words)]
        try:
            return subprocess.run(command, capture_output=True, text=True, timeout=self._seconds, stdin=subprocess.DEVNULL)
        except subprocess.TimeoutExpired:
            raise Broken(f"{words[0]}: not done after {self._seconds} s") from None

    def run_in_parts(self, file, folder):
        """Makes the run, asks it to stop after the first generation, and resumes it."""
        command = [self._program, "run", file, *made(folder, 1)]
        with subprocess.Popen([*map(str, command)], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as run:
            next((line for line in run.stdout if line.startswith("generation ")), None)
            run.send_signal(signal.SIGINT)
            try:
                run.communicate(timeout=self._seconds)
            except subprocess.TimeoutExpired:
                run.kill()
                raise Broken(f"run, interrupted: not done after {self._seconds} s") from None
        if run.returncode not in (0, STOPPED):
            raise Broken(f"run, interrupted: exit code {run.returncode}")
        if run.returncode == STOPPED:
            require(self._evodevo("resume", folder, "--no-report"), "resume")

    def _makes_sense(self, folder):
        shown = self._evodevo("show", folder, "--json")
        require(shown, "show")
        with contextlib.closing(sqlite3.connect(folder / "run.sqlite")) as run:
            for table in ("scores", "measured", "tests", "notes"):
                for (value,) in run.execute(f"SELECT value FROM {table}"):
                    if not math.isfinite(value):
                        raise Broken(f"{table}: {value} is not finite")
            statuses = {status for (status,) in run.execute("SELECT DISTINCT status FROM individuals")}
        if not statuses <= {"ok", "invalid", "diverged", "artefact", "passive"}:
            raise Broken(f"statuses: {statuses}")
        self._is_replayed(json.loads(shown.stdout)["best"])

    @staticmethod
    def _is_replayed(best):
        """The best robot, simulated again as it was, has the same score to the last bit."""
        verification = best and best["verification"]
        for trial in verification["trials"] if verification else ():
            if trial["trial"] == "again" and trial["value"] != verification["fitness"]:
                raise Broken(f"verification: again {trial['value']}, was {verification['fitness']}")


def made(folder, threads):
    return ["--out", folder, "--threads", threads, "--no-report"]


def require(done, what):
    if done.returncode != 0:
        last = " / ".join((done.stderr or done.stdout).strip().splitlines()[-2:])
        raise Broken(f"{what}: exit code {done.returncode}: {last}")


def rows_of(folder):
    """Returns all that a run has found out, by table."""
    with contextlib.closing(sqlite3.connect(pathlib.Path(folder) / "run.sqlite")) as run:
        names = [name for (name,) in run.execute("SELECT name FROM sqlite_master WHERE type = 'table' ORDER BY name")]
        rows = {}
        for name in names:
            columns = [column for _, column, *_ in run.execute(f"PRAGMA table_info({name})")]
            kept = [column for column in columns if column not in OTHERWISE.get(name, ())]
            if name not in NOT_COMPARED and not name.startswith("sqlite_"):
                rows[name] = sorted(run.execute(f"SELECT {', '.join(kept)} FROM {name}"), key=repr)
        return rows


def same_rows(one, other, how):
    first, second = rows_of(one), rows_of(other)
    for table in first:
        if first[table] != second[table]:
            pairs = zip(first[table], second[table])
            a, b = next((pair for pair in pairs if pair[0] != pair[1]), (len(first[table]), len(second[table])))
            raise Broken(f"{how}: {table} differs: {str(a)[:200]} and {str(b)[:200]}")
