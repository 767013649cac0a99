"""The chart of a comparison: the median of the best so far, with its interval, over both kinds of cost."""

import html
import itertools
import math

from . import inference
from .history import common_span
from .report import AXES, INTERVAL, number

# told apart by people with any kind of colour vision (Okabe & Ito 2008); then dashed
COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000"]
STYLES = [(colour, dash) for dash in ("none", "6 3", "2 2") for colour in COLOURS]
PAPER, INK, SOFT = "#ffffff", "#222222", "#999999"
WIDTH, HEIGHT, LEFT, TOP, BOTTOM, GAP = 330, 320, 56, 46, 46, 30  # of a panel and around it
LINE = 15  # between labels
POINTS = 120  # on each curve


def text(x, y, content, size=12, anchor="start", fill=INK):
    content = html.escape(content)
    return f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size}" text-anchor="{anchor}" fill="{fill}">{content}</text>'


def ticks(low, high):
    """Three to six round values within."""
    raw = (high - low) / 4
    power = 10.0 ** math.floor(math.log10(raw))
    step = min((m * power for m in (1, 2, 2.5, 5, 10)), key=lambda s: abs(math.log(s / raw)))
    return [i * step for i in range(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1)]


def curve(runs, axis):
    """(cost, median, low, high) from where all of a variant's runs have a fitness, until the first of them ends."""
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


def spread(heights, low, high):
    """Moves the heights of labels apart, as little as their order from above allows, within the panel."""
    order = sorted(range(len(heights)), key=heights.__getitem__)
    placed = list(heights)
    for before, index in zip([None, *order], order):
        placed[index] = max(placed[index], low if before is None else placed[before] + LINE)
    below = high
    for index in reversed(order):
        placed[index] = min(placed[index], below)
        below = placed[index] - LINE
    return placed


def steps(corners):
    """What holds at a cost holds until the next."""
    stairs = corners[:1]
    for x, y in corners[1:]:
        stairs += [(x, stairs[-1][1]), (x, y)]
    return stairs


class Panel:
    """One pair of axes."""

    def __init__(self, x, width, low, high):
        self._x, self._width, self._low, self._high = x, width, low, high

    def place(self, cost, score):
        return (
            self._x + WIDTH * cost / self._width,
            TOP + HEIGHT * (1 - (score - self._low) / (self._high - self._low)),
        )

    def frame(self, name):
        x, bottom = self._x, TOP + HEIGHT
        power = 3 * int(math.log10(self._width) // 3) if self._width >= 1e5 else 0
        parts = [f'<path d="M{x} {TOP}V{bottom}H{x + WIDTH}" fill="none" stroke="{SOFT}"/>']
        for tick in ticks(self._low, self._high):
            height = self.place(0, tick)[1]
            parts.append(f'<path d="M{x - 4} {height:.1f}h4" stroke="{SOFT}"/>')
            parts.append(text(x - 7, height + 4, f"{tick:.4g}", 11, "end", SOFT))
        for tick in ticks(0, self._width):
            place = self.place(tick, 0)[0]
            parts.append(f'<path d="M{place:.1f} {bottom}v4" stroke="{SOFT}"/>')
            parts.append(text(place, bottom + 17, f"{tick / 10**power:.4g}", 11, "middle", SOFT))
        unit = f" (1e{power})" if power else ""
        parts.append(text(x + WIDTH / 2, bottom + 36, name + unit, 12, "middle", INK))
        return parts

    def compared_at(self, cost):
        x = self.place(cost, 0)[0]
        return [f'<path d="M{x:.1f} {TOP}V{TOP + HEIGHT}" stroke="{SOFT}" stroke-dasharray="1 4"/>']

    def draw(self, points, colour, dash):
        middle, low, high = (steps([self.place(point[0], point[i]) for point in points]) for i in (1, 2, 3))

        def written(corners):
            return " ".join(f"{x:.1f},{y:.1f}" for x, y in corners)

        return [
            f'<polygon points="{written(low + high[::-1])}" fill="{colour}" fill-opacity="0.15"/>',
            f'<polyline points="{written(middle)}" fill="none" stroke="{colour}" stroke-width="2" '
            f'stroke-dasharray="{dash}"/>',
        ]

    def labels(self, curves, styles):
        """The name of each curve at its end, with a line to it where it ends early or the label had to move."""
        ends = [self.place(*points[-1][:2]) for _, points in curves]
        parts = []
        heights = spread([y for _, y in ends], TOP, TOP + HEIGHT)
        for (label, points), (x, y), height, (colour, _) in zip(curves, ends, heights, styles):
            right = self._x + WIDTH
            line = f"M{x + 2:.1f} {y:.1f}L{right + 8} {height:.1f}"
            parts.append(f'<path d="{line}" stroke="{colour}" stroke-opacity="0.5"/>')
            parts.append(text(right + 11, height + 4, f"{label} {number(points[-1][1])}", 12, fill=colour))
        return parts


def panel(histories, curves, axis, x, low, high):
    """One panel; `curves` leave out variants in which not every run has a fitness."""
    ends = [common_span(runs, axis)[1] for runs in histories.values()]
    axes = Panel(x, max(ends), low, high)
    parts = axes.frame(AXES[axis])
    start, end = common_span([run for runs in histories.values() for run in runs], axis)
    if start <= end:
        parts += axes.compared_at(end)
    for _, points, style in curves:
        parts += axes.draw(points, *style)
    return parts + axes.labels([(label, points) for label, points, _ in curves], [style for *_, style in curves])


def svg(histories, objective):
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
    margin = 60 + 7 * max(len(variant.label) for variant in histories)  # for the labels
    step = LEFT + WIDTH + margin + GAP
    width, height = 2 * step - GAP, TOP + HEIGHT + BOTTOM
    seeds = len(next(iter(histories.values())))
    drawn = f"median and {INTERVAL}" if seeds >= inference.INTERVAL_FROM else "median"
    parts = [text(LEFT, TOP - 22, f"best {objective.name} so far ({objective.unit}), {drawn}", 13)]
    for column, axis in enumerate(AXES):
        parts += panel(histories, curves[axis], axis, LEFT + column * step, low, high)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif">\n'
        f'<rect width="{width}" height="{height}" fill="{PAPER}"/>\n' + "\n".join(parts) + "\n</svg>\n"
    )
