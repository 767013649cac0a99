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
    add("--minutes", metavar="N", type=positive, required=True, help="time of this sitting, shared by all parts")
    add("--out", metavar="DIR", type=pathlib.Path, default=pathlib.Path("runs/campaign"), help="folder for results (%(default)s)")
    return parser.parse_args(words)
