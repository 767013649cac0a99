"""The chart of a comparison: the median of the best score so far, with its interval, against both kinds of cost."""

import itertools
import math

from common import charts

from . import inference
from .history import common_span
from .report import AXES, INTERVAL, number

COLOURS = [charts.BLUE, charts.VERMILION, charts.GREEN, charts.PURPLE, charts.ORANGE, charts.SKY, charts.BLACK]
STYLES = [(colour, dashes) for dashes in ("-", "--", ":") for colour in COLOURS]
POINTS = 120  # intervals on each curve


def curve(runs, axis):
    """Returns points (cost, median, low, high) of a variant, from the cost at which all of its runs have a fitness to
    the cost at which the first of them ends."""
    start, end = common_span(runs, axis)
    points = []
    if end < start:
        return points
    for i in range(POINTS + 1):
        cost = start + (end - start) * i / POINTS
        scores = [run.at(axis, cost) for run in runs]
        if all(map(math.isfinite, scores)):
            middle = inference.median(scores)
            points.append((cost, middle, *(inference.median_interval(scores) or (middle, middle))))
    return points


def draw_panel(axes, histories, curves, axis):
    """Draws one panel. `curves` does not contain variants with a run that has no fitness."""
    axes.set(xlabel=AXES[axis], xlim=(0, max(common_span(runs, axis)[1] for runs in histories.values())))
    start, end = common_span([run for runs in histories.values() for run in runs], axis)
    if start <= end:
        axes.axvline(end, color=charts.SOFT, linestyle=":", linewidth=0.8, label="compared here")
    for label, points, (colour, dashes) in curves:
        cost, middle, low, high = zip(*points)
        # a score holds until the next cost
        axes.fill_between(cost, low, high, step="post", color=colour, alpha=0.15, linewidth=0)
        axes.step(cost, middle, where="post", color=colour, linestyle=dashes, linewidth=1.5, label=label)
    ends = [(f"{label} {number(points[-1][1])}", points[-1][:2], colour) for label, points, (colour, _) in curves]
    charts.label_ends(axes, ends)


def figure(histories, objective):
    curves = {
        axis: [
            (variant.label, points, style)
            for (variant, runs), style in zip(histories.items(), itertools.cycle(STYLES))
            if (points := curve(runs, axis))
        ]
        for axis in AXES
    }
    scores = [score for some in curves.values() for _, points, _ in some for point in points for score in point[1:]]
    low, high = min([0.0, *scores]), max([0.0, *scores])
    high += 0.06 * (high - low) or 1.0
    seeds = len(next(iter(histories.values())))
    drawn = f"median and {INTERVAL}" if seeds >= inference.INTERVAL_FROM else "median"
    page, panels = charts.page(
        len(AXES),
        len(AXES),
        (3.6, 3.4),
        title=f"best {objective.name} so far ({objective.unit}), {drawn}",
        right=0.6 + 0.06 * max(len(variant.label) for variant in histories),  # for the labels
    )
    for axes, axis in zip(panels, AXES):
        axes.set_ylim(low, high)
        draw_panel(axes, histories, curves[axis], axis)
    return page
