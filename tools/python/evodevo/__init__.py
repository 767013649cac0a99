"""Reads runs of evodevo: generations, individuals, genes, lineages, lives and bodies as pandas DataFrames and NumPy
arrays.

    import evodevo
    run = evodevo.Run("runs/quickstart-1")
    run.generations.plot(x="evaluations", y=["best", "median"])

`Run` reads the archive of a run and needs no program. Its functions `life`, `body` and `motion` simulate a robot again
with the program `evodevo`, which `program` finds. `save_mesh` writes a body as a surface. `evodevo.figures` has the
usual figures; it needs matplotlib. `evodevo.core` simulates bodies of your own; it is compiled, and there only if
evodevo was built with pybind11.
"""

from .body import Body
from .errors import ArchiveError, ProgramError
from .mesh import mesh_of, save_mesh
from .program import program
from .run import Run

__all__ = ["ArchiveError", "Body", "ProgramError", "Run", "mesh_of", "program", "save_mesh"]
__version__ = "0.1.0"
