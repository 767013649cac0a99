"""A run with islands, told as one run."""

SUMS = ("spring_evaluations", "diverged", "invalid", "artefact", "lucky", "passive")


def as_one(shown):
    """Returns what `evodevo show --json` tells of a run with islands in the form in which it tells of one without: in each
    generation what its islands cost together and the best of them, and for the whole run its best robot, with its island's
    verification and signal. Islands that end earlier have no part in later generations. There is no map of niches."""
    islands = shown["islands"]
    better = max if islands[0]["objectives"][0]["maximise"] else min
    leading = islands[(shown["best_island"] or 1) - 1]
    return leading | {
        "generations": [generation(islands, number, better) for number in range(max(map(length, islands)))],
        "map": None,
        "provenances": [each for i, island in enumerate(islands) for each in new_provenances(islands[:i], island)],
        "finished": all(island["finished"] for island in islands),
    }


def length(island):
    return len(island["generations"])


def generation(islands, number, better):
    """Returns what the islands did in a generation."""
    there = [island["generations"][number] for island in islands if number < length(island)]
    so_far = [island["generations"][: number + 1] for island in islands]
    scores = [each["best"] for each in there if each["best"] is not None]
    return {
        **{key: sum(each[key] for each in there) for key in SUMS},
        "evaluations": sum(generations[-1]["evaluations"] for generations in so_far if generations),
        "best": better(scores, default=None),
        "wall_time": max(each["wall_time"] for each in there),  # they evolve at the same time
        "map": None,
    }


def new_provenances(before, island):
    """Returns the provenances of an island that none of the islands before it has."""
    return [each for each in island["provenances"] if not any(each in other["provenances"] for other in before)]
