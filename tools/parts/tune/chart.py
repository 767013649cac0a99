"""The chart of a race: the score of each configuration over its value of each key."""

import math

from matplotlib.ticker import LogLocator, NullFormatter

from common import charts
from compare import inference

from .ranges import Numbers


def dot(axes, place, scores, seeds, is_best):
    """Draws the median of a configuration, larger with more seeds."""
    middle = inference.median(scores)
    if math.isfinite(middle):
        colour = charts.VERMILION if is_best else charts.BLUE
        axes.plot(place, middle, "o", color=colour, alpha=0.6, markersize=2 + seeds**0.5, markeredgewidth=0)


def draw_panel(axes, parameter, points, unit):
    is_number = isinstance(parameter, Numbers)
    for text, scores, is_best in points:
        dot(axes, float(text) if is_number else parameter.values.index(text), scores, len(scores), is_best)
    axes.set(xlabel=parameter.key, ylabel=unit)
    if not is_number:
        axes.set_xticks(range(len(parameter.values)), parameter.values)
        axes.set_xlim(-0.5, len(parameter.values) - 0.5)
    elif parameter.log:
        axes.set_xscale("log")
        axes.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axes.xaxis.set_major_formatter(lambda value, _: f"{value:g}")
        axes.xaxis.set_minor_formatter(NullFormatter())
        axes.set_xlim(parameter.low / 1.1, parameter.high * 1.1)
    else:
        room = 0.03 * (parameter.high - parameter.low)
        axes.set_xlim(parameter.low - room, parameter.high + room)


def figure(parameters, tried, objective):
    """Draws one panel for each parameter. `tried` has for each configuration its values, its scores and whether it is
    the best."""
    page, panels = charts.page(
        len(parameters),
        min(3, len(parameters)),
        (3.2, 2.6),
        title=f"median {objective.name} ({objective.unit}) of each configuration",
        legend="larger: more seeds; red: the best; not shown: configurations whose median run has no fitness",
        right=0.3,
    )
    for i, (axes, parameter) in enumerate(zip(panels, parameters)):
        points = [(values[i], scores, is_best) for values, scores, is_best in tried if values[i] is not None]
        draw_panel(axes, parameter, points, objective.unit)
    return page
