#!/usr/bin/env python3
"""Simulates how fast a run gets with more and more GPUs, one rank for each, and draws the rate over the number of GPUs,
with what was measured (experiments/results/ranks/measured.csv).

  python3 experiments/study/ranks/scaling.py runs/ranks

It assumes hosts whose cores feed their GPUs; experiments/results/README.md has what up to four GPUs did in hosts that do
not. The simulation deals out jobs as framework/cluster/farm.cpp does, and takes its times from measurements of one GPU
and its host:

- ROBOT_SECONDS: the life of a robot on an idle multiprocessor of an NVIDIA H200: 1.3e4 springs, 60,000 steps in the life
  of experiments/evo-devo.toml, 220,000 in that of experiments/paper.toml, and 4.57e11 spring evaluations per second of
  132 multiprocessors that are busy all the time (experiments/results/README.md, "Speed"). Lives differ by SPREAD.
- What rank 0 does alone for each robot (seconds_breed, seconds_select and seconds_archive in the record of a run of
  65,536 robots on 16 cores of an Intel Xeon). It breeds on all threads, and writes a generation into the archive while
  the next one is evaluated.
- Messages of 100 robots: packing and unpacking, measured by themselves, and a latency as between hosts.

It also divides 10,000 GPUs among islands, of which each has a first rank that breeds, selects and writes for itself. An
island waits for the one before it on a ring every EVERY generations.
"""

import argparse
import csv
import heapq
import pathlib
import random

MEASURED = pathlib.Path(__file__).resolve().parents[2] / "results/ranks/measured.csv"
MULTIPROCESSORS = 132
SPRING_EVALUATIONS = {"evo-devo.toml": 1.33e4 * 60_000, "paper.toml": 1.33e4 * 220_000}
RATE = 4.57e11
SPREAD = 0.25
BREED = 5.8e-6  # s for each robot
ARCHIVE = 29e-6
SELECT = 7.8e-6
PACK = 5e-6  # s for each robot of a message, both directions together
MESSAGE = 20e-6  # s for each message, for rank 0
LATENCY = 50e-6  # s, of each message
JOBS, LIVES = 16, 64  # jobs that a rank with a GPU has at once, and robots in each: worker.cpp
SMALLEST = 12  # robots in a job of a small batch: smallest_cohort in evaluation.hpp
EVERY = 10  # generations from one migration to the next, the default
GENERATIONS = 100  # of each island
GENERATION = 1024  # robots for each GPU, if the population grows with the GPUs


