"""A complete experiment of small voxel robots, whose evaluations take milliseconds."""

import re

TEXT = """\
[experiment]
evaluations = 20
population = 5

[encoding]
name = "voxel"
size = [2, 1, 1]
edge = 0.5

[[mutation]]
name = "reset-weight"

[scene.gravity]
[scene.floor]
[scene.friction]
[scene.damping]

[simulation]
device = "cpu"
threads = 1

[[fitness]]
name = "distance"
settle = 0.05
window = 0.1

[selection]
name = "age-fitness-pareto"
"""

DEVELOPMENT = """
[development]
cycles = 2
cycle_time = 0.05

[[development.operator]]
name = "spring-turnover"
springs = 2
"""


def small_experiment(development=False, **values):
    """Returns its text with other values for some of its keys, each given as it is written in TOML, and with development
    if asked for."""
    text = TEXT + (DEVELOPMENT if development else "")
    for key, value in values.items():
        text, found = re.subn(rf"^{key} = .*$", f"{key} = {value}", text, flags=re.MULTILINE)
        assert found == 1, f"{key}: {found} times in the experiment"
    return text
