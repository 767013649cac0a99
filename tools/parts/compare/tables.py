"""Writes the numbers of a comparison for other programs."""

import csv
import math


def cell(values, generation):
    return "" if values is None or math.isinf(values[generation]) else values[generation]


def write_csv(file, histories, seeds):
    """Writes one line for each generation of each run, with what history.History has of it. A score is empty if no
    individual has a fitness yet; `coverage` and `qd_score` are empty if the run has none."""
    with open(file, "w", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        columns = ["evaluations", "spring_evaluations", "best", "coverage", "qd_score", "diverged", "invalid", "refused"]
        writer.writerow(["experiment", "seed", *columns, "seconds"])
        for variant, runs in histories.items():
            for seed, run in zip(seeds, runs):
                for generation in run.generations[1:]:
                    cells = [cell(getattr(run, column), generation) for column in columns]
                    writer.writerow([variant.name, seed, *cells, f"{run.seconds[generation]:.3f}"])


def write_scenarios_csv(file, histories, seeds):
    """Writes the score of the best robot of each run in each scenario of its experiment; one line for each."""
    with open(file, "w", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(["experiment", "seed", "scenario", "score"])
        for variant, runs in histories.items():
            for seed, run in zip(seeds, runs):
                writer.writerows([variant.name, seed, *score] for score in run.scenarios.items())
