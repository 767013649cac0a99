"""Outcomes that need bodies: development of a stranger, edits that ancestors had, and diversity."""

import itertools
import json
import random
import re
import statistics
import subprocess
import tempfile

import answers
import kept
import numpy

SETTLE, WINDOW = 4.0, 10.0  # s, of the fitness of this study
LIVES = 9  # of a body
NOISE = 0.001  # of the longest side: largest offset of a mass
ENOUGH = 0.5  # of the distance, below which development is needed
COMPARED = 10  # robots of each population


def best_of(start):
    """Returns the id of the best robot of a run by its record, or None."""
    with kept.open_archive(start) as archive:
        return kept.best_at(archive, kept.last_generation(archive))


def life(program, start, number):
    return program.json("life", start, "--individual", number, "--json", "--quiet")


def newborn(program, start, number):
    return program.json("body", start, "--individual", number, "--quiet")


def ends(spring):
    return frozenset((spring["a"], spring["b"]))


def spring_edits(told):
    """Returns the edits of springs of a life, in their order."""
    return [edit for edit in told["edits"] if "spring" in edit and edit["event"] in ("come", "gone")]


def edited(body, edits):
    """Returns a body after edits of springs, as far as it has the masses and springs concerned."""
    materials = list(body["materials"])
    springs = {ends(spring): spring for spring in body["springs"]}
    places = [numpy.array(mass["position"]) for mass in body["masses"]]
    for edit in edits:
        a, b = edit["spring"]
        if max(a, b) >= len(places):
            continue
        if edit["event"] == "gone":
            springs.pop(frozenset((a, b)), None)
        elif frozenset((a, b)) not in springs:
            materials.append({"name": f"edit-{len(materials)}", **edit["material"]})
            length = float(numpy.linalg.norm(places[a] - places[b]))
            springs[frozenset((a, b))] = {"a": a, "b": b, "rest_length": length, "material": len(materials) - 1}
    return {**body, "materials": materials, "springs": list(springs.values())}


def length(body):
    """Returns the longest side of a body, m."""
    return max(max(axis) - min(axis) for axis in zip(*(mass["position"] for mass in body["masses"])))


def moved(body, seed):
    """Returns a body whose masses are moved by small random offsets."""
    source = random.Random(seed)
    places = [mass["position"] for mass in body["masses"]]
    longest = length(body)
    shift = [[axis + longest * NOISE * source.uniform(-1, 1) for axis in place] for place in places]
    return {**body, "masses": [{**mass, "position": place} for mass, place in zip(body["masses"], shift)]}


def distance(program, arm, body):
    """Returns how far a body goes along the ground in the window, m; 0 if it diverges."""

    def place(duration, files):
        done = program.call("simulate", *files, "--duration", duration, "--device", "cpu", "--threads", 1)
        x, y, _ = re.search(r"moved by \((.*), (.*), (.*)\) m", done).groups()
        return numpy.array([float(x), float(y)])

    with tempfile.TemporaryDirectory() as folder:
        files = [f"{folder}/body.json", f"{folder}/experiment.toml"]
        for file, text in zip(files, (json.dumps(body), arm.experiment)):
            with open(file, "w") as stream:
                stream.write(text)
        try:
            begin, end = (place(duration, files) for duration in (SETTLE, SETTLE + WINDOW))
        except subprocess.CalledProcessError:  # the program has said why
            return 0.0
    return float(numpy.linalg.norm(end - begin))


def mean_distance(program, arm, body):
    return statistics.fmean(distance(program, arm, moved(body, seed)) for seed in range(LIVES))


