"""Finds the package under test, and makes small runs."""

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
# the package with its compiled module, if there is one
sys.path.insert(0, os.environ.get("EVODEVO_PYTHON", str(ROOT / "tools/python")))

SMALL = """
[experiment]
seed = 7
evaluations = 24
population = 6
[encoding]
name = "ENCODING"
[[mutation]]
name = "MUTATION"
[scene.gravity]
[scene.floor]
[scene.friction]
[scene.damping]
[development]
cycles = 2
cycle_time = 0.05
[[development.operator]]
name = "spring-turnover"
springs = 2
[[fitness]]
name = "distance"
settle = 0.05
window = 0.1
[[fitness]]
name = "actuation-work"
settle = 0.05
window = 0.1
[[fitness]]
name = "descriptor"
what = "height"
range = [0.0, 1.0]
settle = 0.05
window = 0.1
[selection]
name = "age-fitness-pareto"
"""


def evodevo(*arguments):
    """Calls the program and returns what it prints on standard output."""
    command = [os.environ["EVODEVO_PROGRAM"], *map(str, arguments)]
    return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout


def make_run(folder, encoding='voxel"\nsize = [2, 2, 1]\nedge = 0.5\n#"', mutation="reset-weight", options=()):
    """Makes a small run in folder/run and returns its folder."""
    file = Path(folder, "small.toml")
    file.write_text(SMALL.replace("ENCODING", encoding).replace("MUTATION", mutation), encoding="utf-8")
    evodevo("run", file, "--out", Path(folder, "run"), "--device", "cpu", "--no-report", "--quiet", *options)
    return Path(folder, "run")
