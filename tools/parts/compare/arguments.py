"""The command line. This module imports nothing that takes a long time to load."""

import pathlib

from common import command_line
from common.command_line import positive

DESCRIPTION = """\
Runs each experiment with several seeds and compares the fitness of their best robots, after equal numbers of
evaluations and after equal numbers of spring evaluations. Writes a report with medians and effect sizes, each with its
interval, with rank tests of all experiments against one of them, with the shares of failed evaluations, and a chart.
If the experiments have the same descriptors, it also compares coverage and QD score of their maps of niches.
If the experiments have scenarios, it also compares the best robots in each scenario that the experiments share.
The same command continues a comparison that was stopped; more seeds, experiments or values may be added. With
--launcher slurm it only submits what is not complete; called again, it says whether the job has ended, and then makes
the report."""
EXAMPLE = """\
example:
  tools/compare experiments/evo.toml experiments/evo-devo.toml --seeds 10 --sweep development.cycle_time=0.5,1,2"""


def parse(words):
    parser = command_line.parser("compare", DESCRIPTION, EXAMPLE)
    add = parser.add_argument
    add("experiments", metavar="EXPERIMENT.toml", nargs="+", type=pathlib.Path)
    add("--seeds", metavar="N", type=positive, default=10, help="runs of each, with seeds 1 to N (%(default)s)")
    add(
        "--sweep", metavar="KEY=V,V,…", action="append", default=[], help="try each value, if KEY's table exists"
    )
    add("--set", metavar="KEY=VALUE", action="append", default=[], help="set a value, if KEY's table exists")
    add("--against", metavar="NAME", help="experiment to test the others against, as named in the report (the first)")
    add(
        "--jobs",
        metavar="N",
        type=positive,
        help="runs in parallel, which share the cores or the ranks (1; with --launcher slurm as many as Slurm starts)",
    )
    add(
        "--launcher",
        choices=("local", "mpi", "slurm"),
        default="local",
        help="local: processes on this host; mpi: each run has several ranks, started by srun in a job of Slurm and by "
        "mpirun elsewhere; slurm: one job array, whose tasks are the runs (%(default)s)",
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
