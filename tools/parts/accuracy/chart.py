"""Charts as SVG: panels with linear or logarithmic axes, lines, points and labels beside them."""

import html
import math

INK, SOFT, GRID = "#222222", "#767676", "#e6e6e6"
SIZE = 12  # of text, px


def text(x, y, content, size=SIZE, anchor="start", fill=INK, weight="normal", turn=0, halo=False):
    around = ' stroke="#ffffff" stroke-width="3" paint-order="stroke"' if halo else ""
    turned = f' transform="rotate({turn} {x:.1f} {y:.1f})"' if turn else ""
    return (
        f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size}" text-anchor="{anchor}" fill="{fill}" '
        f'font-weight="{weight}"{around}{turned}>{html.escape(content)}</text>'
    )


def power_of_ten(value):
    raised = str(round(math.log10(value))).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
    return f"10{raised}"


def spread(heights, gap, bottom):
    """Heights that rise, as near to the given ones as can be, but `gap` apart and none below `bottom`."""
    places = list(heights)
    for i in range(1, len(places)):
        places[i] = max(places[i], places[i - 1] + gap)
    lowest = bottom
    for i in range(len(places) - 1, -1, -1):
        places[i] = min(places[i], lowest)
        lowest = places[i] - gap
    return places


class Axis:
    """A range of numbers and where its ticks are. Logarithmic axes have a tick at each power of ten, or at 1, 2 and 5
    times each where there are few."""

    def __init__(self, title, low, high, log=False, ticks=None):
        self.title, self.low, self.high, self.log = title, low, high, log
        self.ticks = ticks if ticks is not None else self._log_ticks() if log else self._linear_ticks()

    def _log_ticks(self):
        decades = range(math.floor(math.log10(self.low)), math.ceil(math.log10(self.high)) + 1)
        if self.high / self.low < 100:
            return self._inside((m * 10.0**d, f"{m * 10.0**d:g}") for d in decades for m in (1, 2, 5))
        ticks = self._inside((10.0**d, power_of_ten(10.0**d)) for d in decades)
        return ticks[:: math.ceil(len(ticks) / 8)]

    def _inside(self, ticks):
        return [tick for tick in ticks if self.low <= tick[0] * 1.0001 and tick[0] <= self.high * 1.0001]

    def _linear_ticks(self):
        rough = (self.high - self.low) / 5
        unit = 10.0 ** math.floor(math.log10(rough))
        step = next(m * unit for m in (1, 2, 5, 10) if m * unit >= rough * 0.999)
        first = math.ceil(self.low / step - 1e-9)
        count = math.floor(self.high / step + 1e-9) - first + 1
        return [((first + i) * step, f"{(first + i) * step:g}") for i in range(count)]

    def part(self, value):
        """Where a number lies, from 0 to 1; what is outside the range is at its end."""
        if self.log:
            value = max(value, self.low)
            return min(1, math.log(value / self.low) / math.log(self.high / self.low))
        return min(1, max(0, (value - self.low) / (self.high - self.low)))


