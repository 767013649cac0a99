"""The law of precision: while rounding has not grown, a body moves in single precision as in double precision, and on a
GPU as on the CPU.

How much rounding grows is measured: in double precision, the body is simulated once more from positions that have moved
by as much as single precision rounds. A floor and friction are left out, where any difference can decide between two
forces. What is compared is one hundredth of a second in the life of the best robot as it has matured.
"""

import csv
import json
import re
import tomllib

import tomlkit

from .calls import Broken, require

DURATION = 0.01  # s
UNITS = {"float": 2.0**-24, "double": 2.0**-53}  # largest relative change of a number that is rounded
UNIT = UNITS["float"]
GROWN = 100  # growth beyond which nothing is compared
MARGIN = 10  # factor by which the difference may exceed that of a rounding in each step, each of which has grown


def moves_as_in_double(program, file, run, best, folder):
    """Raises Broken if the robot `best` of a run moves otherwise on the experiment's device, in single precision or in
    double, than on the CPU in double precision."""
    body, experiment = folder / "body.json", folder / "no-contact.toml"
    tables = without_contact(tomllib.loads(file.read_text()))
    device = tables.get("simulation", {}).get("device", "cpu")
    experiment.write_text(tomlkit.dumps(tables))
    if program("check", experiment).returncode != 0:
        return
    text = program.output("body", run, "--individual", best, "--matured")
    body.write_text(text)
    moved = folder / "moved.json"
    moved.write_text(json.dumps(with_moved_positions(json.loads(text))))

    reference = _end(program, body, experiment, "double", "cpu", folder)
    if not reference:
        return
    size, steps = max(1e-3, *(abs(x) for x in reference.positions)), reference.steps
    perturbed = _end(program, moved, experiment, "double", "cpu", folder)
    if not perturbed or perturbed.steps != steps:
        return
    growth = _difference(reference, perturbed) / (UNIT * size)
    if growth > GROWN:
        return
    for precision in ("float",) if device == "cpu" else ("float", "double"):
        end, where = _end(program, body, experiment, precision, device, folder), f"{precision} on {device}"
        if not end:
            raise Broken(f"precision: {where}: the simulation ends early, which in double on cpu it does not")
        if end.steps != steps:  # the experiment leaves the time step to the body and its precision
            continue
        difference = _difference(reference, end) / (UNITS[precision] * size)
        if difference > MARGIN * steps * max(1, growth):
            raise Broken(
                f"precision: {where} differs from double on cpu by {difference:.3g} roundings after {steps} steps, in "
                f"which one grows to {growth:.3g}"
            )


def without_contact(tables):
    scene = {name: force for name, force in tables.get("scene", {}).items() if name not in ("floor", "friction")}
    return {name: table for name, table in tables.items() if name != "scenario"} | {"scene": scene}


def with_moved_positions(body):
    """Returns a body whose coordinates are greater or smaller, in turn, by a rounding of the largest of them."""
    size = max(abs(x) for mass in body["masses"] for x in mass["position"])
    for i, mass in enumerate(body["masses"]):
        mass["position"] = [x + (UNIT if (i + axis) % 2 else -UNIT) * size for axis, x in enumerate(mass["position"])]
    return body


class _End:
    """The positions of a body when a simulation ended, one coordinate after the other, and how many steps it took."""

    def __init__(self, text, trajectory):
        with trajectory.open() as file:
            rows = list(csv.DictReader(file))
        last = [row for row in rows if row["time"] == rows[-1]["time"]]
        self.positions = [float(row[axis]) for row in last for axis in "xyz"]
        self.steps = round(1000 * DURATION / float(re.search(r"steps of (\S+) ms", text)[1]))


def _end(program, body, experiment, precision, device, folder):
    """Returns the end of a simulation, or None if it ended early."""
    trajectory = folder / "trajectory.csv"
    options = ("--duration", DURATION, "--threads", 1, "--trajectory", trajectory)
    simulation = ("--set", f"simulation.precision={precision}", "--set", f"simulation.device={device}")
    done = program("simulate", body, experiment, *options, *simulation)
    if done.returncode in (1, 2):  # it diverged, or this body needs shorter steps
        return None
    require(done, f"simulate, {precision} on {device}")
    return _End(done.stdout, trajectory)


def _difference(one, other):
    return max(abs(a - b) for a, b in zip(one.positions, other.positions, strict=True))
