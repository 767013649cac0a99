"""Reads the tables in a folder that a measuring program has written, and draws their charts."""

import csv
import pathlib
import sys

from common import charts


def read(folder, name):
    """Returns the rows of a table as dictionaries, with numbers as floats and empty cells as None. Returns None if the
    table does not exist."""

    def value(cell):
        try:
            return float(cell)
        except ValueError:
            return cell or None

    path = folder / f"{name}.csv"
    if not path.exists():
        return None
    with open(path, newline="") as stream:
        return [{key: value(cell) for key, cell in row.items()} for row in csv.DictReader(stream)]


def groups(rows, *keys):
    """Groups rows by the values of some columns; keeps the order of the rows."""
    found = {}
    for row in rows:
        found.setdefault(tuple(row[key] for key in keys), []).append(row)
    return found


def draw(figures, tool, arguments):
    """Implements a program that draws the charts of a folder. `figures` maps the name of each chart to a function. The
    function takes the folder and a text on the origin of its data; it returns a figure, or None if its data is
    missing."""
    if len(arguments) != 1:
        sys.exit(f"{tool}: expected the name of one folder that tools/{tool} has written")
    folder = pathlib.Path(arguments[0])
    origin_file = folder / "origin.txt"
    if not origin_file.exists():
        sys.exit(f"{tool}: {origin_file} is not there; give a folder that tools/{tool} has written")
    origin = "  |  ".join(origin_file.read_text().splitlines())
    for name, make in figures.items():
        if figure := make(folder, origin):
            charts.save(figure, folder / f"{name}.svg")
