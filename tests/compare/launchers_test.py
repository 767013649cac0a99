"""Tests comparisons whose runs consist of several ranks, and the refusal of what launchers cannot do. Those on a Slurm
cluster are in tests/cluster/."""

import os
import pathlib
import shlex
import shutil
import signal
import subprocess
import tempfile
import unittest
import unittest.mock

from compare import command
from end_to_end_test import DEVELOPING, PLAIN
from own_folder import PROGRAM, InOwnFolder, called, stopped

# Open MPI refuses to work for root, or to start more processes than cores, unless it is told
MPI = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMPI_MCA_rmaps_base_oversubscribe": "1"}


def has_mpi():
    version = subprocess.run([PROGRAM, "--version"], capture_output=True, text=True).stdout
    return shutil.which("mpirun") is not None and "MPI yes" in version


class Launchers(InOwnFolder):
    @classmethod
    def setUpClass(cls):
        """Makes a comparison, each of whose runs is one process."""
        kept = {name: value for name, value in os.environ.items() if not name.startswith("SLURM_")}
        cls.enterClassContext(unittest.mock.patch.dict(os.environ, kept | MPI, clear=True))
        cls.files = pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory()))
        (cls.files / "plain.toml").write_text(PLAIN.replace("evaluations = 20", "evaluations = 65"))
        (cls.files / "developing.toml").write_text(DEVELOPING)
        made = cls()
        made.folder = cls.files
        made.compare()
        cls.alone = made.results()

    def words(self, *more):
        files = [self.files / "plain.toml", self.files / "developing.toml"]
        return [*files, "--seeds", "2", "--out", self.folder / "out", *more]

    def compare(self, *more, program=PROGRAM, code=0, **variables):
        """Makes or refuses a comparison, and returns what it says."""
        with unittest.mock.patch.dict(os.environ, variables):
            done = called(command.main, self.words(*more), program)
        self.assertEqual(done.returncode, code, done.stderr)
        return done.stderr

    def results(self):
        """Returns the rows of results.csv without the wall time."""
        return [row.rpartition(",")[0] for row in (self.folder / "out/results.csv").read_text().splitlines()]

    def refused(self, *more, **variables):
        said = self.compare(*more, code=2, **variables)
        self.assertFalse((self.folder / "out").exists())
        return said

    @unittest.skipUnless(has_mpi(), "evodevo was built without MPI, or there is no mpirun (Debian: openmpi-bin)")
    def test_interrupted_runs_of_several_ranks_go_on_and_are_those_of_one_process(self):
        ranks = ("--launcher", "mpi", "--ranks", "3", "--jobs", "2")
        said = "compare: interrupted; the same command goes on\n"
        self.assertEqual(stopped("compare", self.words(*ranks), signal.SIGTERM), (130, said))
        self.compare(*ranks)
        self.assertRegex((self.folder / "out/runs/plain/seed-2.log").read_text(), "(?m)^rank 2 on ")
        self.assertEqual(self.results(), self.alone)

    def test_runs_at_once_are_those_of_one_process_and_its_death_loses_none(self):
        killer = self.program('[ "$1" != run-many ] || kill -9 $$')
        said = self.compare("--jobs", "3", program=killer, code=2)
        self.assertRegex(said, "out/runs/plain/seed-1: .*-9.*(?s:.*)the same command goes on")
        seen = self.folder / "seen"
        self.compare("--jobs", "3", program=self.program(f'echo "$1" >>{shlex.quote(str(seen))}'))
        self.assertEqual([word for word in seen.read_text().split() if word.startswith("run")], ["run-many"])
        self.assertEqual(self.results(), self.alone)

    def test_options_of_another_launcher_are_refused(self):
        self.assertRegex(self.refused("--ranks", "3"), "--ranks: .*--launcher mpi.*local")
        self.assertRegex(self.refused("--launcher", "mpi", "--sbatch=--time=7"), "--sbatch: .*--launcher slurm.*mpi")
        self.assertRegex(self.refused("--launcher", "pbs"), "--launcher.*'pbs'.*'local', 'mpi', 'slurm'")
        self.assertRegex(self.refused("--launcher", "mpi"), "--launcher mpi: .*--ranks N")

    def test_what_is_not_installed_is_named(self):
        nothing = str(self.folder / "nothing")  # a folder without programs
        self.assertRegex(self.refused("--launcher", "mpi", "--ranks", "2", PATH=nothing), "mpirun.*openmpi-bin")
        self.assertRegex(self.compare("--launcher", "slurm", code=2, PATH=nothing), "--launcher slurm: .*sbatch")
        self.assertFalse((self.folder / "out/slurm/job").exists())


unittest.main()
