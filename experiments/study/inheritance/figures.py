"""The figure of this study: how far the best robots go in lives to come, and what is left of it without development."""

from common import charts
from compare import chart, inference
from compare.standings import INTERVAL

WAYS = {"same draws": charts.BLUE, "new draws": charts.VERMILION}
APART = 0.18  # half of the distance between the two columns of an arm


def draw_lives(axes, distances):
    for i, (arm, runs) in enumerate(distances.items()):
        for way, place in zip(WAYS, (i - APART, i + APART)):
            numbers = [run[way] for run in runs.values() if run.get(way) is not None]
            if numbers:
                chart.draw_column(axes, place, numbers, WAYS[way])
    axes.set(title="distance in nine lives to come (body lengths)", xlim=(-0.5, len(distances) - 0.5))
    axes.set_ylim(bottom=0)
    axes.set_xticks(range(len(distances)), [arm.replace("-", "-\n") for arm in distances])
    axes.grid(axis="x", visible=False)


def draw_shares(axes, shares):
    """Draws the medians of the shares over the runs, and for each arm its name."""
    axes.set(title="share that is left without development", ylim=(-0.02, 1.02))
    ends = []
    for (arm, runs), (colour, dashes) in zip(shares.items(), chart.STYLES):
        columns = list(dict.fromkeys(column for run in runs.values() for column in run))
        points = []
        for place, column in enumerate(columns):
            numbers = [run[column] for run in runs.values() if run.get(column) is not None]
            if numbers:
                middle = inference.median(numbers)
                points.append((place, middle, *(inference.median_interval(numbers) or (middle, middle))))
        if not points:
            continue
        places, middles, low, high = zip(*points)
        axes.fill_between(places, low, high, color=colour, alpha=0.12, linewidth=0)
        axes.plot(places, middles, dashes, color=colour)
        axes.set_xticks(range(len(columns)), columns)
        ends.append((arm, points[-1][:2], colour))
    charts.label_ends(axes, ends)


def figure(distances, shares):
    """`distances` and `shares`: of each arm and run, as the report tells them. Without arms that develop, there is no
    panel of shares."""
    page, panels = charts.page(
        2 if shares else 1,
        1,
        (max(4.0, 0.62 * len(distances)), 3.2),
        title="Lives to come of the best robots",
        legend=f"blue: with the draws of the run, orange: with new ones; points: runs; medians with {INTERVAL}",
        right=1.5,
    )
    draw_lives(panels[0], distances)
    if shares:
        draw_shares(panels[1], shares)
    return page
