"""Calls of the program that a campaign tries."""

import pathlib
import shutil
import subprocess

from common.command_line import NO_FITNESS

# Open MPI refuses to work for root, or to start more processes than cores, unless it is told
AS_ROOT = ("env", "OMPI_ALLOW_RUN_AS_ROOT=1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1")
RANKS = (*AS_ROOT, "mpirun", "--oversubscribe", "--bind-to", "none", "-n")


def obstacle_to_ranks(built):
    """Returns why no run of several ranks can be made with what was built or installed in a folder; None if it can."""
    if not shutil.which("mpirun"):
        return "there is no mpirun (Debian: openmpi-bin)"
    if not pathlib.Path(built, "lib", "libevodevo-mpi.so").exists():
        return "evodevo was built without MPI"
    return None


class Broken(Exception):
    """A law that does not hold, with what shows it."""


class Program:
    """The program. A command that takes more than `seconds` breaks a law."""

    def __init__(self, path, seconds):
        self.path, self.seconds = path, seconds

    def __call__(self, *words, under=()):
        """Returns how a command ended. `under` is the command that starts it, such as a launcher of MPI."""
        command = [*under, self.path, *words]
        try:
            return subprocess.run(
                [*map(str, command)],
                capture_output=True,
                text=True,
                timeout=self.seconds,
                stdin=subprocess.DEVNULL,
            )
        except subprocess.TimeoutExpired:
            raise Broken(f"{words[0]}: not done after {self.seconds} s") from None

    def output(self, *words):
        """Returns what a command prints, which must succeed."""
        done = self(*words)
        require(done, words[0])
        return done.stdout


def require(done, what):
    if done.returncode not in (0, NO_FITNESS):
        last = " / ".join((done.stderr or done.stdout).strip().splitlines()[-2:])
        raise Broken(f"{what}: exit code {done.returncode}: {last}")
