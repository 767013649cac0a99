import os
import sys

from . import arguments

arguments.parse(sys.argv[1:])  # answers --help before loading SciPy and Matplotlib, which may be missing

from . import command  # noqa: E402

sys.exit(command.main(sys.argv[1:], os.environ["EVODEVO_PROGRAM"]))
