"""The usual figures of a run. Each function draws into `axes`, or into new ones, and returns them; it needs matplotlib.
"""

import matplotlib.pyplot as plt
from mpl_toolkits.mplot3d.art3d import Line3DCollection


def fitness(run, axes=None):
    """Draws the best and the median of the first objective over the evaluations."""
    axes = axes or plt.figure().gca()
    objective = run.objectives.iloc[0]
    for column in ("best", "median"):
        # a value holds until the next generation
        axes.step(run.generations["evaluations"], run.generations[column], where="post", label=column)
    axes.set(xlabel="evaluations", ylabel=f"{objective['name']} ({objective['unit']})")
    axes.legend()
    return axes


def ages(run, generation=None, axes=None):
    """Draws the first objective of the survivors of a generation (default: the last) over their ages."""
    axes = axes or plt.figure().gca()
    objective = run.objectives.iloc[0]
    members = run.members
    members = members[members["generation"] == (members["generation"].max() if generation is None else generation)]
    axes.plot(members["age"], run.individuals[run.objective_columns[0]].reindex(members["individual"]), "o")
    axes.set(xlabel="age (generations)", ylabel=f"{objective['name']} ({objective['unit']})")
    return axes


def lineage(run, individual, axes=None):
    """Draws the first objective of an individual and its ancestors over the generations of their birth."""
    axes = axes or plt.figure().gca()
    objective = run.objectives.iloc[0]
    line = run.lineage(individual)
    axes.plot(line["born"], line[run.objective_columns[0]], "o-")
    axes.set(xlabel="generation", ylabel=f"{objective['name']} ({objective['unit']})")
    return axes


def body(shown, axes=None):
    """Draws a Body in 3D: muscles red, other springs grey."""
    axes = axes or plt.figure().add_subplot(projection="3d")
    colours = ["tab:red" if muscle else "0.6" for muscle in shown.is_muscle]
    axes.add_collection3d(Line3DCollection(shown.positions[shown.springs], colors=colours, linewidths=0.5))
    low, high = shown.positions.min(axis=0), shown.positions.max(axis=0)
    middle, half = (low + high) / 2, shown.size / 2
    axes.set(xlim=(middle[0] - half, middle[0] + half), ylim=(middle[1] - half, middle[1] + half),
             zlim=(middle[2] - half, middle[2] + half), xlabel="x (m)", ylabel="y (m)", zlabel="z (m)")
    return axes
