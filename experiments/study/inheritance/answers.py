"""The answers to the questions of the plan of this study."""

from compare import inference, questions
from compare.standings import INTERVAL, median_with_interval, number, table
from scipy import stats

QUESTIONS = (
    ("Does it matter that the random numbers of development are inherited?", "stress", "individual"),
    ("Does it matter that selection sees several lives of each robot?", "stress", "stress-one-life"),
    ("Do robots that develop by stress walk farther than robots that do not develop?", "stress", "evo"),
    ("Does it matter where springs come and go?", "stress", "random-places"),
    ("Does it matter that each spring has its own stress?", "stress", "shuffled-stress"),
)
LEARNT = ("Does what is learnt in life become inborn?", "stress")
SMALL = 0.1  # a change of the share that is left without development, within which nothing has become inborn
WHOLE = 0.5  # body lengths: of less, no share is told


def share(part, whole, to=1.0):
    """Returns the share of a distance, between 0 and `to`; None if it is unknown or the whole is too little."""
    if part is None or whole is None or whole <= WHOLE:
        return None
    within = max(0.0, part / whole)
    return within if to is None else min(within, to)


def held_and_all(runs):
    """Returns the distances of the runs whose best robot is not marked, and those of all, marked ones as the worst."""
    held = [run["same draws"] for run in runs.values() if not run["marked, %"]]
    return held, held + [-1.0] * (len(runs) - len(held))


def change(shares, first, last):
    """Returns the changes of a share in the runs in which both are known."""
    return [run[last] - run[first] for run in shares.values() if None not in (run.get(first), run.get(last))]


def signed_rank_test(changes):
    """Returns the two-sided p of Wilcoxon's signed-rank test."""
    return float(stats.wilcoxon(changes).pvalue) if any(changes) else 1.0


def inborn(changes, holm):
    low, high = inference.median_interval(changes) or (-1.0, 1.0)
    if holm < inference.SIGNIFICANT:
        return "yes" if inference.median(changes) > 0 else "less"
    return "no" if -SMALL <= low and high <= SMALL else "open"


def section(distances, shares, first, last):
    """Returns the section on those questions whose arms are there, or an empty text if there are none. `distances` and
    `shares`: of each arm and run; `first` and `last`: the columns of `shares` that are compared."""
    asked = [question for question in QUESTIONS if set(question[1:]) <= distances.keys()]
    changes = change(shares.get(LEARNT[1], {}), first, last)
    if not asked and not changes:
        return ""
    held, every = [], []
    for _, a, b in asked:
        samples = held_and_all(distances[a]), held_and_all(distances[b])
        held.append(questions.Test(*(sample[0] for sample in samples)))
        every.append(questions.Test(*(sample[1] for sample in samples)))
    p = [signed_rank_test(changes)] if changes else []
    holm_held, holm_all = (inference.holm([*(test.p for test in some), *p]) for some in (held, every))
    lines = []
    for i, (text, a, b) in enumerate(asked):
        answer = questions.answer(held[i], holm_held[i], holm_all[i], every[i].a12)
        lines.append(
            [
                text,
                f"`{a}`, `{b}`",
                f"{len(held[i].a)} of {len(distances[a])}, {len(held[i].b)} of {len(distances[b])}",
                f"{number(inference.median(held[i].a))}, {number(inference.median(held[i].b))}",
                f"{held[i].a12:.2f}",
                "{:.2f} to {:.2f}".format(*held[i].interval),
                f"{holm_held[i]:.2g}",
                f"{holm_all[i]:.2g}",
                {"better": "yes: more", "worse": "yes: less"}.get(answer, answer),
            ]
        )
    header = ["", "arms", "held", "medians", "A12", INTERVAL, "p (Holm), held", "p (Holm), all", "answer"]
    text = f"## Answers\n\n{table(header, lines)}" if lines else "## Answers\n\n"
    if changes:
        text += (
            f"\n{LEARNT[0]} In {len(changes)} runs of `{LEARNT[1]}`, the share of the distance that is left without "
            f"development changed from {first} to {last} by {median_with_interval(changes)} (median, {INTERVAL}), "
            f"p (Holm) {holm_held[-1]:.2g}: {inborn(changes, holm_held[-1])}.\n"
        )
    return text
