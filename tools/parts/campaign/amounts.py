"""The law of the control `random-places`: a robot is changed as much as the operators change it.

It is compared in the first cycle of a robot of the first generation, which is born alike with and without the control.
"""

import collections
import contextlib
import json
import sqlite3

from .calls import Broken, require

CONTROLS = ("off", "random-places")
CYCLE = 1
ROBOTS = 8  # among which one is looked for


def keeps_amounts(program, file, folder):
    """Raises Broken if the control `random-places` changes a robot of an experiment by other amounts than its operators
    do."""
    for control in CONTROLS:
        require(program("run", *first_robots(file, folder, control)), f"run, {control}")
    are_changed_alike(program, folder)


def are_changed_alike(program, folder):
    """Like keeps_amounts(), after the runs of first_robots() have been made in `folder`."""
    runs = [folder / control for control in CONTROLS]
    alive = set.intersection(*map(_alive, runs))
    if not alive:
        return
    lives = [json.loads(program.output("life", run, "--individual", min(alive), "--json")) for run in runs]
    operators, moved = lives
    if operators["born"] != moved["born"]:
        raise Broken(f"random-places: born with {moved['born']}, not {operators['born']}")
    if any(edit["operator"] == "torn off" for life in lives for edit in in_cycle(life)):
        return  # what falls off differs
    broken = different(amounts(operators), amounts(moved), operators["born"])
    if broken:
        raise Broken(f"random-places: {broken}")


def amounts(life):
    """Returns how many springs and masses came, went and changed in the cycle."""
    return collections.Counter(
        ("mass " if "mass" in edit else "spring ") + edit["event"]
        for edit in in_cycle(life)
        if edit["event"] != "scaled"
    )


def in_cycle(life):
    return [edit for edit in life["edits"] if edit["cycle"] == CYCLE]


def different(expected, given, born):
    """Returns which amounts differ though they must not, or an empty text."""
    exact = ["mass gone", "mass come"]
    # a new spring is left out if no pair of masses is found that has none, and a mass may take too many springs with it
    left = born["masses"] - expected["mass gone"]
    if 4 * (born["springs"] + expected["spring come"]) < left * (left - 1) and not expected["mass come"]:
        exact.append("spring come")
        if not expected["mass gone"]:
            exact += ["spring gone", "spring changed"]
    wrong = [what for what in exact if given[what] != expected[what]]
    if given["spring come"] > expected["spring come"]:
        wrong.append("spring come")
    return ", ".join(f"{what} {given[what]} instead of {expected[what]}" for what in dict.fromkeys(wrong))


def first_robots(file, folder, control):
    """Returns the arguments of `run` that make only the first robots, in the folder `folder`/`control`."""
    settings = {
        "development.control": control,
        "experiment.evaluations": ROBOTS,
        "experiment.verify": 0,
        "experiment.verify_front": "off",
    }
    words = [word for key, value in settings.items() for word in ("--set", f"{key}={value}")]
    return [file, "--out", folder / control, "--threads", 1, "--no-report", *words]


def _alive(run):
    """Returns the robots of the first generation whose lives did not end early."""
    with contextlib.closing(sqlite3.connect(run / "run.sqlite")) as record:
        return {id for (id,) in record.execute("SELECT id FROM individuals WHERE born = 0 AND status = 'ok'")}
