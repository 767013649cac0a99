"""The command line. This module imports nothing that takes a long time to load."""

import argparse
import pathlib

from common import command_line
from common.command_line import positive

DESCRIPTION = """\
Runs each experiment with several seeds and compares the fitness of their best robots, after equal numbers of
evaluations and after equal numbers of spring evaluations. Writes a report with medians and effect sizes, each with its
interval, with rank tests of all experiments against one of them, with the shares of failed evaluations, and a chart.
If the experiments have the same descriptors, it also compares coverage and QD score of their maps of niches.
With --signal, it also compares the best robots in lives to come.
If the experiments have scenarios, it also compares the best robots in each scenario that the experiments share.
The same command continues a comparison that was stopped; more seeds, experiments or values may be added. Of each
complete run, the folder `rows` keeps what the report needs, so that runs need not be kept. With
--launcher slurm it only submits what is not complete; called again, it says whether the job has ended, and then makes
the report."""
EXAMPLE = """\
example:
  tools/compare experiments/evo.toml experiments/evo-devo.toml --seeds 10 --sweep development.cycle_time=0.5,1,2"""


def seeds(text):
    """Reads a number of seeds, which begin with 1, or FIRST..LAST."""
    first, dots, last = text.partition("..")
    found = range(0)
    if first.isdecimal() and (last.isdecimal() or not dots):
        found = range(int(first), int(last) + 1) if dots else range(1, int(first) + 1)
    if not found:
        raise argparse.ArgumentTypeError(f"{text}: expected a whole number of at least 1, or FIRST..LAST, such as 101..150")
    return found


def parse(words):
    parser = command_line.parser("compare", DESCRIPTION, EXAMPLE)
    add = parser.add_argument
    add("experiments", metavar="EXPERIMENT.toml", nargs="+", type=pathlib.Path)
    add("--seeds", metavar="N", type=seeds, default="10", help="runs of each: N, with seeds 1 to N, or FIRST..LAST (10)")
    add(
        "--sweep", metavar="KEY=V,V,…", action="append", default=[], help="try each value, if KEY's table exists"
    )
    add("--set", metavar="KEY=VALUE", action="append", default=[], help="set a value, if KEY's table exists")
    add(
        "--random",
        action="store_true",
        help="also make each experiment without islands as a random search at the same cost, in which nobody has children",
    )
    add(
        "--signal",
        metavar="ROBOTS",
        type=positive,
        help="measure each run with `evodevo signal --robots ROBOTS`: what repeats, what children inherit, lives to come",
    )
    add("--against", metavar="NAME", help="experiment to test the others against, as named in the report (the first)")
    add(
        "--question",
        metavar="A:B",
        action="append",
        default=[],
        help="test whether experiment A is better than B, once for all questions and with verified robots alone",
    )
    add(
        "--jobs",
        metavar="N",
        type=positive,
        help="runs in parallel, which share cores, GPUs or ranks (1; with --launcher slurm as many as Slurm starts)",
    )
    add(
        "--launcher",
        choices=("local", "mpi", "slurm"),
        default="local",
        help="local: on this host, several runs in one process; mpi: each run has several ranks, started by srun in a job "
        "of Slurm and by mpirun elsewhere; slurm: one job array, whose tasks are the runs (%(default)s)",
    )
    add("--ranks", metavar="N", type=positive, help="with mpi: ranks of each run (the tasks of a job / --jobs)")
    add(
        "--sbatch",
        metavar="OPTION",
        action="append",
        default=[],
        help="with slurm: an option of sbatch, such as --sbatch=--time=4:00:00 or --sbatch=--gpus-per-task=1",
    )
    add("--out", metavar="DIR", type=pathlib.Path, help="folder for results (runs/compare-FIRST_EXPERIMENT)")
    return parser.parse_args(words)
