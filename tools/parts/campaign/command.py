"""Runs the parts of a campaign in turn.

A part has a `name`, and `sitting(seconds, past)`, which tries cases for about so many seconds and yields an Outcome as
soon as it has one. `past` are the part's outcomes of earlier sittings.
"""

import os
import pathlib
import subprocess

from common.command_line import Failure, ended

from .bodies import Bodies, Sanitizers, processes
from .experiments import Experiments, listed_operators
from .fuzz import Fuzz
from .laws import Laws
from .outcomes import Record
from .page import page
from .planted import Planted
from .soak import Soak
from .storage import Storage
from .workshop import Workshop

ROOT = pathlib.Path(__file__).resolve().parents[3]


def main(given, program):
    return ended("campaign", lambda: sit(given, program))


def sit(given, program):
    if given.planted:
        campaign(0, given.out, [Planted(Workshop(ROOT, given.out / "planted"), given.out, given.planted)])
    else:
        all_parts = (parts_on_gpu if given.gpu else parts)(program, given.out)
        campaign(given.minutes * 60, given.out, chosen(all_parts, given.only))


def chosen(parts, only):
    """Returns the part with the name `only`, or all if that is None."""
    if only is None:
        return parts
    named = [part for part in parts if part.name == only]
    if not named:
        raise Failure(f"--only {only}: there is no such part; give one of {', '.join(part.name for part in parts)}")
    return named


def parts(program, folder):
    operators, built = listed_operators(program), pathlib.Path(program).resolve().parents[1]
    return [
        Bodies(hostile_bodies(program), "cpu"),
        Experiments(operators, laws(program, folder), folder),
        Fuzz(built_targets, operators, folder),
        Soak(program, folder),
        Storage(program, built / "lib" / "faults.so", folder),
    ]


def parts_on_gpu(program, folder):
    bodies = hostile_bodies(program)
    return [
        Bodies(bodies, "cuda"),
        Experiments(listed_operators(program), laws(program, folder, "cuda"), folder, "cuda"),
        Sanitizers(bodies, "cuda"),
    ]


def laws(program, folder, device="cpu"):
    """Returns the laws of experiments for as many at once as there are pairs of cores, since most commands of each run on
    one core, and others on three; on a GPU for no more than it serves."""
    at_once = max(1, min((os.cpu_count() or 1) // 2, processes(device)))
    return [Laws(program, folder.resolve() / "experiments" / str(number)) for number in range(at_once)]


def hostile_bodies(program):
    return pathlib.Path(program).resolve().with_name("hostile_bodies")


def built_targets():
    """Builds the targets of fuzzing, and returns the folder of their programs."""
    build = subprocess.run([pathlib.Path(__file__).parent / "build"], stdout=subprocess.PIPE, text=True)
    if build.returncode != 0:
        raise Failure("the targets of fuzzing were not built; see above")
    return pathlib.Path(build.stdout.strip())


def campaign(seconds, folder, parts):
    record = Record(folder)
    try:
        for part in parts:
            for outcome in part.sitting(seconds / len(parts), record.of(part.name)):
                record.add(outcome)
    finally:
        report = folder / "report.md"
        report.write_text(page(record.outcomes))
        print(report)
