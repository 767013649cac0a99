"""The laws that hold for every experiment that `evodevo check` accepts."""

import contextlib
import itertools
import json
import math
import pathlib
import shutil
import signal
import sqlite3
import subprocess
import threading
import tomllib

from common.command_line import NO_FITNESS, STOPPED

from .amounts import CONTROLS, are_changed_alike, first_robots, keeps_amounts
from .calls import RANKS, Broken, Program, obstacle_to_ranks, require
from .rounding import moves_as_in_double
from .run_page import Page

NOT_COMPARED = ("record", "provenances", "operators", "files")  # tables that tell where and how a run was made
OTHERWISE = {"generations": ("wall_time",), "individuals": ("provenance",)}  # columns that do, too


class Laws:
    """Tries experiments with a program, in a folder whose content it removes. A command that takes more than `seconds`
    breaks a law, too. The laws that need other programs or another build are `left_out`, each with the reason. `built`
    is the folder where the program was built or installed."""

    def __init__(self, program, folder, seconds=60, built=None):
        built = built or pathlib.Path(program).parent.parent
        self._evodevo, self._folder = Program(program, seconds), folder
        self._page = Page(built)
        self.left_out = {}
        if obstacle := obstacle_to_ranks(built):
            self.left_out["3 ranks"] = obstacle
        if self._page.obstacle:
            self.left_out["pages"] = self._page.obstacle

    def hold(self, file):
        """Returns whether the program accepts the experiment in a file; raises Broken if it does, and a law does not
        hold, or if the program refuses it in any way but with a message."""
        self._empty()
        if not self._is_accepted(file):
            return False
        one, three, parts = (self._folder / name for name in ("one", "three", "parts"))
        require(self._evodevo("run", file, *made(one, 1)), "run")
        best = self._makes_sense(one)
        require(self._evodevo("run", file, *made(three, 3)), "run --threads 3")
        same_rows(one, three, "with 3 threads instead of 1")
        self._is_same_beside_another(file, one)
        self.run_in_parts(file, parts)
        same_rows(one, parts, "with an interruption")
        if "3 ranks" not in self.left_out:
            self._is_same_with_ranks(file, one)
        if develops(file):
            keeps_amounts(self._evodevo, file, self._folder)
        if best:
            moves_as_in_double(self._evodevo, file, one, best["individual"], self._folder)
        return True

    def hold_together(self, files):
        """Like hold() for each of some experiments, in few processes, for devices on which a process starts slowly. The
        runs are made in one process, so only the first experiment that is accepted is run alone and with 3 ranks."""
        accepted = [self._is_accepted(file) for file in files]
        held = [*itertools.compress(files, accepted)]
        if held:
            self.hold(held[0])
        if held[1:]:
            self._hold_in_one_process(held[1:])
        return accepted

    def _hold_in_one_process(self, files):
        self._empty()
        folders = {file: self._folder / file.stem for file in files}
        self._make([[file, *made(folder / "one", 1)] for file, folder in folders.items()], "run")
        best = {file: self._makes_sense(folder / "one") for file, folder in folders.items()}
        otherwise = [[file, *made(folder / "three", 3)] for file, folder in folders.items()]
        for file, folder in folders.items():
            otherwise += [first_robots(file, folder, control) for control in CONTROLS if develops(file)]
        self._make(otherwise, "run --threads 3")
        self._make_in_parts([[file, *made(folder / "parts", 1), "--resume"] for file, folder in folders.items()])
        for file, folder in folders.items():
            same_rows(folder / "one", folder / "three", "with 3 threads instead of 1")
            same_rows(folder / "one", folder / "parts", "with an interruption")
            if develops(file):
                are_changed_alike(self._evodevo, folder)
            if best[file]:
                moves_as_in_double(self._evodevo, file, folder / "one", best[file]["individual"], folder)

    def page_holds(self, file):
        """Like hold(), for the law that the page of a run opens in a browser without a complaint."""
        self._empty()
        if not self._is_accepted(file):
            return False
        run, page = self._folder / "one", self._folder / "page.html"
        require(self._evodevo("run", file, *made(run, 1)), "run")
        require(self._evodevo("report", run, "--out", page), "report")
        self._page.opens(page)
        return True

    def _empty(self):
        shutil.rmtree(self._folder, ignore_errors=True)
        self._folder.mkdir(parents=True)

    def _is_accepted(self, file):
        checked = self._evodevo("check", file)
        if checked.returncode == 2 and str(file) in checked.stderr:
            return False
        require(checked, "check")
        return True

    def _is_same_beside_another(self, file, one):
        """Makes the run in a process that makes another one at the same time."""
        beside = self._folder / "beside"
        self._make([[file, *made(beside, 2)], [file, *made(self._folder / "another", 1), "--seed", 2]], "run-many")
        same_rows(one, beside, "beside another run")

    def _make(self, runs, what):
        """Makes runs at the same time in one process. `runs` are the arguments of `run`."""
        many = Program(self._evodevo.path, self._evodevo.seconds * len(runs))
        require(many(*self._run_many(runs)), f"{what}, {len(runs)} runs in one process")

    def _run_many(self, runs):
        lines = self._folder / "runs.jsonl"
        lines.write_text("".join(json.dumps([*map(str, words)]) + "\n" for words in runs))
        return "run-many", lines, "--jobs", len(runs)

    def _is_same_with_ranks(self, file, one):
        ranks = self._folder / "ranks"
        require(self._evodevo("run", file, *made(ranks, 1), under=(*RANKS, 3)), "run with 3 ranks")
        same_rows(one, ranks, "with 3 ranks instead of 1")

    def run_in_parts(self, file, folder):
        """Makes the run, asks it to stop after the first generation, and resumes it."""
        if self._is_stopped(("run", file, *made(folder, 1)), "generation ", self._evodevo.seconds):
            require(self._evodevo("resume", folder, "--no-report"), "resume")

    def _make_in_parts(self, runs):
        """Makes runs at the same time in one process, asks them to stop when one is done, and resumes them."""
        if self._is_stopped(self._run_many(runs), "", self._evodevo.seconds * len(runs)):
            self._make(runs, "resume")

    def _is_stopped(self, words, line, seconds):
        """Asks a command to stop when it prints a line that begins with `line`; returns whether it did before it was
        done."""
        command = [self._evodevo.path, *words]
        with subprocess.Popen([*map(str, command)], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as run:
            end = threading.Timer(seconds, run.kill)
            end.start()
            next((each for each in run.stdout if each.startswith(line)), None)
            run.send_signal(signal.SIGINT)
            run.communicate()
            end.cancel()
        if run.returncode == -signal.SIGKILL:
            raise Broken(f"{words[0]}, interrupted: not done after {seconds} s")
        if run.returncode not in (0, NO_FITNESS, STOPPED):
            raise Broken(f"{words[0]}, interrupted: exit code {run.returncode}")
        return run.returncode == STOPPED

    def _makes_sense(self, folder):
        """Returns the best robot; None if there is none."""
        best = json.loads(self._evodevo.output("show", folder, "--json"))["best"]
        with contextlib.closing(sqlite3.connect(folder / "run.sqlite")) as run:
            for table in ("scores", "measured", "life_scores", "tests", "notes"):
                for (value,) in run.execute(f"SELECT value FROM {table}"):
                    if not math.isfinite(value):
                        raise Broken(f"{table}: {value} is not finite")
            statuses = {status for (status,) in run.execute("SELECT DISTINCT status FROM individuals")}
        if not statuses <= {"ok", "invalid", "diverged", "artefact", "lucky", "passive"}:
            raise Broken(f"statuses: {statuses}")
        self._is_replayed(best)
        return best

    @staticmethod
    def _is_replayed(best):
        """The best robot, simulated again as it was, has the same score to the last bit."""
        verification = best and best["verification"]
        for trial in verification["trials"] if verification else ():
            if trial["trial"] == "again" and trial["value"] != verification["fitness"]:
                raise Broken(f"verification: again {trial['value']}, was {verification['fitness']}")


def made(folder, threads):
    return ["--out", folder, "--threads", threads, "--no-report"]


def develops(file):
    """Returns whether an experiment has operators that develop bodies."""
    development = tomllib.loads(file.read_text()).get("development", {})
    return development.get("cycles", 0) > 0 and bool(development.get("operator"))


def rows_of(folder):
    """Returns all that a run has found out, by table."""
    file = pathlib.Path(folder) / "run.sqlite"
    if not file.is_file():
        raise Broken(f"there is no {file}")
    with contextlib.closing(sqlite3.connect(file)) as run:
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
    if first.keys() != second.keys():
        raise Broken(f"{how}: the tables differ: {sorted(first)} and {sorted(second)}")
    for table in first:
        if first[table] != second[table]:
            pairs = zip(first[table], second[table])
            a, b = next((pair for pair in pairs if pair[0] != pair[1]), (len(first[table]), len(second[table])))
            raise Broken(f"{how}: {table} differs: {str(a)[:200]} and {str(b)[:200]}")
