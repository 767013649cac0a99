import os
import subprocess
import sys

from . import arguments

files = arguments.parse(sys.argv[1:])  # answers --help before loading Matplotlib, which may be missing

from common import charts  # noqa: E402

from . import environments, run  # noqa: E402

*read, out = files
try:
    charts.save(environments.figure(*read) if len(read) == 1 else run.figure(os.environ["EVODEVO_PROGRAM"], *read), out)
except subprocess.CalledProcessError as failed:  # evodevo has printed the reason
    sys.exit(failed.returncode)
except (OSError, ValueError) as error:
    sys.exit(f"figure: {error}")
