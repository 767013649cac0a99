import os
import sys

from . import arguments

arguments.parse(sys.argv[1:])  # answers --help before SciPy and Matplotlib are loaded, which may not be there

from . import command  # noqa: E402

sys.exit(command.main(sys.argv[1:], os.environ["EVODEVO_PROGRAM"]))
