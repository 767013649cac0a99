"""Draws a run: its fitness against evaluations, and the motion of its best robot."""

import csv
import json
import pathlib
import subprocess
import tempfile

from common import charts

from .bodies import BLUE, RED, show_ground, springs

SETTLE = 10  # time for settling, s
TIMES = [0, 2.5, 5, 7.5, 10]  # s after settling


def draw_fitness(axes, run):
    """Draws the best and the median fitness of the population against evaluations."""
    generations = [generation for generation in run["generations"] if generation["best"] is not None]
    objective = run["objectives"][0]
    evaluations = [generation["evaluations"] for generation in generations]
    axes.set(title=f"{objective['name']} ({objective['unit']})", xlabel="evaluations", xlim=(0, evaluations[-1]))
    labels = []
    for key, colour in (("best", RED), ("median", BLUE)):
        values = [generation[key] for generation in generations]
        axes.plot(evaluations, values, color=colour)
        labels.append((f"{key} {values[-1]:.2f}", (evaluations[-1], values[-1]), colour))
    axes.set_ylim(bottom=min(0, *(generation["median"] for generation in generations)))
    charts.label_ends(axes, labels)


def frames(trajectory, body):
    """Returns the positions of all masses of a matured body at each of TIMES."""
    wanted = {time: [None] * len(body["masses"]) for time in TIMES}
    settled = body["time"] + SETTLE
    with open(trajectory, newline="") as stream:
        for row in csv.DictReader(stream):
            frame = wanted.get(round(float(row["time"]) - settled, 3))
            if frame is not None:
                frame[int(row["mass"])] = (float(row["x"]), float(row["y"]), float(row["z"]))
    return wanted


def draw_motion(panels, body, wanted):
    """Draws a side view for each time, one below the other, all in the same coordinates."""
    everything = [place for frame in wanted.values() for place in frame]
    low, high = min(place[0] for place in everything), max(place[0] for place in everything)
    top = max(place[2] for place in everything)
    for axes, (time, frame) in zip(panels, wanted.items()):
        show_ground(axes, low, high, top)
        axes.add_collection(springs(body, frame))
        axes.text(-0.02, 0, f"{time:g} s", transform=axes.transAxes, ha="right", color=charts.SOFT)


def evodevo(program, *arguments):
    return subprocess.run([program, *map(str, arguments)], check=True, stdout=subprocess.PIPE, text=True).stdout


def figure(program, folder, experiment):
    run = json.loads(evodevo(program, "show", folder, "--json"))
    with tempfile.TemporaryDirectory() as scratch:
        body_file, trajectory = pathlib.Path(scratch, "body.json"), pathlib.Path(scratch, "trajectory.csv")
        body_file.write_text(evodevo(program, "body", folder, "--matured"))
        evodevo(program, "simulate", body_file, experiment, "--duration", SETTLE + TIMES[-1], "--trajectory", trajectory)
        body = json.loads(body_file.read_text())
        wanted = frames(trajectory, body)
    page, (chart,) = charts.page(1, 1, (3, 4.2), right=6)
    draw_fitness(chart, run)
    x, y, height = 0.52, 0.04, 0.92 / len(TIMES)
    panels = [page.add_axes([x, y + height * (len(TIMES) - 1 - i), 0.46, 0.9 * height]) for i in range(len(TIMES))]
    draw_motion(panels, body, wanted)
    return page
