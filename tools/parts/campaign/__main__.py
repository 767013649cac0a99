import os
import sys

from . import arguments

given = arguments.parse(sys.argv[1:])  # answers --help before loading tomlkit, which may be missing

from . import command  # noqa: E402

sys.exit(command.main(given, os.environ["EVODEVO_PROGRAM"]))
