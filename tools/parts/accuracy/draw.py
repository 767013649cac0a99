"""Draws the charts of a folder that tools/accuracy has written. Charts whose data is missing are left out."""

import sys

import numpy
from matplotlib.colors import LinearSegmentedColormap, ListedColormap, Normalize

from common import charts, results
from common.charts import BLUE, GREEN, INK, ORANGE, PURPLE, SKY, SOFT, VERMILION, note
from common.results import groups, read

COLOUR = {
    "paper-euler": BLUE,
    "symplectic-euler": SKY,
    "velocity-verlet": GREEN,
    "rk4": ORANGE,
    "implicit": VERMILION,
    "xpbd": PURPLE,
}
DEFAULT = ("paper-euler", "float", 0.0005)  # method, precision, dt in s
DASHES = {"float": "-", "double": (0, (4, 2))}
PRECISIONS = "solid line: float · dashed line: double"


def is_default(row):
    return (row["method"], row["precision"], row["dt (s)"]) == DEFAULT


def front(points):
    """Returns the (cost, error) points for which no other point is better in both."""
    best, kept = float("inf"), []
    for point in sorted(points):
        if point[1] < best:
            best = point[1]
            kept.append(point)
    return kept


def column(rows, name):
    return [row[name] for row in rows]


def around(values, factor=1.6):
    """Returns limits of a logarithmic axis that leave room around the values."""
    return min(values) / factor, max(values) * factor


def draw_method(axes, rows, x, y, method, precision):
    """Draws the line of one method in one precision, with a point for each row."""
    colour = COLOUR[method]
    inside = "white" if precision == "double" else colour
    across, up = column(rows, x), column(rows, y)
    axes.plot(across, up, color=colour, linestyle=DASHES[precision], marker="o", markerfacecolor=inside)


def ring(axes, point):
    axes.plot(*point, marker="o", markersize=10, markerfacecolor="none", markeredgecolor=INK, gid="defaults")


def draw_scene_of_work(axes, scene, reference, rows):
    cost, error, ceiling = "cost (s per simulated s)", "error (1)", "noise ceiling (1)"
    kept = [row for row in rows if row[error] is not None and row[error] < 1]
    noise = rows[0][ceiling]
    lowest = min(column(kept, error))
    axes.set(title=scene, xlabel="seconds of computing per simulated second", ylabel="relative error")
    charts.make_logarithmic(axes, "xy")
    axes.set(xlim=around(column(kept, cost)))
    axes.set_ylim(max(1e-10, min(lowest, noise or lowest) / 2), 1)
    axes.text(1.04, 1.02, f"reference: {reference}", transform=axes.transAxes, color=SOFT, fontsize=7)
    axes.plot(*zip(*front([(row[cost], row[error]) for row in kept])), color="#d9d9d9", linewidth=7, zorder=1)
    if noise:
        axes.axhline(noise, color=SOFT, linestyle="--", linewidth=0.8)
        note(axes, (axes.get_xlim()[0], noise), "the reference, started 1e-9 m away", (3, 6), color=SOFT)
    labels = []
    for (method, precision), points in groups(kept, "method", "precision").items():
        draw_method(axes, points, cost, error, method, precision)
        if precision == "double":
            labels.append((method, (points[-1][cost], points[-1][error]), COLOUR[method]))
    for row in filter(is_default, kept):
        ring(axes, (row[cost], row[error]))
    charts.label_ends(axes, labels)


def work_precision(folder, origin):
    rows = read(folder, "work_precision")
    if rows is None:
        return None
    scenes = groups(rows, "scene", "reference")
    figure, panels = charts.page(
        len(scenes),
        3,
        (2.7, 2.6),
        title="Work against precision: the largest error of any mass's place, relative to the farthest way of any mass",
        legend=f"{PRECISIONS} · one point for each dt, none where the error is above 1 or the body diverges · "
        "grey: the front · ring: the defaults",
        footer=origin,
    )
    for axes, ((scene, reference), of_scene) in zip(panels, scenes.items()):
        draw_scene_of_work(axes, scene, reference, of_scene)
    return figure


