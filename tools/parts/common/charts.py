"""Code that all charts share: colours, pages of panels, labels that do not overlap, and files that are reproducible
byte by byte."""

import math

import matplotlib
import numpy
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

# distinguishable with any kind of colour vision (Okabe & Ito 2008)
BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY, BLACK = (
    "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000"
)  # fmt: skip
INK, SOFT, GRID = "#222222", "#767676", "#e6e6e6"
LINE = 10  # distance between the lines of labels, in points
HEAD, FOOT, ABOVE, BELOW = 0.45, 0.2, 0.3, 0.5  # margins of a page, and above and below each panel, in inches

matplotlib.rcParams.update(
    {
        "svg.fonttype": "none",  # writes text as text, not as outlines
        "svg.hashsalt": "evodevo",  # without a salt, identifiers are random
        "font.size": 8,
        "axes.titlesize": 9,
        "axes.titleweight": "bold",
        "axes.titlelocation": "left",
        "axes.edgecolor": SOFT,
        "axes.labelcolor": SOFT,
        "axes.grid": True,
        "axes.axisbelow": True,
        "grid.color": GRID,
        "xtick.color": SOFT,
        "ytick.color": SOFT,
        "text.color": INK,
        "lines.linewidth": 1.2,
        "lines.markersize": 3.5,
        "text.parse_math": False,  # names may contain any characters, such as $
        "image.composite_image": False,
    }
)


def page(count, columns, size, title="", legend="", footer="", left=0.75, right=1.3):
    """Returns a figure and its `count` panels of `size` (inches), which are arranged from left to right and from top to
    bottom. Around them is text: a title, a line that explains the marks, and a footer with the origin of the data.
    `left` and `right` are the widths (inches) of the room for labels beside each panel."""
    rows = -(-count // columns)
    width = min(count, columns) * (left + size[0] + right)
    height = HEAD + rows * (ABOVE + size[1] + BELOW) + FOOT
    figure = Figure(figsize=(width, height), facecolor="white")
    for i in range(count):
        x = i % columns * (left + size[0] + right) + left
        y = height - HEAD - i // columns * (ABOVE + size[1] + BELOW) - ABOVE - size[1]
        figure.add_axes([x / width, y / height, size[0] / width, size[1] / height])
    for y, content, style in (
        (height - 0.1, title, {"fontsize": 11, "fontweight": "bold", "va": "top"}),
        (height - 0.32, legend, {"color": SOFT, "va": "top"}),
        (0.06, footer, {"color": SOFT, "fontsize": 7, "va": "bottom"}),
    ):
        if content:
            figure.text(0.15 / width, y / height, content, **style)
    return figure, figure.axes


def power_of_ten(value, _=None):
    raised = str(round(math.log10(value))).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
    return f"10{raised}"


def make_logarithmic(axes, which):
    """Makes the axes named in `which` ("x", "y" or "xy") logarithmic. Their ticks are powers of ten in plain text."""
    for name in which:
        axes.set(**{f"{name}scale": "log"})
        axis = {"x": axes.xaxis, "y": axes.yaxis}[name]
        axis.set_major_formatter(power_of_ten)
        axis.set_minor_formatter(NullFormatter())


def spread(heights, gap, lowest, highest):
    """Returns heights in the same order, moved so that neighbours are at least `gap` apart and all lie between `lowest`
    and `highest`."""
    order = sorted(range(len(heights)), key=heights.__getitem__)
    placed = list(heights)
    floor = lowest
    for index in order:
        placed[index] = max(placed[index], floor)
        floor = placed[index] + gap
    ceiling = highest
    for index in reversed(order):
        placed[index] = min(placed[index], ceiling)
        ceiling = placed[index] - gap
    return placed


def label_column(axes, x, labels, align="left"):
    """Writes labels (text, point, colour) in a column, each with a line to its point. `x` is the position of the column
    as a fraction of the panel's width. The panel's limits and scales must be final."""
    if not labels:
        return
    height = 72 * axes.figure.get_figheight() * axes.get_position().height  # height of the axes, in points
    shares = axes.transAxes.inverted().transform([axes.transData.transform(point) for _, point, _ in labels])
    shares = numpy.clip(shares, 0, 1)  # the point may lie outside the panel
    heights = spread([height * share for _, share in shares], LINE, 0, height)
    for (name, _, colour), share, placed in zip(labels, shares, heights):
        axes.annotate(
            name,
            share,
            (x, placed / height),
            xycoords="axes fraction",
            ha=align,
            va="center",
            color=colour,
            fontsize=7.5,
            arrowprops={"arrowstyle": "-", "color": colour, "alpha": 0.4, "shrinkA": 0, "shrinkB": 2},
        )


def label_ends(axes, labels):
    """Writes the names of lines, given as (text, last point, colour), in the margin on the right."""
    label_column(axes, 1.04, labels)


def note(axes, point, content, offset=(6, 0), **style):
    """Writes text beside a point, on a white background that covers lines behind it."""
    box = {"facecolor": "white", "alpha": 0.8, "edgecolor": "none", "pad": 0.5}
    axes.annotate(content, point, offset, textcoords="offset points", fontsize=7.5, bbox=box, **{"va": "center"} | style)


def save(figure, file):
    """Writes a figure; equal figures give equal files. The extension, such as .svg or .png, determines the format."""
    is_svg = str(file).endswith(".svg")
    figure.savefig(file, dpi=100, metadata={"Date": None, "Creator": None} if is_svg else {"Software": None})
