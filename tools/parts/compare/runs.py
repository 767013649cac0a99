"""The runs of a comparison, and how they are made."""

import collections
import concurrent.futures
import contextlib
import dataclasses
import itertools
import json
import os
import pathlib
import shutil
import sqlite3
import subprocess
import tomllib
import urllib.parse

from common.command_line import NO_FITNESS, STOPPED, Failure

from . import rows
from .islands import as_one
from .together import run_many, stop

# Without these tables, their defaults apply. Any other table adds something to the experiment, such as an operator.
TABLES_WITH_DEFAULTS = ("materials", "plugins", "simulation")


class RunFailure(Failure):
    """The reason why a run failed; a run that was stopped raises a plain Failure."""

    def __init__(self, run, reason):
        super().__init__(reason)
        self.run = run


@dataclasses.dataclass(frozen=True)
class Variant:
    """An experiment, with values for the keys given by --sweep and --set."""

    experiment: pathlib.Path
    swept: tuple = ()  # pairs (key, value)
    settings: tuple = ()  # pairs (key, value)
    births: int = 0  # of a random search: how many random robots each generation has

    @property
    def name(self):
        """The name of the variant, which is also the name of its folder."""
        parts = [self.experiment.stem, *(f"{key}={value}" for key, value in self.swept), *["random"] * (self.births > 0)]
        return ",".join(urllib.parse.quote(part, safe="=+ [],") for part in parts)

    @property
    def label(self):
        """The name of the variant in charts, which gives keys without their tables."""
        parts = [f"{key.split('.')[-1]}={value}" for key, value in self.swept]
        return " ".join([self.experiment.stem, *parts, *["random"] * (self.births > 0)])


@dataclasses.dataclass(frozen=True)
class Run:
    variant: Variant
    seed: int
    folder: pathlib.Path
    row: pathlib.Path  # file with the row of the run, which is there once the run is complete

    @property
    def log(self):
        return self.folder.with_name(self.folder.name + ".log")


def split_values(text):
    """Splits a text at commas outside brackets and quotes. Returns an empty list if a bracket or quote is not
    closed."""
    values, depth, quote = [""], 0, ""
    for character in text:
        if quote:
            quote = "" if character == quote else quote
        elif character in "\"'":
            quote = character
        else:
            depth += (character in "[{") - (character in "]}")
        if character == "," and depth == 0 and not quote:
            values.append("")
        else:
            values[-1] += character
    return [] if depth or quote else values


def refuse_key(key, option):
    """Refuses a key that no comparison may set."""
    if key == "experiment.seed":
        raise Failure(f"{option}: every run has a seed of its own; say how many with --seeds")


def parse_sweep(text):
    """Parses `KEY=VALUE,VALUE,…` into the key and its values."""
    key, _, values = text.partition("=")
    values = split_values(values)
    if not key or not values or not all(values):
        raise Failure(f"--sweep {text}: expected KEY=VALUE,VALUE,…")
    if len(set(values)) < len(values):
        raise Failure(f"--sweep {text}: a value is there twice")
    refuse_key(key, f"--sweep {text}")
    return key, values


def parse_setting(text):
    """Parses `KEY=VALUE` into the key and its value."""
    key, equals, value = text.partition("=")
    if not key or not equals:
        raise Failure(f"--set {text}: expected KEY=VALUE")
    refuse_key(key, f"--set {text}")
    return key, value


def has_table_of(experiment, key):
    """Returns whether the experiment has the table that the key belongs to. Every experiment has the tables with
    defaults."""
    if key.split(".")[0] in TABLES_WITH_DEFAULTS:
        return True
    node = experiment
    for part in key.split(".")[:-1]:
        if isinstance(node, list):
            node = node[int(part)] if part.isdigit() and int(part) < len(node) else None
        else:
            node = node.get(part) if isinstance(node, dict) else None
    return node is not None


def read_experiment(file):
    try:
        return tomllib.loads(file.read_text())
    except (OSError, ValueError) as error:
        raise Failure(f"{file}: cannot be read: {error}") from None


def read_experiments(files):
    experiments = {}
    for file in files:
        if any(file.stem == other.stem for other in experiments):
            raise Failure(f"{file}: another experiment has the name {file.stem} already; rename one of them")
        experiments[file] = read_experiment(file)
    return experiments


def refuse_keys(experiments, sweeps, settings):
    """Refuses a key that is given twice, and a key whose table no experiment has."""
    given = [*((key, "--sweep") for key, _ in sweeps), *((key, "--set") for key, _ in settings)]
    for key, count in collections.Counter(key for key, _ in given).items():
        if count > 1:
            raise Failure(f"{key}: given {count} times by --sweep and --set; give it once")
    for key, option in given:
        if not any(has_table_of(experiment, key) for experiment in experiments):
            table = key.rpartition(".")[0]
            raise Failure(f"{option} {key}: no experiment has a table [{table}]; add it to those that should have it")