def draw_ranking(axes, rows, quantity, title, name, has_intervals):
    cost = "cost (s per simulated s)"
    settings = [row for row in rows if row["kind"] == "setting"]
    coarser = [row for row in rows if row["kind"] == "coarser body"]
    ceiling = next(row for row in rows if row["kind"].startswith("reference"))[quantity]
    cheapest, dearest = around(column(settings + coarser, cost))
    axes.set(title=title, xlabel="seconds of computing per simulated second of a robot", ylabel=name)
    charts.make_logarithmic(axes, "x")
    axes.set(xlim=(cheapest / 10, dearest), ylim=(min(0.0, *column(settings + coarser, quantity)), 1.05))
    axes.axhline(ceiling, color=SOFT, linestyle="--", linewidth=0.8)
    note(axes, (cheapest / 10, ceiling), f"the reference, started 1e-9 m away: {ceiling:.3f}", (3, 6), color=SOFT)
    for life in (row[quantity] for row in rows if row["kind"] == "another life"):
        axes.axhline(life, color=SOFT, linestyle=":", linewidth=1.2)
        note(axes, (cheapest / 10, life), f"another life, started 1e-4 m away: {life:.3f}", (3, -12), color=SOFT)
    labels = []
    for (method, precision), points in groups(settings, "method", "precision").items():
        draw_method(axes, points, cost, quantity, method, precision)
        if has_intervals:
            lows, highs = column(points, "low (1)"), column(points, "high (1)")
            axes.vlines(column(points, cost), lows, highs, color=COLOUR[method], linewidth=0.8, alpha=0.5)
        if precision == "float":
            labels.append((method, (points[0][cost], points[0][quantity]), COLOUR[method]))
    axes.plot(column(coarser, cost), column(coarser, quantity), "o", color=SOFT, markersize=4)
    for row in filter(is_default, settings):
        ring(axes, (row[cost], row[quantity]))
        note(axes, (row[cost], row[quantity]), "defaults", (9, -12))
    charts.label_ends(axes, labels)
    charts.label_column(axes, 0.3, [(row["body"], (row[cost], row[quantity]), SOFT) for row in coarser], "right")


def ranking(folder, origin):
    rows = read(folder, "ranking")
    if rows is None:
        return None
    steps = sorted({row["dt (s)"] for row in rows if row["kind"] == "setting"})
    scenes = groups(rows, "scene")
    figure, panels = charts.page(
        2 * len(scenes),
        2,
        (4.4, 3.8),
        title="What evolution sees: the fitness of random robots under each setting against the reference",
        legend=f"{rows[0]['robots']:.0f} robots · {PRECISIONS} · dt from {steps[-1] * 1e3:g} ms (left) to "
        f"{steps[0] * 1e3:g} ms (right) · bars: 95 % intervals · grey: coarser bodies with the defaults",
        footer=origin,
    )
    for i, ((scene,), in_scene) in enumerate(scenes.items()):
        title = f"Rank correlation of fitness with the reference, {scene}"
        draw_ranking(panels[2 * i], in_scene, "rank correlation (1)", title, "rank correlation with the reference", True)
        title = f"How often the best of 20 is among the reference's best 3, {scene}"
        draw_ranking(panels[2 * i + 1], in_scene, "best of 20 in reference's best 3 (1)", title, "share", False)
    return figure


def draw_convergence(axes, scene, in_contact, rows, order):
    dt, error = "dt (s)", "error (1)"
    kept = [row for row in rows if row[error] is not None and 1e-13 < row[error] < 10]
    axes.set(title=f"{scene} ({'with' if in_contact else 'no'} contact)", xlabel=dt, ylabel="relative error")
    charts.make_logarithmic(axes, "xy")
    axes.set(xlim=around(column(kept, dt)), ylim=around(column(kept, error)))
    labels = []
    for (method,), line in groups(kept, "method").items():
        axes.plot(column(line, dt), column(line, error), color=COLOUR[method], marker="o", markersize=2.5)
        name = f"{method}: order {order[scene, method]:.2f}"
        labels.append((name, (line[0][dt], line[0][error]), COLOUR[method]))
    charts.label_ends(axes, labels)


