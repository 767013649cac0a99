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
RUNS = {"study": 50, "repetition": 20}  # of each arm, that the plan asks for
SMALL = 0.1  # a change of the share that is left without development, within which nothing has become inborn
WHOLE = 0.5  # body lengths: of less, no share is told

BESIDE = ("random-search", "evo")  # the arms beside which all are told


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


def changes_of(shares, runs, first, last):
    """Returns the changes of a share in the runs whose best robot is not marked and in which both are known, and those in
    all runs, in which nothing is inborn in a marked robot."""
    held, every = [], []
    for name, run in shares.items():
        is_marked = bool(runs[name]["marked, %"])
        if run.get(first) is None or (run.get(last) is None and not is_marked):
            continue
        every.append((0.0 if is_marked else run[last]) - run[first])
        if not is_marked:
            held.append(every[-1])
    return held, every


def signed_rank_test(changes):
    """Returns the two-sided p of Wilcoxon's signed-rank test, and the sum of the ranks with their signs."""
    if not any(changes):
        return 1.0, 0.0
    other = [change for change in changes if change]
    ranks = stats.rankdata([abs(change) for change in other])
    signed = sum(rank if change > 0 else -rank for rank, change in zip(ranks, other))
    return float(stats.wilcoxon(changes).pvalue), float(signed)


def inborn(held, holms, signs):
    """Returns the answer to the question on learning. `holms` and `signs`: of the runs that held, and of all."""
    low, high = inference.median_interval(held) or (-1.0, 1.0)
    significant = [holm < inference.SIGNIFICANT for holm in holms]
    if all(significant) and (signs[0] > 0) == (signs[1] > 0):
        return "yes" if signs[0] > 0 else "less"
    return "no" if not any(significant) and -SMALL <= low and high <= SMALL else "open"


def missing(distances, runs):
    """Returns what is not there yet of the arms of the questions, each as a text."""
    arms = sorted({arm for question in QUESTIONS for arm in question[1:]})
    return [f"`{arm}` has {len(distances.get(arm, ()))}" for arm in arms if len(distances.get(arm, ())) < runs]


def section(distances, shares, first, last, kind="study"):
    """Returns the section with the answers, which are there once all runs have been measured; before, what is there is
    compared. `distances` and `shares`: of each arm and run; `first` and `last`: the columns of `shares` that are compared.
    A repetition asks nothing about learning."""
    text = "## Answers\n"
    if lacking := missing(distances, RUNS[kind]):
        text += f"\nNone yet: of the {RUNS[kind]} runs of each arm, {', '.join(lacking)}.\n"
    if any(not distances.get(arm) for question in QUESTIONS for arm in question[1:]):
        return text
    held, every = [], []
    for _, a, b in QUESTIONS:
        samples = held_and_all(distances[a]), held_and_all(distances[b])
        held.append(questions.Test(*(sample[0] for sample in samples)))
        every.append(questions.Test(*(sample[1] for sample in samples)))
    ps = [[test.p for test in some] for some in (held, every)]
    if kind == "study" and not lacking:
        changes = changes_of(shares[LEARNT[1]], distances[LEARNT[1]], first, last)
        tested = [signed_rank_test(some) for some in changes]
        ps = [[*some, p] for some, (p, _) in zip(ps, tested)]
    holm_held, holm_all = map(inference.holm, ps)
    lines = []
    for i, (question, a, b) in enumerate(QUESTIONS):
        answer = questions.answer(held[i], holm_held[i], holm_all[i], every[i].a12)
        lines.append(
            [
                question,
                f"`{a}`, `{b}`",
                f"{len(held[i].a)} of {len(distances[a])}, {len(held[i].b)} of {len(distances[b])}",
                f"{number(inference.median(held[i].a))}, {number(inference.median(held[i].b))}",
                f"{held[i].a12:.2f}",
                "{:.2f} to {:.2f}".format(*held[i].interval),
                f"{holm_held[i]:.2g}",
                f"{holm_all[i]:.2g}",
                "-" if lacking else {"better": "yes: more", "worse": "yes: less"}.get(answer, answer),
            ]
        )
    header = ["", "arms", "held", "medians", "A12", INTERVAL, "p (Holm), held", "p (Holm), all", "answer"]
    text += f"\n{table(header, lines)}"
    if kind == "study" and not lacking:
        answer = inborn(changes[0], (holm_held[-1], holm_all[-1]), [sign for _, sign in tested])
        text += (
            f"\n{LEARNT[0]} In {len(changes[0])} runs of `{LEARNT[1]}` that held, the share of the distance that is left "
            f"without development changed from {first} to {last} by {median_with_interval(changes[0])} (median, "
            f"{INTERVAL}); p (Holm) {holm_held[-1]:.2g}, and {holm_all[-1]:.2g} in all runs: {answer}.\n"
        )
    return text


def superiority(runs, way, others):
    """Returns A12 of the distances of an arm, with its interval, against `others`, with the draws of their runs."""
    pairs = ((runs, way), (others, "same draws"))
    a, b = ([run[key] for run in some.values() if run[key] is not None] for some, key in pairs)
    if not a or not b:
        return "-"
    test = questions.Test(a, b)
    return "{:.2f} ({:.2f} to {:.2f})".format(test.a12, *test.interval)


def beside(distances):
    """Returns the section that tells each arm's A12 against random search and against no development."""
    others = [name for name in BESIDE if name in distances]
    pairs = [(way, other) for other in others for way in ("same draws", "new draws")]
    lines = [
        [f"`{arm}`", *(superiority(runs, way, distances[other]) for way, other in pairs)] for arm, runs in distances.items()
    ]
    header = ["", *(f"{way}, against `{other}`" for way, other in pairs)]
    title = "## A12 of the distances in lives to come"
    return f"{title}\n\nOf all runs, not tested, with {INTERVAL}s.\n\n{table(header, lines)}"