def with_edits_of_a_stranger(program, start_of, arm, run):
    """Returns what is left of the distance of the best robot of a run if its springs come and go as those of the best
    robot of the next run do, and whether less than half is left; None if its development edits no springs."""
    stranger = arm.runs[(arm.runs.index(run) + 1) % len(arm.runs)]
    starts = [start_of(arm, each) for each in (run, stranger)]
    if not arm.develops or not all(start.exists() for start in starts):
        return None
    numbers = [best_of(start) for start in starts]
    if None in numbers:
        return None
    own, others = (spring_edits(life(program, start, number)) for start, number in zip(starts, numbers))
    if not own or not others:
        return None
    body = newborn(program, starts[0], numbers[0])
    whole, rest = (mean_distance(program, arm, edited(body, edits)) / length(body) for edits in (own, others))
    share = answers.share(rest, whole, to=None)
    return {"share left": share, "needed, %": None if share is None else 100 * (share < ENOUGH)}


def edits_of_ancestors(program, start_of, arm, run):
    """Returns the shares of the edits of the best robot's springs that its ancestors had: at birth (where a spring comes,
    they have it; where one goes, they lack it), and in the same cycle of their development; of its parent and of its
    first ancestor, and the mean of all. Beside them the share of the first ancestor's edits that the robot has at birth.
    None if its development edits no springs."""
    start = start_of(arm, run)
    if not arm.develops or not start.exists() or (number := best_of(start)) is None:
        return None
    with kept.open_archive(start) as archive:
        line = kept.line_of(archive, number)[1:]
    edits = told_edits(program, start, number)
    if not edits or not line:
        return None
    springs = [newborn_springs(program, start, each) for each in (number, *line)]
    of_line = [told_edits(program, start, ancestor) for ancestor in line]
    shares = [(had(edits, born), len(edits & own) / len(edits)) for born, own in zip(springs[1:], of_line)]
    of_whom = {"its parent": shares[0], "its first ancestor": shares[-1]}
    of_whom["all ancestors"] = [statistics.fmean(each) for each in zip(*shares)]
    ways = ("at birth", "in the same cycle")
    told = {f"{way}, {whose}": both[i] for whose, both in of_whom.items() for i, way in enumerate(ways)}
    first = of_line[-1]
    return {**told, "its first ancestor's edits, inborn": had(first, springs[0]) if first else None, "ancestors": len(line)}


def newborn_springs(program, start, number):
    return {ends(spring) for spring in newborn(program, start, number)["springs"]}


def told_edits(program, start, number):
    """Returns the edits of springs in an individual's first life: (cycle, event, masses)."""
    told = spring_edits(life(program, start, number))
    return {(each["cycle"], each["event"], frozenset(each["spring"])) for each in told}


def had(edits, springs):
    """Returns the share of edits that a body with these springs has: where one comes, it has it; where one goes, not."""
    return sum((pair in springs) == (event == "come") for _, event, pair in edits) / len(edits)


def diversity(program, start_of, arm, run):
    """Returns how much the robots of a last population differ, in the mean of their pairs: the share of genes that differ,
    and the share of the springs of two matured bodies that only one of them has."""
    start = start_of(arm, run)
    if not start.exists():
        return None
    with kept.open_archive(start) as archive:
        query = "SELECT id, genes FROM individuals WHERE died IS NULL AND status = 'ok' ORDER BY id"
        living = archive.execute(query).fetchall()
    chosen = living[:: max(1, len(living) // COMPARED)][:COMPARED]
    if len(chosen) < 2:
        return None
    genes = [numpy.frombuffer(blob, dtype="<f4") for _, blob in chosen]
    matured = [program.json("body", start, "--individual", number, "--matured", "--quiet") for number, _ in chosen]
    springs = [{ends(spring) for spring in body["springs"]} for body in matured]
    of_genes = statistics.fmean(float(numpy.mean(a != b)) for a, b in itertools.combinations(genes, 2))
    of_springs = statistics.fmean(len(a ^ b) / len(a | b) for a, b in itertools.combinations(springs, 2))
    ratio = of_springs / of_genes if of_genes else None
    return {"genes that differ": of_genes, "springs that differ": of_springs, "springs for genes": ratio}
