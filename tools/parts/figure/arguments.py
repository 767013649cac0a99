"""The command line, without what takes long to load."""

import argparse
import pathlib

DESCRIPTION = """\
Draws a run: its fitness over evaluations, and its best robot as it moves, seen from the side. The robot is matured as in
its life, settles for ten seconds in the experiment's scene, and is shown in the next ten.

Given the file that `tools/evodevo environments FILE.toml... --json` prints, draws the bodies that one genome grows in
several scenes, side by side: under each body its scene's distance from the first, and beside them how far scenes are
apart after each cycle, and starts within a scene."""
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
