"""The charts of a comparison: the medians of quantities, with their intervals, against costs, and the scores of the
best robots by scenario."""

import itertools
import math

from common import charts

from . import inference
from .history import common_span
from .standings import AXES, INTERVAL, number

COLOURS = [charts.BLUE, charts.VERMILION, charts.GREEN, charts.PURPLE, charts.ORANGE, charts.SKY, charts.BLACK]
STYLES = [(colour, dashes) for dashes in ("-", "--", ":") for colour in COLOURS]
POINTS = 120  # intervals on each curve


def curve(runs, quantity, axis):
    """Returns points (cost, median, low, high) of a variant, from the cost at which all of its runs have the quantity
    to the cost at which the first of them ends."""
    start, end = common_span(runs, axis)
    points = []
    if end < start:
        return points
    for i in range(POINTS + 1):
        cost = start + (end - start) * i / POINTS
        values = [run.at(axis, cost, quantity.column) for run in runs]
        if all(map(math.isfinite, values)):
            middle = inference.median(values)
            points.append((cost, middle, *(inference.median_interval(values) or (middle, middle))))
    return points


def draw_panel(axes, histories, curves, axis):
    """Draws one panel. `curves` does not contain variants with a run that has no fitness. The limits of the vertical
    axis must be final."""
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


def drawn(histories):
    seeds = len(next(iter(histories.values())))
    return f"median and {INTERVAL}" if seeds >= inference.INTERVAL_FROM else "median"


def limits(curves):
    """Returns the limits of the vertical axis for these curves, which contain 0."""
    values = [value for _, points, _ in curves for point in points for value in point[1:]]
    low, high = min([0.0, *values]), max([0.0, *values])
    return low, high + (0.06 * (high - low) or 1.0)


def figure(histories, panels, title, legend=""):
    """Draws one panel for each of `panels`: pairs of a quantity and an axis. Panels of the same quantity have the same
    limits."""
    curves = {
        (quantity, axis): [
            (variant.label, points, style)
            for (variant, runs), style in zip(histories.items(), itertools.cycle(STYLES))
            if (points := curve(runs, quantity, axis))
        ]
        for quantity, axis in panels
    }
    page, places = charts.page(
        len(panels),
        len(panels),
        (3.6, 3.4),
        title=title,
        legend=legend,
        right=0.6 + 0.06 * max(len(variant.label) for variant in histories),  # for the labels
    )
    for axes, (quantity, axis) in zip(places, panels):
        axes.set_ylim(limits([each for (shown, _), some in curves.items() if shown == quantity for each in some]))
        draw_panel(axes, histories, curves[quantity, axis], axis)
    return page


def best_figure(histories, objective):
    """Draws the best score so far against both kinds of cost."""
    title = f"best {objective.name} so far ({objective.unit}), {drawn(histories)}"
    return figure(histories, [(objective, axis) for axis in AXES], title)


def map_figure(histories, quantities):
    """Draws the best score so far, and what the maps of niches amount to, against evaluations."""
    title = "best robots and maps of niches"
    page = figure(histories, [(quantity, "evaluations") for quantity in quantities], title, drawn(histories))
    for axes, quantity in zip(page.axes, quantities):
        axes.set_title(f"{quantity.name} ({quantity.unit})")
    return page


def draw_column(axes, place, scores, colour):
    """Draws the scores of the runs of one variant in one scenario as points, and their median with its interval.
    Returns the median, or None if it is not finite."""
    finite = list(filter(math.isfinite, scores))
    axes.plot([place] * len(finite), finite, "o", color=colour, alpha=0.3, markeredgewidth=0)
    middle = inference.median(scores)
    if not math.isfinite(middle):
        return None
    axes.plot(place, middle, "_", color=colour, markersize=13, markeredgewidth=2)
    bounds = inference.median_interval(scores)
    if bounds and all(map(math.isfinite, bounds)):
        axes.vlines(place, *bounds, color=colour, linewidth=1.5)
    return middle


def scenario_figure(scores, objective):
    """Draws the scores of the best robots: scenarios from left to right, and in each the variants side by side.
    `scores` is that of scenarios.Shared."""
    names = list(next(iter(scores.values())))
    width = 0.8 / len(scores)
    page, (axes,) = charts.page(
        1,
        1,
        (max(3.6, 0.5 * len(names) * max(2, len(scores))), 3.4),
        title=f"{objective.name} of the best robots ({objective.unit})",
        legend=f"points: runs; bars: {drawn(next(iter(scores.values())))}",
        right=0.6 + 0.06 * max(len(variant.label) for variant in scores),  # for the labels
    )
    ends = []
    for i, ((variant, by_name), (colour, _)) in enumerate(zip(scores.items(), itertools.cycle(STYLES))):
        for k, name in enumerate(names):
            place = k + (i - (len(scores) - 1) / 2) * width
            middle = draw_column(axes, place, by_name[name], colour)
        if middle is not None:
            ends.append((variant.label, (place, middle), colour))
    axes.axhline(0, color=charts.SOFT, linewidth=0.8)
    axes.set_xticks(range(len(names)), names)
    axes.set(xlim=(-0.5, len(names) - 0.5), ylim=axes.get_ylim())  # final limits, which the labels need
    axes.grid(axis="x", visible=False)
    charts.label_ends(axes, ends)
    return page
