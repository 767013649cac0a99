"""Rows: what a comparison keeps of each complete run, so that the run itself need not be kept."""

import json
import os

from common.command_line import Failure

# what comparisons use of the output of `evodevo show --json`, and of each generation in it
KEYS = ("objectives", "map", "best", "provenances")
COLUMNS = (
    "evaluations",
    "spring_evaluations",
    "best",
    "diverged",
    "invalid",
    "artefact",
    "lucky",
    "passive",
    "wall_time",
    "map",
)


def provenance(shown):
    """Returns a provenance without the paths of this machine."""
    operators = [{key: value for key, value in each.items() if key != "file"} for each in shown["operators"]]
    return shown | {"operators": operators}


def pack(shown, robots):
    """Returns the row of a run, given the output of `evodevo show --json`, and how many robots were measured of it: one
    list for each quantity, instead of one object for each generation."""
    row = {key: shown[key] for key in KEYS}
    row["signal"] = (shown["signal"] or {}).get("numbers")
    row["robots"] = robots
    row["provenances"] = [provenance(each) for each in row["provenances"]]
    row["generations"] = {column: [each[column] for each in shown["generations"]] for column in COLUMNS}
    return row


def unpack(row):
    """Returns a row in the form of the output of `evodevo show --json`."""
    shown = {key: row[key] for key in KEYS}
    shown |= {"signal": row.get("signal"), "robots": row.get("robots", 0)}  # older rows have none
    generations = row["generations"]
    generations.setdefault("lucky", [0] * len(generations["evaluations"]))  # of rows of before there was this status
    columns = [generations[column] for column in COLUMNS]
    shown["generations"] = [dict(zip(COLUMNS, values)) for values in zip(*columns, strict=True)]
    return shown


def store(file, values):
    """Writes JSON into a file, as a whole or not at all."""
    file.parent.mkdir(parents=True, exist_ok=True)
    unfinished = file.with_suffix(".new")
    with open(unfinished, "w") as stream:
        json.dump(values, stream, separators=(",", ":"))
        stream.write("\n")
        stream.flush()
        os.fsync(stream.fileno())
    unfinished.replace(file)


def write(file, shown, robots=0):
    """Writes the row of a run, given the output of `evodevo show --json`, and how many robots were measured of it."""
    store(file, pack(shown, robots))


def read(file):
    try:
        return unpack(json.loads(file.read_text()))
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise Failure(f"{file}: cannot be read as the row of a run: {error}; remove it, and its run is read again") from None
