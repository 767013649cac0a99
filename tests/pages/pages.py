"""Code that the tests of pages share: the list of pages, their blocks, and a small run for trying commands."""

import os
import re
import subprocess
import unittest
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = os.environ.get("EVODEVO_PROGRAM", str(ROOT / "tools/evodevo"))
NOT_OURS = {"build", "runs", "node_modules", ".git", ".cache"}
# templates of `evodevo new`, with placeholders for names
TEMPLATE = ROOT / "framework/template"


class PageTest(unittest.TestCase):
    def assert_none(self, faults):
        self.assertFalse(faults, "".join(f"\n  {fault}" for fault in faults))


class Block(NamedTuple):
    page: Path
    line: int  # number of its first line of text, counted from 1
    text: str

    def __str__(self):
        return f"{name(self.page)}:{self.line}"


def name(page):
    return str(page.relative_to(ROOT)) if page.is_relative_to(ROOT) else str(page)


def all_pages():
    found = []
    for folder, folders, files in os.walk(ROOT):
        folders[:] = sorted(f for f in folders if f not in NOT_OURS and Path(folder, f) != TEMPLATE)
        found += [Path(folder, file) for file in sorted(files) if file.endswith(".md")]
    return found


def blocks(page, language):
    """Returns the fenced blocks of a language, in order."""
    found, start, fence = [], None, ""
    lines = page.read_text(encoding="utf-8").splitlines()
    for number, line in enumerate(lines, 1):
        if start is None and (opening := re.fullmatch(r" *(```+|~~~+)(\w*).*", line)):
            fence, start, is_wanted = opening[1], number, opening[2] == language
        elif start is not None and line.strip() == fence:
            if is_wanted:
                found.append(Block(page, start + 1, "\n".join(lines[start:number - 1]) + "\n"))
            start = None
    if start is not None:
        raise ValueError(f"{name(page)}:{start}: the block has no end")
    return found


def prose(page):
    """Yields the lines of a page outside fenced blocks, with their numbers."""
    inside = False
    for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), 1):
        if re.match(r" *(```|~~~)", line):
            inside = not inside
        elif not inside:
            yield number, line


def evodevo(*arguments, folder=None, check=True):
    environment = {key: value for key, value in os.environ.items() if not key.startswith("EVODEVO_PLUGIN")}
    finished = subprocess.run([PROGRAM, *arguments], cwd=folder, env=environment, text=True, capture_output=True)
    if check and finished.returncode != 0:
        raise AssertionError(f"evodevo {' '.join(arguments)} ended with {finished.returncode}:\n{finished.stderr}")
    return finished


# settings with which a life takes a few milliseconds; after so short a time, most robots would be passive
SHRINK = [word for key in ("experiment.evaluations=24", "experiment.population=6", "encoding.points=24",
                           "development.cycle_time=0.1", "fitness.0.settle=0", "fitness.0.window=0.1",
                           "experiment.verify_front=off", "simulation.device=cpu") for word in ("--set", key)]


def make_small_run(folder, *options):
    evodevo("run", str(ROOT / "experiments/quickstart.toml"), "--out", str(folder), *SHRINK, *options)