def has_islands(variant, experiment):
    keys = [key.split(".")[0] for key, _ in (*variant.settings, *variant.swept)]
    return "islands" in (*experiment, *keys)


def births_of(variant, experiment):
    """Returns how many robots are born in each generation of a variant."""
    given = {f"experiment.{key}": value for key, value in experiment.get("experiment", {}).items()}
    given |= dict((*variant.settings, *variant.swept))
    births = [str(given.get(f"experiment.{key}", "0")) for key in ("children", "population")]
    counts = [int(text) for text in births if text.isdecimal() and int(text) > 0]
    if not counts:
        raise Failure(f"--random: {variant.experiment} gives no experiment.population; write it into the file")
    return counts[0]


def make_variants(files, sweeps, settings, with_random=False):
    """Returns each experiment with every combination of values for those keys whose tables it has, and each of them as a
    random search, too, if asked for. A random search has no use for islands, so those with islands have none."""
    experiments = read_experiments(files)
    refuse_keys(experiments.values(), sweeps, settings)
    variants = []
    for file, experiment in experiments.items():
        values = [[(key, value) for value in values] for key, values in sweeps if has_table_of(experiment, key)]
        fixed = tuple((key, value) for key, value in settings if has_table_of(experiment, key))
        for swept in itertools.product(*values):
            variants.append(variant := Variant(file, swept, fixed))
            if with_random and not has_islands(variant, experiment):
                variants.append(dataclasses.replace(variant, births=births_of(variant, experiment)))
    return variants


def databases_of_islands(run):
    """Returns the databases of the islands of a run, the first island's first; none if it has no islands."""
    return sorted(run.folder.glob("island-*/run.sqlite"))


def overrides(variant):
    keys = ("experiment.children", "experiment.random_individuals")
    random = [(key, variant.births) for key in keys] if variant.births else []
    return [word for key, value in (*variant.settings, *variant.swept, *random) for word in ("--set", f"{key}={value}")]