class Panel:
    """A rectangle with two axes. What is drawn first lies below."""

    def __init__(self, x, y, width, height, across, up, title=""):
        self.x, self.y, self.width, self.height = x, y, width, height
        self.across, self.up = across, up
        self.labels = []
        self.parts = [text(x, y - 8, title, 13, weight="bold")] if title else []
        for value, name in across.ticks:
            at = x + width * across.part(value)
            self.parts.append(f'<path d="M{at:.1f} {y}V{y + height}" stroke="{GRID}"/>')
            self.parts.append(text(at, y + height + 15, name, 11, "middle", SOFT))
        for value, name in up.ticks:
            at = y + height * (1 - up.part(value))
            self.parts.append(f'<path d="M{x} {at:.1f}H{x + width}" stroke="{GRID}"/>')
            self.parts.append(text(x - 5, at + 4, name, 11, "end", SOFT))
        self.parts.append(text(x + width / 2, y + height + 31, across.title, 12, "middle", SOFT))
        self.parts.append(text(x - 40, y + height / 2, up.title, 12, "middle", SOFT, turn=-90))

    def place(self, point):
        return (self.x + self.width * self.across.part(point[0]), self.y + self.height * (1 - self.up.part(point[1])))

    def line(self, points, stroke, width=1.6, dashes=""):
        if len(points) > 1:
            path = " ".join("%.1f,%.1f" % self.place(p) for p in points)
            dashed = f' stroke-dasharray="{dashes}"' if dashes else ""
            self.parts.append(f'<polyline points="{path}" fill="none" stroke="{stroke}" stroke-width="{width}"{dashed}/>')

    def area(self, points, fill):
        path = " ".join("%.1f,%.1f" % self.place(p) for p in points)
        self.parts.append(f'<polygon points="{path}" fill="{fill}"/>')

    def dots(self, points, fill, radius=2.6, hollow=False):
        for point in points:
            x, y = self.place(point)
            inside = "#ffffff" if hollow else fill
            self.parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius}" fill="{inside}" stroke="{fill}"/>')

    def ring(self, point, stroke=INK):
        x, y = self.place(point)
        self.parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="7" fill="none" stroke="{stroke}" stroke-width="1.8"/>')

    def bar(self, x, low, high, stroke):
        (at, bottom), (_, top) = self.place((x, low)), self.place((x, high))
        self.parts.append(f'<path d="M{at:.1f} {bottom:.1f}V{top:.1f}" stroke="{stroke}" stroke-width="1" opacity="0.5"/>')

    def cell(self, low, high, fill):
        (left, bottom), (right, top) = self.place(low), self.place(high)
        # a little larger, so that no seams show between neighbours
        self.parts.append(
            f'<rect x="{left:.1f}" y="{top:.1f}" width="{right - left + 0.4:.1f}" '
            f'height="{bottom - top + 0.4:.1f}" fill="{fill}"/>'
        )

    def level(self, value, name, stroke=SOFT):
        """A dashed line across at a height, with its name above."""
        y = self.place((self.across.low, value))[1]
        self.parts.append(f'<path d="M{self.x} {y:.1f}H{self.x + self.width}" stroke="{stroke}" stroke-dasharray="5 3"/>')
        self.parts.append(text(self.x + 4, y - 4, name, 11, fill=stroke))

    def upright(self, value, name, stroke=SOFT, at=0.0):
        """A dashed line up at a place, with its name beside it, `at` of the height below the top."""
        x = self.place((value, self.up.low))[0]
        self.parts.append(f'<path d="M{x:.1f} {self.y}V{self.y + self.height}" stroke="{stroke}" stroke-dasharray="5 3"/>')
        self.parts.append(text(x + 4, self.y + 12 + at * self.height, name, 11, fill=stroke))

    def note(self, point, name, fill=INK, dx=9, dy=4, anchor="start"):
        x, y = self.place(point)
        self.parts.append(text(x + dx, y + dy, name, 11, anchor, fill, halo=True))

    def label(self, height, name, fill):
        """A name in the margin on the right, beside a line that ends at this height."""
        self.labels.append((self.place((self.across.high, height))[1], name, fill))

    def names_on_the_left(self, points, fill=SOFT):
        """Names of points ((x, y), name), one above the other, to the left of all of them."""
        places = sorted((*reversed(self.place(point)), name) for point, name in points)
        left = min(x for _, x, _ in places) - 14
        for (y, x, name), height in zip(places, spread([p[0] for p in places], SIZE + 1, self.y + self.height - 4)):
            self.parts.append(f'<path d="M{left + 2:.1f} {height:.1f}L{x:.1f} {y:.1f}" stroke="{fill}" opacity="0.4"/>')
            self.parts.append(text(left, height + 4, name, 11, "end", fill))

    def svg(self):
        frame = f'<rect x="{self.x}" y="{self.y}" width="{self.width}" height="{self.height}" fill="none" stroke="{SOFT}"/>'
        labels = sorted(self.labels)
        heights = spread([height for height, _, _ in labels], SIZE + 1, self.y + self.height)
        names = [
            text(self.x + self.width + 6, height + 4, name, 11, fill=fill)
            for height, (_, name, fill) in zip(heights, labels)
        ]
        return "\n".join(self.parts + [frame] + names)


def chart(width, height, title, footer, panels, legend=""):
    """A whole picture: a title, a line that says what the marks mean, panels, and where the data is from."""
    body = "\n".join(panel.svg() for panel in panels)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif">\n'
        f'<rect width="{width}" height="{height}" fill="#ffffff"/>\n'
        f"{text(16, 24, title, 15, weight='bold')}\n{text(16, 44, legend, 11, fill=SOFT)}\n{body}\n{text(16, height - 8, footer, 10, fill=SOFT)}\n</svg>\n"
    )