def orders(folder, origin):
    rows, found = read(folder, "convergence"), read(folder, "orders")
    if rows is None or found is None:
        return None
    order = {(row["scene"], row["method"]): row["observed order"] for row in found}
    scenes = groups(rows, "scene", "contact")
    figure, panels = charts.page(
        len(scenes),
        2,
        (4, 2.8),
        title="Error over dt in double: the slope is the order of convergence",
        legend="order: by least squares over the four smallest dt whose errors stand above rounding; with contact, over all dt up to 0.5 ms",
        footer=origin,
        right=1.7,
    )
    for axes, ((scene, contact), of_scene) in zip(panels, scenes.items()):
        draw_convergence(axes, scene, contact == "yes", of_scene, order)
    return figure


def energy(folder, origin):
    rows = read(folder, "energy")
    if rows is None:
        return None
    key = "energy (of the first)"
    precisions = groups(rows, "precision")
    title = "Energy without damping: three methods keep it, rk4 loses it slowly, implicit and xpbd damp all but turning"
    figure, panels = charts.page(len(precisions), 2, (4, 3.2), title=title, footer=origin, right=1.7)
    for axes, ((precision,), of_precision) in zip(panels, precisions.items()):
        axes.set(title=precision, xlabel="steps of 0.5 ms", ylabel="energy, of the first")
        charts.make_logarithmic(axes, "y")
        axes.set(xlim=(0, max(column(rows, "steps"))), ylim=(max(1e-6, min(column(rows, key)) / 2), 2))
        labels = []
        for (method,), line in groups(of_precision, "method").items():
            axes.plot(column(line, "steps"), column(line, key), color=COLOUR[method])
            labels.append((f"{method} {line[-1][key]:.3g}", (line[-1]["steps"], line[-1][key]), COLOUR[method]))
        charts.label_ends(axes, labels)
    return figure


def grid(rows, x, y, value):
    """Returns the x coordinates, the y coordinates and the array of values of rows that fill a grid."""
    xs, ys = sorted({row[x] for row in rows}), sorted({row[y] for row in rows})
    values = {(row[x], row[y]): row[value] for row in rows}
    return xs, ys, numpy.array([[values[across, up] for across in xs] for up in ys])


def draw_stability(axes, method, cells, boundary):
    c, h = "damping rate * dt (1)", "angular frequency * dt (1)"
    axes.set(title=method, xlabel="damping rate · dt", ylabel="angular frequency · dt", xlim=(0, 3), ylim=(0, 6))
    axes.grid(False)
    colours = ListedColormap(["#f3c9b0", "white"])
    axes.pcolormesh(*grid(cells, c, h, "bounded"), cmap=colours, norm=Normalize(0, 1), shading="nearest", rasterized=True)
    for bound, is_drawn in (("highest", lambda at: at is not None and at <= 6), ("lowest", lambda at: at > 0)):
        line = [(row[c], row[f"{bound} {h}"]) for row in boundary if is_drawn(row[f"{bound} {h}"])]
        if line:
            axes.plot(*zip(*line), color=COLOUR[method], linewidth=1.8)
    note(axes, (0.1, 0.4), "bounded", (0, 0), color=SOFT)
    note(axes, (0.1, 5.6), "measured: diverges", (0, 0), color="#a34b1f")


