#!/usr/bin/env python3
"""Changes one ingredient of small walkers at a time, and draws how fast the best robots walk.

  tools/evodevo run experiments/quickstart.toml   # builds evodevo
  EVODEVO_PROGRAM=build/cpu/bin/evodevo experiments/study/walker/ingredients.py runs/walker-study

The walkers are those of neural.toml. Every run has the same number of evaluations, and verifies whoever would enter the
front. A champion that does not hold at the end counts for nothing.
The same command continues a study that was stopped.
"""

import argparse
import concurrent.futures
import csv
import json
import os
import pathlib
import statistics
import subprocess

HERE = pathlib.Path(__file__).resolve().parent
WALKER = HERE / "neural.toml"
MUSCLES = ("muscle", "muscle2")
MATERIALS = (*MUSCLES, "tissue", "bone")


def of(materials, key, value):
    return {f"materials.{material}.{key}": value for material in materials}


# ingredient and its value in neural.toml -> another value, as the figure shows it -> settings or a file
INGREDIENTS = {
    "as it is": {"": {}},
    "damping in space, 1/s (5)": {str(rate): {"scene.damping.rate": rate} for rate in (0.5, 2, 20)},
    "damping in springs, ζ (0.5)": {str(ratio): of(MATERIALS, "damping", ratio) for ratio in (0.1, 1.0)},
    "friction (1)": {str(mu): {"scene.friction.coefficient": mu} for mu in (0.5, 2.0)},
    "frequency, Hz (4)": {str(f): of(MUSCLES, "frequency", f) for f in (2.0, 8.0)},
    "amplitude (0.2)": {str(a): of(MUSCLES, "amplitude", a) for a in (0.1, 0.3)},
    "points (64)": {str(n): {"encoding.points": n} for n in (32, 128)},
    "neighbours (12)": {str(n): {"encoding.neighbours": n} for n in (8, 20)},
    "encoding (neural)": {"neat": HERE / "neat.toml", "voxel": HERE / "voxel.toml"},
    "genes per mutation (4)": {str(n): {"mutation.0.genes": n} for n in (1, 16)},
    "population (30)": {str(n): {"experiment.population": n} for n in (10, 100)},
    "selection (age-fitness-pareto)": {"elitist": {"selection.name": "elitist"}},
}


def command(change):
    """Returns the arguments of `evodevo run` for a change: settings, or an experiment of its own."""
    file, settings = (WALKER, change) if isinstance(change, dict) else (change, {})
    return [str(file), *(word for key, value in settings.items() for word in ("--set", f"{key}={value}"))]


def run(program, out, ingredient, value, change, seed):
    """Makes a run unless it is there, and returns its champion as a row of results.csv."""
    folder = out / f"{ingredient.split(',')[0].split(' (')[0]} {value} {seed}".replace(" ", "-")
    if not (folder / "done").exists():
        subprocess.run(["rm", "-rf", folder], check=True)
        words = [program, "run", *command(change), "--seed", str(seed), "--quiet", "--no-report", "--out", str(folder)]
        subprocess.run(words, check=True, stdout=subprocess.DEVNULL)
        (folder / "done").touch()
    shown = subprocess.run([program, "show", str(folder), "--json"], check=True, stdout=subprocess.PIPE, text=True)
    best = json.loads(shown.stdout)["best"]
    if best is None:
        return {"ingredient": ingredient, "value": value, "seed": seed, "distance": "", "champion": "no robot with a fitness"}
    marks = ", ".join(best["verification"]["marks"]) or "verified"
    return {"ingredient": ingredient, "value": value, "seed": seed, "distance": best["objectives"]["distance"], "champion": marks}


def draw(rows, file):
    import matplotlib

    matplotlib.use("svg")
    import matplotlib.pyplot as plt

    places = list(dict.fromkeys((row["ingredient"], row["value"]) for row in rows))
    figure, axes = plt.subplots(figsize=(8, 0.28 * len(places) + 1.2), layout="constrained")
    for y, place in enumerate(places):
        of_place = [row for row in rows if (row["ingredient"], row["value"]) == place]
        held = [row["distance"] for row in of_place if row["champion"] == "verified"]
        axes.plot(held, [y] * len(held), "o", color="tab:blue", alpha=0.6, markersize=5)
        if held:
            axes.plot(statistics.median(held), y, "|", color="black", markersize=14)
        if len(held) < len(of_place):
            axes.text(1.01, y, f"{len(held)} of {len(of_place)}", transform=axes.get_yaxis_transform(), va="center", fontsize=8)
    axes.set_yticks(range(len(places)), [f"{ingredient}  {value}" for ingredient, value in places])
    axes.invert_yaxis()
    held_as_it_is = [row["distance"] for row in rows if row["ingredient"] == "as it is" and row["champion"] == "verified"]
    if held_as_it_is:
        axes.axvline(statistics.median(held_as_it_is), color="grey", linewidth=0.5)
    axes.set_xlabel("distance of verified champions in 10 s, body lengths (| median)")
    axes.grid(axis="x", linewidth=0.3)
    figure.savefig(file)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=pathlib.Path, help="folder for the runs, results.csv and ingredients.svg")
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--jobs", type=int, default=1, help="runs in parallel")
    given = parser.parse_args()
    program = os.environ.get("EVODEVO_PROGRAM", str(HERE.parents[2] / "tools/evodevo"))
    tasks = [
        (program, given.out, ingredient, value, change, seed)
        for seed in range(1, given.seeds + 1)
        for ingredient, values in INGREDIENTS.items()
        for value, change in values.items()
    ]
    given.out.mkdir(parents=True, exist_ok=True)
    with concurrent.futures.ThreadPoolExecutor(given.jobs) as pool:
        rows = list(pool.map(lambda task: run(*task), tasks))
    with open(given.out / "results.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    draw(rows, given.out / "ingredients.svg")


if __name__ == "__main__":
    main()
