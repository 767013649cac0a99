"""Draws the bodies that one genome develops in several scenes, side by side, and the distances between them."""

import json
import statistics

from matplotlib.transforms import Affine2D

from common import charts

from .bodies import BLUE, RED, show_ground, springs

COLUMNS = 4


def captions(answer):
    """Returns lines of text for each scene: the distance of its body from that in the first scene after the last cycle,
    by springs and by mass."""
    lines = [[] for _ in answer["scenes"]]
    for pair in answer["pairs"]:
        if pair["scenes"][0] != 0:
            continue
        for kind in ("springs", "mass"):
            effect = pair[kind][-1]
            if effect is None:
                continue
            line = f"{kind} {effect['between']:.3f}"
            if effect["p"] is not None:
                line += f" (noise {effect['within']:.3f}, p = {effect['p']:.4f})"
            lines[pair["scenes"][1]].append(line)
    return lines


def extent(bodies):
    """Returns the largest distance along x of a mass from the middle of its body, and the height of the highest mass,
    both in m and at least 0.5."""
    reach, height = 0.5, 0.5
    for body in filter(None, bodies):
        xs = [mass["position"][0] for mass in body["masses"]]
        reach = max(reach, max(abs(x - statistics.fmean(xs)) for x in xs))
        height = max(height, max(mass["position"][2] for mass in body["masses"]))
    return reach, height


def draw_body(axes, scene, body, lines, reach, height):
    show_ground(axes, -reach, reach, height)
    below = "\n".join([scene["name"], *lines])
    axes.text(0.5, -0.05, below, transform=axes.transAxes, ha="center", va="top", fontsize=7.5)
    if body is None:
        axes.text(0.5, 0.5, scene["starts"][0]["reason"], transform=axes.transAxes, ha="center", color=charts.SOFT)
        return
    places = [mass["position"] for mass in body["masses"]]
    drawn = springs(body, places, -statistics.fmean(place[0] for place in places))
    axes.add_collection(drawn)
    # rotates the drawing by the slope, on which +x points downhill
    for artist in (drawn, *axes.lines):
        artist.set_transform(Affine2D().rotate_deg(-scene["slope"]) + axes.transData)
        artist.set_clip_on(False)


def draw_distances(axes, pairs):
    """Draws the share of springs that only one of two bodies has, against cycles. One line is the mean over all pairs
    of scenes, the other one the mean over pairs of perturbed starts in the same scene."""
    cycles = range(len(pairs[0]["springs"]))
    axes.set(title="springs that only one body has", xlabel="cycles")
    labels = []
    for key, name, colour in (("between", "scenes", RED), ("within", "noise", BLUE)):
        points = []
        for cycle in cycles:
            effects = [pair["springs"][cycle] for pair in pairs]
            values = [effect[key] for effect in effects if effect and effect[key] is not None]
            if values:
                points.append((cycle + 1, statistics.fmean(values)))
        if points:
            axes.plot(*zip(*points), color=colour, marker="o")
            labels.append((f"{name} {points[-1][1]:.2f}", points[-1], colour))
    axes.set_ylim(bottom=0)
    axes.xaxis.get_major_locator().set_params(integer=True)
    charts.label_ends(axes, labels)


def is_answer(value):
    return isinstance(value, dict) and {"individual", "scenes", "pairs"} <= value.keys()


def figure(file):
    answers = json.loads(file.read_text())
    if not (isinstance(answers, list) and answers and all(is_answer(each) for each in answers)):
        raise ValueError(f"{file}: is not the output of tools/evodevo environments --json; give that")
    # each individual begins a new row; it has a panel for each scene, and one for the distances if there are any
    rows = [-(-(len(answer["scenes"]) + bool(answer["pairs"])) // COLUMNS) for answer in answers]
    page, panels = charts.page(COLUMNS * sum(rows), COLUMNS, (2, 1.8), left=0.4, right=0.8)
    for axes in panels:
        axes.set_visible(False)
    first = 0
    for answer, used in zip(answers, rows):
        bodies = [scene["starts"][0].get("body") for scene in answer["scenes"]]
        reach, height = extent(bodies)
        places = iter(panels[first : first + COLUMNS * used])
        panels[first].set_title(f"individual {answer['individual']}")
        # zip() reads `places` last, so that it skips no panel when the other lists end
        for scene, body, lines, axes in zip(answer["scenes"], bodies, captions(answer), places):
            axes.set_visible(True)
            draw_body(axes, scene, body, lines, reach, height)
        if answer["pairs"]:
            axes = next(places)
            axes.set_visible(True)
            draw_distances(axes, answer["pairs"])
        first += COLUMNS * used
    return page
