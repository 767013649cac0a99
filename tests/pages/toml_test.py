"""Tests that `evodevo check` accepts every TOML block of every page. Tables that a block leaves out are taken from a
complete experiment; the block's tables replace those of the same name."""

import re
import tempfile
import tomllib
import unittest
from pathlib import Path

from pages import ROOT, Block, PageTest, all_pages, blocks, evodevo

HEADER = re.compile(r"\[\[?([\w.-]+)\]\]? *(?:#.*)?")
ORDER = ["experiment", "encoding", "mutation", "crossover", "scene", "simulation", "development",
         "development.operator", "fitness", "selection", "materials", "plugins"]
# operators that a reader of the page builds
OWN_OPERATORS = ["erosion", "my-lab.growth"]


def sections(block):
    """Returns the tables of a block, as (name, text)."""
    found = []
    for offset, line in enumerate(block.text.splitlines(keepends=True)):
        if header := HEADER.fullmatch(line.rstrip()):
            found.append([header[1], ""])
        elif not found and not line.lstrip().startswith("#") and line.strip():
            raise AssertionError(f"{block.page}:{block.line + offset}: begin the block with the name of a table")
        if found:
            found[-1][1] += line
    return found


def position(name):
    places = [i for i, known in enumerate(ORDER) if name == known or name.startswith(known + ".")]
    return max(places, default=len(ORDER))


def completed(block, base):
    given = sections(block)
    names = {name for name, _ in given}
    if {"encoding", "mutation", "fitness", "selection"} <= names:
        return block.text  # the block is a complete experiment
    tables = [table for table in base if table[0] not in names] + given
    return "".join(text for _, text in sorted(tables, key=lambda table: position(table[0])))


def fault_of(block, base, folder):
    text = completed(block, base)
    for operator in OWN_OPERATORS:
        text = text.replace(f'"{operator}"', '"spring-turnover"')
    try:
        paths = tomllib.loads(text).get("plugins", {}).get("paths", [])
    except tomllib.TOMLDecodeError as error:
        return f"{block}: {error}"
    for path in paths:
        Path(folder, path).mkdir(parents=True, exist_ok=True)
    file = Path(folder, "experiment.toml")
    file.write_text(text, encoding="utf-8")
    checked = evodevo("check", str(file), check=False)
    return None if checked.returncode == 0 else f"{block}: {checked.stderr}"


class Toml(PageTest):
    def test_of_all_pages_is_accepted(self):
        quickstart = ROOT / "experiments/quickstart.toml"
        base = sections(Block(quickstart, 1, quickstart.read_text(encoding="utf-8")))
        found = [block for page in all_pages() for block in blocks(page, "toml")]
        self.assertGreater(len(found), 5)
        with tempfile.TemporaryDirectory() as folder:
            self.assert_none([fault for block in found if (fault := fault_of(block, base, folder))])


unittest.main()
