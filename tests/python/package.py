"""Finds the package under test, and makes small runs."""

import os
import subprocess
import sys
from pathlib import Path

from small_experiment import small_experiment

ROOT = Path(__file__).resolve().parents[2]
# the package with its compiled module, if there is one
sys.path.insert(0, os.environ.get("EVODEVO_PYTHON", str(ROOT / "tools/python")))

OBJECTIVE = """
[[fitness]]
name = "{}"
settle = 0.05
window = 0.1
"""
SMALL = small_experiment(development=True, evaluations="24\nseed = 7", population=6, size="[2, 2, 1]")
SMALL = SMALL.replace("threads = 1\n", "")  # as many as there are cores
SMALL += OBJECTIVE.format("actuation-work") + OBJECTIVE.format('descriptor"\nwhat = "height"\nrange = [0.0, 1.0]\n#')
VOXELS = 'name = "voxel"\nsize = [2, 2, 1]\nedge = 0.5\n'


def evodevo(*arguments):
    """Calls the program and returns what it prints on standard output."""
    command = [os.environ["EVODEVO_PROGRAM"], *map(str, arguments)]
    return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout


def make_run(folder, encoding=VOXELS, mutation="reset-weight", options=()):
    """Makes a small run in folder/run and returns its folder. `encoding`: the text of that table."""
    file = Path(folder, "small.toml")
    file.write_text(SMALL.replace(VOXELS, encoding).replace("reset-weight", mutation), encoding="utf-8")
    evodevo("run", file, "--out", Path(folder, "run"), "--device", "cpu", "--no-report", "--quiet", *options)
    return Path(folder, "run")
