"""The command line. This module imports nothing that takes a long time to load."""

import argparse
import pathlib

DESCRIPTION = """\
Draws a run: its fitness over evaluations, and the motion of its best robot, seen from the side. The robot develops as
in its life and settles in the experiment's scene as long as its first fitness lets it. The figure shows the ten seconds
after that.

Given a file with the output of `tools/evodevo environments FILE.toml... --json`, draws side by side the bodies that
one genome develops in several scenes. Below each body is its distance from the body in the first scene. Beside them, a
chart shows the distance between bodies after each cycle: between scenes, and between perturbed starts in one scene."""
EXAMPLE = """\
examples:
  tools/figure runs/quickstart-1 experiments/quickstart.toml quickstart.svg
  tools/figure environments.json environments.png"""


def parse(words):
    parser = argparse.ArgumentParser(
        "tools/figure",
        usage="tools/figure RUN_FOLDER EXPERIMENT.toml OUT.svg|OUT.png\n       tools/figure ENVIRONMENTS.json OUT.svg|OUT.png",
        description=DESCRIPTION,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        epilog=EXAMPLE,
    )
    parser.add_argument("files", nargs="+", type=pathlib.Path, help=argparse.SUPPRESS)
    files = parser.parse_args(words).files
    if len(files) not in (2, 3):
        parser.error("expected a run's folder, its experiment and the file to write, or two files")
    out = files[-1]
    if out.suffix not in (".svg", ".png"):
        parser.error(f"{out}: expected a name that ends in .svg or .png")
    for file in files[:-1]:
        if out.exists() and file.exists() and out.samefile(file):
            parser.error(f"{out}: is {file}, which is read; name another file to write")
    return files