class Runs:
    """The runs of a comparison. Each variant has a folder for its runs, and one for their rows. Runs that have a row are
    not made again."""

    def __init__(self, program, out, variants, seeds):
        self._program = str(program)
        self._variants = variants
        self._rows = out / "rows"
        # seed by seed, so that at any time there are about as many runs of one variant as of another
        self.all = [
            Run(
                variant,
                seed,
                out / "runs" / variant.name / f"seed-{seed}",
                self._rows / variant.name / f"seed-{seed}.json",
            )
            for seed in seeds
            for variant in variants
        ]

    def check(self):
        """Refuses experiments that cannot be run, and rows of other experiments or settings."""
        for variant in self._variants:
            self._evodevo("check", variant.experiment, *overrides(variant))
        for variant in self._variants:
            settings = [f"{key}={value}" for key, value in variant.settings]
            made_from = {"experiment": variant.experiment.read_text(), "set": settings}
            record = self._rows / variant.name / "made-from.json"
            if not record.exists():
                rows.store(record, made_from)
            elif self._read(record) != made_from:
                raise Failure(
                    f"{record.parent}: its runs were made from another {variant.experiment.name} or with another --set, "
                    f"as {record.name} tells; give another --out, or remove this folder and the runs of that name"
                )

    @staticmethod
    def _read(record):
        try:
            return json.loads(record.read_text())
        except (OSError, ValueError) as error:
            raise Failure(
                f"{record}: cannot be read: {error}; it tells from which text and settings the runs of that name were "
                "made; if these have not changed since, remove it"
            ) from None

    def make(self, jobs, launcher, tell):
        """Makes or resumes all runs that are not finished, `jobs` at a time, with the launcher. A run that fails is tried
        once more, because the reason may be the host's, such as a GPU that another program holds."""
        make = self._in_one_process if launcher.in_one_process else self._as_processes
        waiting, failed = self.waiting(), set()
        while waiting:
            again = []
            with contextlib.closing(make(waiting, jobs, launcher, tell)) as ended:
                for run, code in ended:
                    try:
                        self._require_success(run, code)
                    except RunFailure as failure:
                        if run in failed:
                            raise
                        failed.add(run)
                        again.append(run)
                        tell(f"tried once more: {failure}")
                    else:
                        rows.write(run.row, self._shown(run))
            waiting = again

    def _as_processes(self, runs, jobs, launcher, tell):
        """Makes runs as processes, `jobs` at a time. Yields each run with its exit code when it has ended."""
        waiting, active = list(runs), {}
        try:
            while waiting or active:
                while waiting and len(active) < jobs:
                    run = waiting.pop(0)
                    active[run] = self._start(run, launcher)
                    tell(f"{run.variant.name}, seed {run.seed} ({len(waiting)} more to start)")
                os.waitid(os.P_ALL, 0, os.WEXITED | os.WNOWAIT)
                for run in [run for run, process in active.items() if process.poll() is not None]:
                    yield run, active.pop(run).returncode
        finally:
            stop(active.values())

    def _in_one_process(self, runs, jobs, _, tell):
        """The same with one process for all runs."""
        for run in runs:
            self.clear(run)
            run.log.parent.mkdir(parents=True, exist_ok=True)
        left = len(runs)
        tell(f"{left} runs, up to {jobs} at once")
        arguments = [[*self.arguments(run), "--resume"] for run in runs]
        with contextlib.closing(run_many(self._program, arguments, jobs)) as ended:
            for index, code in ended:
                left -= 1
                tell(f"{runs[index].variant.name}, seed {runs[index].seed} has ended ({left} more)")
                yield runs[index], code

    def waiting(self):
        """Returns the runs that are not complete, after writing the rows of those that are and have none yet."""
        return [run for run in self.all if not self._is_complete(run)]

    def _is_complete(self, run):
        """Returns whether a run has reached its end and, if the experiment asks for verification, has been verified."""
        if run.row.exists():
            return True
        if not self._has_begun(run):
            return False
        try:
            shown = self._shown(run)
        except Failure:
            if not databases_of_islands(run):
                raise
            return False  # it may have been killed between two islands: then it goes on, or says what is wrong
        if complete := shown["finished"] and shown["verified"]:
            rows.write(run.row, shown)
        return complete

    def measure(self, robots, jobs, tell):
        """Measures so many robots of each run of which not as many were measured yet, several runs at a time, and adds the
        numbers to their rows. Nothing is measured of a run without a fitness."""
        left = [run for run in self.all if (row := rows.read(run.row))["best"] is not None and row["robots"] != robots]
        for run in left:
            if not self._has_begun(run):
                raise Failure(
                    f"{run.folder}: is gone, and {run.row} has not what --signal {robots} measures; remove that file, and "
                    "the run is made again"
                )
        # a process uses all cores, and those that share a GPU compile kernels of their own
        with concurrent.futures.ThreadPoolExecutor(min(jobs, os.cpu_count() or 1)) as pool:
            for run, _ in zip(left, pool.map(lambda run: self._measure(run, robots), left)):
                tell(f"{run.variant.name}, seed {run.seed} is measured")

    def _measure(self, run, robots):
        self._evodevo("signal", run.folder, "--robots", robots, "--quiet")
        rows.write(run.row, self._shown(run), robots)

    def shown(self, run):
        """Returns what comparisons use of the output of `evodevo show --json` for a run that is complete."""
        return rows.read(run.row)

    def _shown(self, run):
        shown = json.loads(self._evodevo("show", run.folder, "--json"))
        return as_one(shown) if "islands" in shown else shown

    @staticmethod
    def _has_begun(run):
        """Returns whether a run has stored anything; it has not if it was killed just after its start."""
        database = next(iter(databases_of_islands(run)), run.folder / "run.sqlite")
        if not database.exists():
            return False
        try:
            with contextlib.closing(sqlite3.connect(database)) as connection:
                return connection.execute("SELECT count(*) FROM sqlite_master").fetchone()[0] > 0
        except sqlite3.Error as error:
            raise Failure(f"{database}: cannot be read: {error}; remove {run.folder}, and its run is made again") from None

    @staticmethod
    def arguments(run):
        """Returns the arguments of evodevo that begin a run or continue it."""
        options = [*overrides(run.variant), "--seed", run.seed, "--out", run.folder]
        return [run.variant.experiment, *options, "--no-report"]

    def clear(self, run):
        """Removes the folder of a run that was killed before it stored anything, so that it can be begun again."""
        if not self._has_begun(run):
            shutil.rmtree(run.folder, ignore_errors=True)

    def _start(self, run, launcher):
        self.clear(run)
        run.log.parent.mkdir(parents=True, exist_ok=True)
        command = [*launcher.command, self._program, "run", *self.arguments(run), "--resume", *launcher.options]
        with open(run.log, "a") as log:
            # in a process group of its own, so that Ctrl-C reaches only this process, which then asks each run to stop
            return subprocess.Popen(
                [*map(str, command)],
                stdout=log,
                stderr=subprocess.STDOUT,
                process_group=0,
            )

    def _evodevo(self, *arguments):
        command = [self._program, *map(str, arguments)]
        finished = subprocess.run(command, capture_output=True, text=True)
        if finished.returncode != 0:
            raise Failure(finished.stderr.strip() or f"{' '.join(command)} ended with {finished.returncode}")
        return finished.stdout

    @staticmethod
    def _require_success(run, code):
        if code not in (0, NO_FITNESS):
            last = "\n  ".join(run.log.read_text().splitlines()[-3:]) if run.log.exists() else "it had not begun"
            # a run counts as stopped if a signal ended it or it was asked to stop; otherwise it failed
            stopped = code < 0 or code == STOPPED
            remedy = "the same command goes on from there" if stopped else "mend that and give the same command again"
            reason = f"{run.folder}: the run ended with {code}:\n  {last}\n{remedy}"
            raise Failure(reason) if stopped else RunFailure(run, reason)
