"""Drawings of bodies seen from the side."""

from matplotlib.collections import LineCollection

GREY, RED, BLUE = "#b8b8b8", "#d1495b", "#2e6f9e"


def colour(material):
    """Returns the colour of a spring's material: red for muscles, blue for muscles in counter-phase, grey for passive
    springs."""
    if material["amplitude"] == 0:
        return GREY
    return RED if abs(material["phase"]) < 1 else BLUE


def springs(body, places, shift=0):
    """Returns all springs as lines, the most distant first. `shift` moves them along x, m."""
    ordered = sorted(body["springs"], key=lambda spring: -places[spring["a"]][1])
    lines = [[(places[spring[end]][0] + shift, places[spring[end]][2]) for end in "ab"] for spring in ordered]
    colours = [colour(body["materials"][spring["material"]]) for spring in ordered]
    return LineCollection(lines, colors=colours, linewidths=0.6)


def show_ground(axes, low, high, top):
    """Draws the ground as a line at height 0 from `low` to `high`, m, and hides the axes. Both axes have the same
    scale; there is room for a body as high as `top`, m."""
    axes.set_axis_off()
    axes.plot([low, high], [0, 0], color="#999999", linewidth=0.8)
    axes.set_aspect("equal", anchor="S")
    axes.set(xlim=(low, high), ylim=(-0.02 * top, top))
