"""Questions asked before the runs: pairs of experiments whose best robots are compared, together at one level of
significance, and only as far as verification confirms them."""

import dataclasses

from common.command_line import Failure

from . import inference
from .standings import INTERVAL, number, table

# differences that the answer "no" excludes: A12 of more than a small effect, and the same the other way round
SMALL = (0.36, 0.64)
TEXT = f"""\
These pairs were named before the report was made (`--question`). The score of a run is that of its best robot at the
end of the run. **Held**: the runs whose best robot verification did not mark, in each experiment. **All**: all runs,
those with a marked best robot as the worst. A12 and its interval are those of the runs that held; p (Holm) allows for
all rows of the table. The answer is *better* or *worse* if p (Holm) is below {inference.SIGNIFICANT} in both tests, with the same
direction; *no* if it is in neither and the interval of A12 lies within {SMALL[0]} to {SMALL[1]}, so that no more than a small effect is
possible; and *open* otherwise.
"""


def parse(text, names):
    """Parses `A:B`, where both are names of experiments in the report."""
    pair = tuple(text.split(":"))
    if len(pair) != 2 or pair[0] == pair[1]:
        raise Failure(f"--question {text}: expected A:B, the names of two experiments")
    for name in pair:
        if name not in names:
            raise Failure(f"--question {text}: no experiment has the name {name}; give two of {', '.join(names)}")
    return pair


@dataclasses.dataclass(frozen=True)
class Test:
    """One sample compared with another. More is better."""

    a: list
    b: list

    @property
    def p(self):
        return inference.rank_sum_test(self.a, self.b) if self.a and self.b else 1.0

    @property
    def a12(self):
        return inference.superiority(self.a, self.b) if self.a and self.b else 0.5

    @property
    def interval(self):
        return inference.superiority_interval(self.a12, len(self.a), len(self.b)) if self.a and self.b else (0.0, 1.0)


def final_scores(runs, objective, of_marked):
    """Returns the scores of runs at their end, more being better. Where the best robot is marked, it is `of_marked`, or
    left out if that is None."""
    scores = objective.upwards([run.best[-1] for run in runs])
    marked = [bool(run.marks) for run in runs]
    return [of_marked if bad else score for score, bad in zip(scores, marked) if not bad or of_marked is not None]


def answer(held, holm_held, holm_all, a12_all):
    significant = [p < inference.SIGNIFICANT for p in (holm_held, holm_all)]
    if all(significant) and (held.a12 > 0.5) == (a12_all > 0.5):
        return "better" if held.a12 > 0.5 else "worse"
    low, high = held.interval
    return "no" if not any(significant) and SMALL[0] <= low and high <= SMALL[1] else "open"


def section(histories, objective, pairs):
    """Returns the section on the questions, or an empty text if there are none."""
    if not pairs:
        return ""
    runs = {variant.name: some for variant, some in histories.items()}

    def tests(of_marked):
        return [Test(*(final_scores(runs[name], objective, of_marked) for name in pair)) for pair in pairs]

    worst = min(objective.worst, -objective.worst)
    held, every = tests(None), tests(worst)
    holm_held, holm_all = (inference.holm([test.p for test in some]) for some in (held, every))
    header = ["", "held", f"median {objective.name}", "A12", INTERVAL, "p (Holm), held", "p (Holm), all", "answer"]
    rows = []
    for i, (a, b) in enumerate(pairs):
        samples = held[i].a, held[i].b
        medians = [number(inference.median(objective.upwards(some))) if some else "-" for some in samples]
        rows.append(
            [
                f"`{a}`, beside `{b}`",
                " and ".join(f"{len(some)} of {len(runs[name])}" for some, name in zip(samples, (a, b))),
                " and ".join(medians),
                f"{held[i].a12:.2f}",
                "{:.2f} to {:.2f}".format(*held[i].interval),
                f"{holm_held[i]:.2g}",
                f"{holm_all[i]:.2g}",
                answer(held[i], holm_held[i], holm_all[i], every[i].a12),
            ]
        )
    return f"## Questions\n\n{TEXT}\n{table(header, rows)}"
