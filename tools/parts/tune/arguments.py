"""The command line. This module imports nothing that takes a long time to load."""

import pathlib

from common import command_line
from common.command_line import positive

DESCRIPTION = """\
Tunes keys of an experiment by iterated racing (López-Ibáñez et al. 2016). Configurations, that is, values for the keys,
are run with the same seeds. After five seeds, and after every further one, configurations that are clearly worse drop
out; new ones are then drawn around the best. A run's score is the first objective of its best robot, or the worst
possible one if verification marks that robot. Writes a report, a chart, the scores of all runs, and best.toml: the
experiment with the best values in their place. The same command continues a race that was stopped."""
EPILOG = """\
ranges:
  KEY=LOW..HIGH       whole numbers if both ends are written as whole numbers, otherwise real numbers
  KEY=LOW..HIGH:log   the same, drawn by their logarithm
  KEY=V,V,…           any values, such as names of operators

example:
  tools/tune experiments/quickstart.toml --over development.operator.0.springs=2..64:log --budget 108"""


def parse(words):
    parser = command_line.parser("tune", DESCRIPTION, EPILOG)
    add = parser.add_argument
    add("experiment", metavar="EXPERIMENT.toml", type=pathlib.Path)
    add("--over", metavar="KEY=RANGE", action="append", required=True, help="tune KEY, whose table must exist")
    add("--budget", metavar="N", type=positive, required=True, help="largest number of runs, all of equal cost")
    add("--set", metavar="KEY=VALUE", action="append", default=[], help="set a value in all runs; best.toml is without it")
    add("--seed", metavar="N", type=positive, default=1, help="seed of the drawn configurations (%(default)s)")
    add("--jobs", metavar="N", type=positive, default=1, help="runs in parallel, which share cores and GPUs (%(default)s)")
    add(
        "--launcher",
        choices=("local", "mpi"),
        default="local",
        help="local: on this host, several runs in one process; mpi: each run has several ranks, started by srun in a job "
        "of Slurm and by mpirun elsewhere (%(default)s)",
    )
    add("--ranks", metavar="N", type=positive, help="with mpi: ranks of each run (the tasks of a job / --jobs)")
    add("--out", metavar="DIR", type=pathlib.Path, help="folder for results (runs/tune-EXPERIMENT)")
    return parser.parse_args(words)
