"""Draws the speed for bodies of different sizes, and for different numbers of bodies, from STEM.json of
tools/parts/bench/record."""

import json
import sys

from common import charts
from common.charts import BLUE, INK, ORANGE, SOFT, VERMILION, note

# with knn1000, the pipe of shared memory is busy for this share of the time (kernels/cuda/README.md)
PIPE_BUSY = 0.81


def report_of(reports, study, **conditions):
    """Returns the first report of a study whose conditions are these."""
    for report in reports:
        if report["study"] == study and all(report.get(name) == value for name, value in conditions.items()):
            return report
    sys.exit(f"there is no study \"{study}\" {conditions or ''}; measure it with tools/parts/bench/record")


def plot(axes, rows, across):
    """Draws the rates with and without stress, and returns the labels of both lines."""
    labels = []
    for key, name, colour in (
        ("spring_evaluations_per_second", "without stress", BLUE),
        ("with_stress", "with exact stress", ORANGE),
    ):
        points = [(row[across], row[key]) for row in rows]
        axes.plot(*zip(*points), color=colour, marker="o")
        labels.append((name, points[-1], colour))
    return labels


def draw(stem):
    try:
        with open(f"{stem}.json", encoding="utf-8") as stream:
            reports = json.load(stream)
    except (OSError, ValueError) as error:
        sys.exit(f"{stem}.json: cannot be read: {error}; write it with tools/parts/bench/record")
    sizes = report_of(reports, "Speed for bodies of different sizes")
    numbers = report_of(reports, "Speed for different numbers of bodies")
    peers = report_of(reports, "The paper's simulators and ours", masses=1000)["rows"]
    knn1000 = report_of(reports, "Speed", masses=1000, precision="float32", method="paper-euler")["rows"][0]
    figure, (by_size, by_number) = charts.page(
        2,
        2,
        (3.6, 2.6),
        "How fast bodies of any size, and any number of bodies, are simulated",
        "spring evaluations per second, paper-euler in single precision, steps of 0.5 ms",
        f"{sizes['device']} · {sizes['command']} · {numbers['command']}",
    )
    labels = plot(by_size, sizes["rows"], "masses")
    limit = knn1000["spring_evaluations_per_second"] / PIPE_BUSY
    by_size.axhline(limit, color=SOFT, linestyle="--")
    by_size.set(xlabel="masses of a body", title="many bodies of one size", ylim=(8e9, 1.2e12))
    charts.make_logarithmic(by_size, "xy")
    note(by_size, (70, limit), "shared memory busy all the time (knn1000)", (0, 7), color=SOFT)
    for row, name in ((peers[1], "the paper's method"), (peers[0], "the paper's baseline")):
        point = (1000, row["spring_evaluations_per_second"])
        by_size.plot(*point, color=VERMILION, marker="D", linestyle="none")
        note(by_size, point, name, color=VERMILION)
    charts.label_ends(by_size, labels)
    labels = plot(by_number, numbers["rows"], "bodies")
    by_number.set(xlabel="bodies of 1,000 masses", title="few and many bodies", ylim=(8e9, 1.2e12))
    by_number.axvline(132, color=SOFT, linestyle=":")
    charts.make_logarithmic(by_number, "xy")
    note(by_number, (132, 1.2e10), "132 multiprocessors", color=INK)
    charts.label_ends(by_number, labels)
    charts.save(figure, f"{stem}.svg")


if __name__ == "__main__":
    draw(sys.argv[1])
