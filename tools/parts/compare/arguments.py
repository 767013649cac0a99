"""The command line, without what takes long to load."""

import argparse
import pathlib

DESCRIPTION = """\
Runs experiments over seeds and reports how their best robots compare, at equal evaluations and at equal spring
evaluations: medians and effect sizes with intervals, rank tests against one of the experiments, failures, a chart.
A stopped comparison goes on with the same command; more seeds, experiments or values may be added."""
EXAMPLE = """\
example:
  tools/compare experiments/evo.toml experiments/evo-devo.toml --seeds 10 --sweep development.cycle_time=0.5,1,2"""


def positive(text):
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"{text}: expected a whole number of at least 1")
    return int(text)


def parse(words):
    parser = argparse.ArgumentParser(
        "tools/compare",
        description=DESCRIPTION,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        epilog=EXAMPLE,
        allow_abbrev=False,
    )
    add = parser.add_argument
    add("experiments", metavar="EXPERIMENT.toml", nargs="+", type=pathlib.Path)
    add("--seeds", metavar="N", type=positive, default=10, help="runs of each; seeds 1 to N (%(default)s)")
    add(
        "--sweep", metavar="KEY=V,V,…", action="append", default=[], help="values in turn, where KEY's table is there"
    )
    add("--set", metavar="KEY=VALUE", action="append", default=[], help="a value, where KEY's table is there")
    add("--against", metavar="NAME", help="what the others are tested against, by its name in the report (the first)")
    add("--jobs", metavar="N", type=positive, default=1, help="runs at once, which share the cores (%(default)s)")
    add("--out", metavar="DIR", type=pathlib.Path, help="default: runs/compare-FIRST, FIRST the first experiment")
    return parser.parse_args(words)
