"""Draws the chart of a folder that tools/stress has written."""

import sys

from common import charts, results
from common.charts import BLUE, VERMILION
from common.results import groups, read

COLOURS = {"least stressed": BLUE, "most stressed": VERMILION}


def apart(values):
    """Selects from ascending values, starting with the last, those whose labels do not overlap on a logarithmic
    axis."""
    kept = []
    for value in reversed(values):
        if not kept or value < kept[-1] / 1.8:
            kept.append(value)
    return kept


def draw_scene(axes, scene, rows):
    time, share = "cycle time (s)", "found (1)"
    times = sorted({row[time] for row in rows})
    shown = apart(times)
    axes.set(title=scene, xlabel=time, ylabel="share found", xscale="log", ylim=(0, 1))
    axes.set_xticks(shown, [f"{t:g}" for t in shown])
    axes.set_xticks([], minor=True)
    axes.set_xlim(times[0] / 1.2, times[-1] * 1.2)
    labels = []
    for (sought, count), line in groups(rows, "sought", "springs sought").items():
        colour = COLOURS[sought]
        at = [row[time] for row in line]

        def column(name):
            return [row[name] for row in line]

        low, high = column("found by the 10th percentile (1)"), column("found by the 90th percentile (1)")
        axes.fill_between(at, low, high, color=colour, alpha=0.13, linewidth=0)
        axes.plot(at, column("by chance (1)"), color=colour, linewidth=0.8, linestyle=":")
        axes.plot(at, column(share), color=colour, marker="o")
        labels.append((f"{count:.0f} {sought}", (line[-2][time], line[-2][share]), colour))
    charts.label_ends(axes, labels)


def stress_overlap(folder, origin):
    rows = read(folder, "stress_overlap")
    if rows is None:
        return None
    scenes = groups(rows, "scene")
    figure, panels = charts.page(
        len(scenes),
        3,
        (2.3, 2.6),
        title="How short a cycle may be: springs known after it that are the least and the most stressed of 10 s",
        legend=f"stress: mean absolute force of a spring · means of {rows[0]['robots']:.0f} random robots from birth on · "
        "shaded: from the 10th to the 90th percentile of the robots · dotted: by chance",
        footer=origin,
    )
    for axes, ((scene,), of_scene) in zip(panels, scenes.items()):
        draw_scene(axes, scene, of_scene)
    return figure


CHARTS = {"stress_overlap": stress_overlap}

if __name__ == "__main__":
    results.draw(CHARTS, "stress", sys.argv[1:])
