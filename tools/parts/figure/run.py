"""Draws a run: its fitness against evaluations, and the motion of its best robot."""

import csv
import json
import pathlib
import subprocess
import tempfile
import tomllib

from common import charts

from .bodies import BLUE, RED, show_ground, springs

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


def settling(experiment):
    """Returns the time for which the first fitness operator lets bodies settle, s. Raises ValueError if there is none."""
    operators = tomllib.loads(pathlib.Path(experiment).read_text(encoding="utf-8")).get("fitness", [{}])
    if "settle" not in operators[0]:
        raise ValueError(f"{experiment}: fitness.0.settle is missing; write it down, so that the picture can begin there")
    return operators[0]["settle"]


def frames(trajectory, body, settle):
    """Returns the positions of all masses of a matured body at the samples nearest to each of TIMES."""
    samples = {}
    with open(trajectory, newline="") as stream:
        for row in csv.DictReader(stream):
            place = float(row["x"]), float(row["y"]), float(row["z"])
            samples.setdefault(float(row["time"]) - body["time"] - settle, []).append(place)
    return {time: samples[min(samples, key=lambda sample: abs(sample - time))] for time in TIMES}


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
        settle = settling(experiment)
        evodevo(program, "simulate", body_file, experiment, "--duration", settle + TIMES[-1], "--trajectory", trajectory)
        body = json.loads(body_file.read_text())
        wanted = frames(trajectory, body, settle)
    page, (chart,) = charts.page(1, 1, (3, 4.2), right=6)
    draw_fitness(chart, run)
    x, y, height = 0.52, 0.04, 0.92 / len(TIMES)
    panels = [page.add_axes([x, y + height * (len(TIMES) - 1 - i), 0.46, 0.9 * height]) for i in range(len(TIMES))]
    draw_motion(panels, body, wanted)
    return page
