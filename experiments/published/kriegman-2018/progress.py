#!/usr/bin/env python3
"""Compares the runs of the experiments in this folder at equal numbers of generations, even if they are not complete.

  export PYTHONPATH=build/cpu/lib/python3.11/site-packages
  python3 experiments/published/kriegman-2018/progress.py runs/kriegman-2018 --figure medians.svg

Prints the median of the best distances so far, with its interval, after some generations and after the last one that
every run has reached. There it tests the difference, as tools/compare does for complete runs. Prints how many robots
failed, and the time that the runs took.

Needs evodevo's Python package (tools/python/README.md), SciPy, and Matplotlib for the figure.
"""

import argparse
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.append(str(ROOT / "tools/parts"))

try:
    import evodevo
    from compare import history, runs, standings
except ImportError as error:
    sys.exit(f"progress: {error}; this needs SciPy, and evodevo's Python package in PYTHONPATH: see "
             "tools/python/README.md")

GENERATIONS = [100, 300, 1000, 2000, 3000]
DISTANCE = history.Quantity("distance", "body lengths", maximise=True)


def history_of(folder):
    """Returns the history of a run, in which generation 0 counts as the first."""
    table = evodevo.Run(folder).generations.reset_index()
    generations = [row | {"map": None} for row in table.to_dict("records")]
    return history.history({"generations": generations, "best": None, "map": None}, DISTANCE)


def histories_of(folder):
    """Returns a dictionary from the experiments, as runs.Variant, to the histories of their runs."""
    histories = {}
    for file in sorted(folder.glob("runs/*/seed-*/run.sqlite")):
        experiment = runs.Variant(pathlib.Path(f"{file.parts[-3]}.toml"))
        histories.setdefault(experiment, []).append(history_of(file.parent))
    return histories


def report(histories):
    """Prints the tables."""
    last = min(run.generations[-1] for of_one in histories.values() for run in of_one)
    rows = []
    for generation in [*(some for some in GENERATIONS if some < last), last]:
        best = ([run.at("generations", generation, "best") for run in of_one] for of_one in histories.values())
        rows.append([str(generation), *map(standings.median_with_interval, best)])
    print(standings.table(["generation", *(f"`{experiment.name}`" for experiment in histories)], rows))
    if len(histories) > 1:
        print(standings.comparison(histories, DISTANCE, "generations", last, next(iter(histories)).name))
    for experiment, of_one in histories.items():
        reached = [run.generations[-1] for run in of_one]
        failed = sum(run.diverged[-1] + run.invalid[-1] for run in of_one)
        print(f"{experiment.name}: {len(of_one)} runs of {min(reached)} to {max(reached)} generations, {failed} robots "
              f"failed, {sum(run.evaluations[-1] for run in of_one)} lives, "
              f"{sum(run.spring_evaluations[-1] for run in of_one):.3g} spring evaluations, "
              f"{sum(run.seconds[-1] for run in of_one) / 3600:.1f} hours of runs side by side")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path, help="of the comparison, that is, --out of tools/compare")
    parser.add_argument("--figure", type=pathlib.Path, help="draw the medians over evaluations into this SVG or PNG")
    arguments = parser.parse_args()
    histories = histories_of(arguments.folder)
    if not histories:
        sys.exit(f"{arguments.folder}: has no runs; give the folder that tools/compare wrote, which holds runs/")
    report(histories)
    if arguments.figure:
        from common import charts
        from compare import chart

        page = chart.figure(histories, [(DISTANCE, "evaluations")], "best distance so far", chart.drawn(histories))
        page.axes[0].set_ylabel(DISTANCE.unit)
        charts.save(page, arguments.figure)


if __name__ == "__main__":
    main()
