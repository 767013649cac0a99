"""A folder of tables that a measuring program has written, and the charts of it."""

import csv
import pathlib
import sys

from common import charts


def read(folder, name):
    """Rows as dictionaries; numbers as numbers, an empty cell as None. Nothing where there is no such table."""

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
    """Rows by the values of some columns, in the order in which they come."""
    found = {}
    for row in rows:
        found.setdefault(tuple(row[key] for key in keys), []).append(row)
    return found


def draw(figures, tool, arguments):
    """The whole of a program that draws the charts of a folder: `figures` maps a name to the function that
    makes that figure from the folder and the origin of its data, or None if the data is not there."""
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