def job_size(left, jobs, share):
    """job_size() in farm.cpp."""
    least = max(1, min(LIVES, max(share // (JOBS // 4), min(share, SMALLEST))))
    return min(left, max(least, min(4 * LIVES, left // (2 * jobs))))


def evaluation_seconds(gpus, robots, robot_seconds, rng):
    """Returns the time from the first job to the last answer."""
    free_at = [[0.0] * MULTIPROCESSORS for _ in range(gpus)]  # each a heap
    # when a rank can have a job, the number of jobs that it has then (at first), and the rank
    requests = [(0.0, job, gpu) for job in range(JOBS) for gpu in range(gpus)]
    leader_free, last, left = 0.0, 0.0, robots
    while left:
        at, _, gpu = heapq.heappop(requests)
        count = job_size(left, JOBS * gpus, -(-robots // gpus))
        left -= count
        leader_free = max(leader_free, at) + MESSAGE + count * PACK
        begin, end = leader_free + LATENCY, 0.0
        for _ in range(count):
            free = heapq.heappop(free_at[gpu])
            done = max(free, begin) + robot_seconds * rng.lognormvariate(-SPREAD**2 / 2, SPREAD)
            heapq.heappush(free_at[gpu], done)
            end = max(end, done)
        heapq.heappush(requests, (end + LATENCY, 0, gpu))
        last = max(last, end + LATENCY)
    return max(last, leader_free)


def generation_seconds(gpus, robots, robot_seconds, rng):
    """Returns the time of one generation of one population."""
    generation = robots * (BREED + SELECT) + evaluation_seconds(gpus, robots, robot_seconds, rng)
    return max(generation, robots * ARCHIVE)


def island_seconds(islands, times, rng):
    """Returns the time in which all islands make GENERATIONS generations, each of which takes one of `times`."""
    ends = [0.0] * islands
    for generation in range(GENERATIONS):
        begins = ends
        if generation and generation % EVERY == 0:
            begins = [max(ends[i], ends[i - 1] + LATENCY) for i in range(islands)]
        ends = [begin + rng.choice(times) for begin in begins]
    return max(ends)


def island_rows(name, gpus, counts):
    robot_seconds = SPRING_EVALUATIONS[name] / RATE * MULTIPROCESSORS
    rng = random.Random(1)

    def some_times(of_gpus):
        samples = max(1, 200 // of_gpus)  # the times of large groups hardly differ
        return [generation_seconds(of_gpus, GENERATION * of_gpus, robot_seconds, rng) for _ in range(samples)]

    alone = some_times(1)
    rate_alone = GENERATION * len(alone) / sum(alone)
    for islands in counts:
        seconds = island_seconds(islands, some_times(gpus // islands), rng)
        rate = GENERATION * gpus // islands * islands * GENERATIONS / seconds
        yield {"case": name, "gpus": gpus, "islands": islands, "robots_per_island": GENERATION * gpus // islands,
               "robots_per_second": f"{rate:.4g}", "of_single_gpus": f"{rate / rate_alone / gpus:.3f}"}


def rows_of(name, gpu_counts, robots_for):
    robot_seconds = SPRING_EVALUATIONS[name.split(",")[0]] / RATE * MULTIPROCESSORS
    for gpus in gpu_counts:
        robots = robots_for(gpus)
        seconds = generation_seconds(gpus, robots, robot_seconds, random.Random(gpus))
        ideal = robots * robot_seconds / MULTIPROCESSORS / gpus
        yield {"case": name, "gpus": gpus, "robots": robots, "seconds": f"{seconds:.4g}",
               "robots_per_second": f"{robots / seconds:.4g}", "of_ideal": f"{ideal / seconds:.3f}"}


def read_measured():
    """Returns the numbers of GPUs and robots per second that were measured, by how the run used the GPUs."""
    points = {}
    with MEASURED.open(newline="") as stream:
        for row in csv.DictReader(stream):
            gpus, rates = points.setdefault(f"measured: {row['used_by']}, {row['robots']}", ([], []))
            gpus.append(int(row["gpus"]))
            rates.append(float(row["robots_per_second"]))
    return points


def draw(rows, file):
    import matplotlib

    matplotlib.use("svg")
    import matplotlib.pyplot as plt

    figure, (rates, parts) = plt.subplots(1, 2, figsize=(10, 4), layout="constrained")
    for case in dict.fromkeys(row["case"] for row in rows):
        of_case = [row for row in rows if row["case"] == case]
        gpus = [row["gpus"] for row in of_case]
        rates.loglog(gpus, [float(row["robots_per_second"]) for row in of_case], "o-", markersize=3, label=case)
        parts.semilogx(gpus, [float(row["of_ideal"]) for row in of_case], "o-", markersize=3, label=case)
    for (label, points), marker in zip(read_measured().items(), "x+12*v^s", strict=False):
        rates.loglog(*points, marker, color="black", markersize=5, label=label)
    rates.set_ylabel("robots per second")
    rates.set_ylim(bottom=3)  # room for the legend
    parts.set_ylabel("part of the rate of so many GPUs (1)")
    parts.set_ylim(0, 1)
    rates.legend(fontsize=7)
    for axes in (rates, parts):
        axes.set_xlabel("GPUs")
        axes.grid(linewidth=0.3)
    figure.savefig(file)


def draw_islands(rows, file):
    import matplotlib

    matplotlib.use("svg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(figsize=(5, 4), layout="constrained")
    for case in dict.fromkeys(row["case"] for row in rows):
        of_case = [row for row in rows if row["case"] == case]
        axes.semilogx([row["islands"] for row in of_case], [float(row["of_single_gpus"]) for row in of_case], "o-",
                      markersize=3, label=case)
    axes.axhline(0.9, color="grey", linewidth=0.5)
    axes.set_xlabel(f"islands that share {rows[0]['gpus']:,} GPUs")
    axes.set_ylabel("part of the rate of so many runs on one GPU (1)")
    axes.set_ylim(0, 1)
    axes.legend(fontsize=7)
    axes.grid(linewidth=0.3)
    figure.savefig(file)


def write(rows, file):
    with open(file, "w", newline="") as stream:
        writer = csv.DictWriter(stream, rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=pathlib.Path, help="folder for the numbers and charts")
    parser.add_argument("--most", type=int, default=10_000, help="largest number of GPUs")
    given = parser.parse_args()
    counts = [n for n in (1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096, 10_000) if n <= given.most]

    def growing(gpus):
        return GENERATION * gpus

    rows = [
        *rows_of("evo-devo.toml, 1,024 robots for each GPU", counts, growing),
        *rows_of("paper.toml, 1,024 robots for each GPU", counts, growing),
        *rows_of("evo-devo.toml, 16,384 robots", counts, lambda gpus: 16_384),
    ]
    given.out.mkdir(parents=True, exist_ok=True)
    write(rows, given.out / "scaling.csv")
    draw(rows, given.out / "scaling.svg")
    islands = [n for n in (1, 10, 20, 50, 80, 100, 125, 200, 250, 500, 1000, 2000, 5000, 10_000) if given.most % n == 0]
    rows = [row for name in SPRING_EVALUATIONS for row in island_rows(name, given.most, islands)]
    write(rows, given.out / "islands.csv")
    draw_islands(rows, given.out / "islands.svg")


if __name__ == "__main__":
    main()
