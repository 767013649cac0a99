"""The command line."""

import pathlib

from common import command_line
from common.command_line import positive

DESCRIPTION = """\
Looks for faults for a given time, and counts what was tried, held and found. The same command goes on where the last
one ended; the page that it writes, DIR/report.md, covers all of them."""
EPILOG = """\
example:
  tools/campaign --minutes 10"""


def parse(words):
    parser = command_line.parser("campaign", DESCRIPTION, EPILOG)
    add = parser.add_argument
    amount = parser.add_mutually_exclusive_group(required=True)
    amount.add_argument("--minutes", metavar="N", type=positive, help="time of this sitting, shared by all parts")
    amount.add_argument(
        "--planted",
        metavar="N",
        type=positive,
        help="instead of looking for faults, plant N of them, one at a time, in a copy of the last commit, and ask the "
        "tests; this takes some minutes for each fault",
    )
    add("--only", metavar="PART", help="look for faults in one of the parts alone, such as fuzz")
    add("--gpu", action="store_true", help="look for faults of the simulation on a GPU instead of all others")
    add("--out", metavar="DIR", type=pathlib.Path, default=pathlib.Path("runs/campaign"), help="folder for results (%(default)s)")
    given = parser.parse_args(words)
    if given.planted and (given.only or given.gpu):
        parser.error("--planted: plants faults in place of all parts; leave out --only and --gpu")
    return given
