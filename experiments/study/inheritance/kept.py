"""What outcomes need of a run: archives of some of its robots, from which other runs can start."""

import contextlib
import shutil
import sqlite3

PARTS = 4  # of a run, after each of which the best robot is kept
OF_INDIVIDUALS = ("scores", "measured", "life_scores", "tests", "notes", "verifications")


def open_archive(folder):
    return contextlib.closing(sqlite3.connect(folder / "run.sqlite"))


def reduce(archive, ids):
    """Removes all individuals but those with the ids, and what belongs to the others."""
    archive.execute("CREATE TEMP TABLE remaining(id INTEGER PRIMARY KEY)")
    archive.executemany("INSERT INTO remaining VALUES(?)", ((number,) for number in ids))
    archive.execute("DELETE FROM individuals WHERE id NOT IN (SELECT id FROM remaining)")
    for name in OF_INDIVIDUALS:
        archive.execute(f"DELETE FROM {name} WHERE individual NOT IN (SELECT id FROM remaining)")
    archive.execute("DELETE FROM lives")
    archive.commit()
    archive.execute("VACUUM")


def last_generation(archive):
    return archive.execute("SELECT max(generation) FROM generations").fetchone()[0]


def best_at(archive, generation):
    """Returns the id of the best of those who were alive after the selection of a generation, by their records; None if
    none of them has a fitness."""
    query = """SELECT individual FROM members JOIN scores USING(individual)
               WHERE generation = ? AND objective = 0 ORDER BY value DESC, individual LIMIT 1"""
    found = archive.execute(query, (generation,)).fetchone()
    return found and found[0]


def at_parts(last):
    """Returns the first generation, and those after which each part but the last ends."""
    return [part * last // PARTS for part in range(PARTS)]


def line_of(archive, number):
    """Returns the ids of an individual and of its ancestors, the first parents of each."""
    parents = dict(archive.execute("SELECT id, parent FROM individuals"))
    line = []
    while number in parents:
        line.append(number)
        number = parents[number]
    return line


def keep(run, folder):
    """Writes the last population of a run, the line of its best robot and the best of earlier generations to an archive
    in a folder, unless it is there or the run is gone."""
    if (folder / "run.sqlite").exists() or not run.exists():
        return
    unfinished = folder.with_name(f"{folder.name}.new")
    unfinished.mkdir(parents=True, exist_ok=True)
    shutil.copy(run / "run.sqlite", unfinished)
    with open_archive(unfinished) as archive:
        last = last_generation(archive)
        ids = {number for (number,) in archive.execute("SELECT id FROM individuals WHERE died IS NULL")}
        ids |= {number for part in at_parts(last) if (number := best_at(archive, part)) is not None}
        ids |= set(line_of(archive, best_at(archive, last)))
        reduce(archive, ids)
    unfinished.rename(folder)


def bests(start, folder):
    """Returns for each generation of at_parts() a folder whose archive holds only the robot that was the best after it.
    `start`: a folder that keep() has written."""
    with open_archive(start) as archive:
        found = [best_at(archive, part) for part in at_parts(last_generation(archive))]
    folders = []
    for part, number in enumerate(found):
        place = folder / str(part)
        folders.append(place)
        if number is None or place.exists():
            continue
        unfinished = place.with_name(f"{place.name}.new")
        unfinished.mkdir(parents=True, exist_ok=True)
        shutil.copy(start / "run.sqlite", unfinished)
        with open_archive(unfinished) as archive:
            reduce(archive, [number])
            archive.execute("UPDATE individuals SET died = NULL")
            archive.commit()
        unfinished.rename(place)
    return folders
