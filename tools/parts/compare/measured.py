"""What scripts of studies have measured of each run, by arm and run: as tables, and as a file of numbers."""

import csv
import statistics

from .standings import median_with_interval, number, table


def report(title, of_arms, means=()):
    """Returns a table of medians over the runs, or of means in the columns named by `means`. `of_arms`: for each arm and
    each run the numbers that were measured of it by their columns; None if there is none."""
    columns = list(dict.fromkeys(column for runs in of_arms.values() for run in runs.values() for column in run))

    def cell(runs, column):
        numbers = [run[column] for run in runs.values() if run.get(column) is not None]
        if not numbers:
            return "-"
        return number(statistics.fmean(numbers)) if column in means else median_with_interval(numbers)

    lines = [[f"`{arm}`", str(len(runs)), *(cell(runs, column) for column in columns)] for arm, runs in of_arms.items()]
    return f"## {title}\n\n{table(['', 'runs', *columns], lines)}"


def write_csv(known, file):
    """Writes each number: of which arm and run, and what it is. `known`: pairs of the title of a table and `of_arms` of
    report()."""
    with file.open("w", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(["arm", "run", "outcome", "quantity", "value"])
        for title, of_arms in known:
            for arm, runs in of_arms.items():
                for name, run in runs.items():
                    writer.writerows([arm, name, title, *each] for each in run.items() if each[1] is not None)