def draw_gain(axes, rows):
    phase, gain = "dt * sqrt(floor stiffness / mass) (1)", "largest gain of a bounce (1)"
    axes.set(title="Largest gain of a bounce", xlabel="dt · √(floor stiffness / mass)", ylabel="energy after / before")
    charts.make_logarithmic(axes, "y")
    axes.set(xlim=(0, 2), ylim=(0.01, 20))
    axes.axhline(1, color=SOFT, linestyle="--", linewidth=0.8)
    axes.axvline(1.2, color=SOFT, linestyle="--", linewidth=0.8)
    note(axes, (1.2, 0.1), "limit 1.2", (4, 0), color=SOFT)
    labels = []
    for (method,), line in groups(rows, "method").items():
        axes.plot(column(line, phase), column(line, gain), color=COLOUR[method])
        labels.append((method, (line[-1][phase], line[-1][gain]), COLOUR[method]))
    bound = "bound of the Euler methods (1)"
    line = [(row[phase], row[bound]) for row in rows if row["method"] == "rk4" and row[bound] < 20]
    axes.plot(*zip(*line), color=INK, linewidth=1, linestyle=":")
    note(axes, (0.2, 2.6), "1/(1 − κ/4), κ = k dt²/m", (0, 0))
    rigid = "largest gain on a rigid floor (1)"
    axes.plot(column(rows, phase), column(rows, rigid), ".", color=INK, markersize=2, gid="rigid")
    note(axes, (0.05, 0.75), "dots: rigid floor, restitution 1", (0, 0))
    charts.label_ends(axes, labels)


def draw_gain_map(axes, rows):
    m, k, gain = "mass (kg)", "floor stiffness (N/m)", "largest gain of a bounce (1)"
    dt = 0.0005  # time step, s
    axes.set(title="The same for paper-euler at 0.5 ms", xlabel=m, ylabel=k)
    charts.make_logarithmic(axes, "xy")
    axes.grid(False)
    colours = LinearSegmentedColormap.from_list("gain", ["white", "#a33b10"])
    masses, floors, gains = grid(rows, m, k, gain)
    shown = axes.pcolormesh(masses, floors, numpy.log2(gains), cmap=colours, norm=Normalize(0, 4), shading="nearest", rasterized=True)
    limits = axes.get_xlim(), axes.get_ylim()
    for limit, name, floor, align in ((1.2, "limit 1.2", 3e5, "left"), (2, "limit 2: diverges", 4e6, "right")):
        axes.plot([dt**2 * at / limit**2 for at in limits[1]], limits[1], color=INK, linewidth=1, linestyle="--")
        offset = (6, 0) if align == "left" else (-6, 0)
        note(axes, (dt**2 * floor / limit**2, floor), name, offset, ha=align)
    axes.set(xlim=limits[0], ylim=limits[1])
    for mass, offset in ((0.1, (4, 9)), (0.2, (5, -8))):
        axes.plot(mass, 1e6, "o", color=INK)
        note(axes, (mass, 1e6), f"{mass:g} kg", offset)
    bar = axes.figure.colorbar(shown, cax=axes.inset_axes([1.04, 0, 0.05, 0.6]), ticks=range(5))
    bar.ax.set_yticklabels(["≤ 1", "2", "4", "8", "≥ 16"])


def draw_divergence(axes, rows):
    m, k, dt, share = "mass (kg)", "floor stiffness (N/m)", "dt (s)", "diverged (1)"
    kept = "kept by the best ten at dt / 4 (1)"
    floors = {
        floor: sorted((row for row in rows if row["floor"] == floor and row[dt] == 0.0005 and row[k] in (1e6, None)), key=lambda row: row[m])
        for floor in ("elastic", "rigid")
    }
    of_paper, on_rigid = floors["elastic"], floors["rigid"]
    axes.set(title=f"Of {of_paper[0]['bodies']:.0f} random bodies, diverged", xlabel=m, xscale="log")
    axes.set(ylabel="share, at 0.5 ms; blue: 10⁶ N/m", ylim=(-0.02, max(0.1, 1.15 * max(column(rows, share)))))
    ticks = [0.05, 0.1, 0.2, 0.3]
    axes.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    axes.set_xticks([], minor=True)
    axes.axvline(0.5e-3**2 * 1e6 / 1.2**2, color=SOFT, linestyle="--", linewidth=0.8)
    axes.plot(column(of_paper, m), column(of_paper, share), color=COLOUR["paper-euler"], marker="o")
    axes.plot(column(on_rigid, m), column(on_rigid, share), color=INK, marker="o", markersize=3, gid="rigid")
    said = [
        f"{row[m]:g} kg, {row[dt] * 1e3:g} ms, {'rigid' if row[k] is None else f'{row[k] / 1e6:g}·10⁶ N/m'}: {100 * row[share]:.1f} %"
        for row in rows
        if row not in of_paper and row not in on_rigid
    ]
    for row in of_paper:
        if row[m] in (0.1, 0.2):
            note(axes, (row[m], row[share]), f"{100 * row[share]:.1f} %", (5, 9))
            if row[kept] is not None:
                said.append(f"{row[m]:g} kg: the best ten keep {100 * row[kept]:.0f} % of their fitness at dt / 4")
    if on_rigid:
        shares = [row[kept] for row in on_rigid if row[kept] is not None]
        low, high = min(shares), max(shares)
        said += ["black: rigid floor; the best ten keep", f"{100 * low:.1f} to {100 * high:.1f} % of their fitness at dt / 4"]
    note(axes, (0.5e-3**2 * 1e6 / 1.2**2, axes.get_ylim()[1] * 0.95), "limit 1.2", (4, 0), color=SOFT)
    axes.text(1.04, 1, "\n".join(said), transform=axes.transAxes, va="top", color=SOFT, fontsize=7)


def stability(folder, origin):
    cells = read(folder, "stability_map")
    if cells is None:
        return None
    methods, boundary = groups(cells, "method"), read(folder, "stability_boundary")
    figure, panels = charts.page(
        len(methods) + 3,
        len(methods),
        (2.3, 2.5),
        title="Stability: without contact dt has the limit of theory; with contact energy grows well below it",
        legend="above: a spring, where it diverges as measured (cells) and in theory (line) · below: contact with the floor",
        footer=origin,
        right=1,
    )
    for axes, ((method,), rows) in zip(panels, methods.items()):
        draw_stability(axes, method, rows, [row for row in boundary if row["method"] == method])
    draw_gain(panels[-3], read(folder, "contact_gain"))
    draw_gain_map(panels[-2], read(folder, "contact_map"))
    draw_divergence(panels[-1], read(folder, "divergence"))
    return figure


def features(folder, origin):
    rows = read(folder, "features")
    if rows is None:
        return None
    key = "cost (% of the time without it)"
    figure, (axes,) = charts.page(1, 1, (4, 0.3 * len(rows)), title="What each part of a scene costs", footer=origin, left=1.2)
    bars = axes.barh(column(rows, "feature"), column(rows, key), height=0.6, color=BLUE)
    axes.bar_label(bars, [f"{row[key]:.1f} %" for row in rows], padding=4)
    axes.invert_yaxis()
    axes.set(xlabel="% of the time without it")
    axes.margins(x=0.15)
    return figure


def beam(folder, origin):
    rows = read(folder, "beam")
    if rows is None:
        return None
    size = "length (voxels)"
    title = "A beam held at one end tends to that of Euler and Bernoulli"
    figure, (axes,) = charts.page(1, 1, (4, 2.6), title=title, footer=origin)
    axes.set(xlabel=size, ylabel="simulated / Euler-Bernoulli", xscale="log", xlim=(4, 50), ylim=(0.94, 1.06))
    axes.set_xticks([5, 10, 20, 40], ["5", "10", "20", "40"])
    axes.set_xticks([], minor=True)
    labels = []
    for name, colour in (("deflection (m)", BLUE), ("first frequency (Hz)", VERMILION)):
        ratio = [row[name] / row[f"Euler-Bernoulli {name}"] for row in rows]
        axes.plot(column(rows, size), ratio, color=colour, marker="o")
        labels.append((name.split(" (")[0], (rows[-1][size], ratio[-1]), colour))
    charts.label_ends(axes, labels)
    return figure


CHARTS = {
    "work_precision": work_precision,
    "ranking": ranking,
    "orders": orders,
    "energy": energy,
    "stability": stability,
    "features": features,
    "beam": beam,
}

if __name__ == "__main__":
    results.draw(CHARTS, "accuracy", sys.argv[1:])
