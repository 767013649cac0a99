"""Tests comparisons whose runs consist of several ranks, and the refusal of what launchers cannot do. Those on a Slurm
cluster are in tests/cluster/."""

import csv
import os
import pathlib
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest

from end_to_end_test import DEVELOPING, PLAIN

COMPARE = [sys.executable, "-P", "-m", "compare"]
# Open MPI refuses to work for root, or to start more processes than cores, unless it is told
MPI = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMPI_MCA_rmaps_base_oversubscribe": "1"}


def has_mpi():
    version = subprocess.run([os.environ["EVODEVO_PROGRAM"], "--version"], capture_output=True, text=True).stdout
    return shutil.which("mpirun") is not None and "MPI yes" in version


class Launchers(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)
        (self.folder / "plain.toml").write_text(PLAIN.replace("evaluations = 20", "evaluations = 65"))
        (self.folder / "developing.toml").write_text(DEVELOPING)

    def command(self, out, *more):
        return [*COMPARE, "plain.toml", "developing.toml", "--seeds", "2", "--out", out, *more]

    def environment(self, **more):
        kept = {name: value for name, value in os.environ.items() if not name.startswith("SLURM_")}
        return kept | MPI | more

    def compare(self, out, *more, **variables):
        return subprocess.run(
            self.command(out, *more), cwd=self.folder, env=self.environment(**variables), capture_output=True, text=True
        )

    def results(self, out):
        """Returns the rows of results.csv without the wall time."""
        with open(self.folder / out / "results.csv", newline="") as stream:
            return [row[:-1] for row in csv.reader(stream)]

    def refused(self, *more, **variables):
        done = self.compare("out", *more, **variables)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertFalse((self.folder / "out").exists())
        return done.stderr

    @unittest.skipUnless(has_mpi(), "evodevo was built without MPI, or there is no mpirun (Debian: openmpi-bin)")
    def test_runs_of_several_ranks_are_those_of_one_process(self):
        self.assertEqual(self.compare("local").returncode, 0)
        done = self.compare("ranks", "--launcher", "mpi", "--ranks", "3", "--jobs", "2")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex((self.folder / "ranks/runs/plain/seed-2.log").read_text(), "(?m)^rank 2 on ")
        self.assertEqual(self.results("ranks"), self.results("local"))

    @unittest.skipUnless(has_mpi(), "evodevo was built without MPI, or there is no mpirun (Debian: openmpi-bin)")
    def test_an_interrupted_comparison_of_ranks_goes_on(self):
        self.assertEqual(self.compare("local").returncode, 0)
        words = self.command("ranks", "--launcher", "mpi", "--ranks", "2")
        with subprocess.Popen(words, cwd=self.folder, env=self.environment(), stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True) as stopped:
            stopped.stdout.readline()
            stopped.send_signal(signal.SIGTERM)
            _, said = stopped.communicate()
        self.assertEqual((stopped.returncode, said), (130, "compare: interrupted; the same command goes on\n"))
        done = self.compare("ranks", "--launcher", "mpi", "--ranks", "2")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.results("ranks"), self.results("local"))

    def program(self, before):
        """Returns a program that first executes `before`, in which $1 is the command, and then is evodevo."""
        program = self.folder / "program"
        program.write_text(f'#!/bin/sh\n{before}\nexec {shlex.quote(os.environ["EVODEVO_PROGRAM"])} "$@"\n')
        program.chmod(0o755)
        return str(program)

    def test_runs_at_once_are_those_of_one_process(self):
        self.assertEqual(self.compare("alone").returncode, 0)
        seen = self.folder / "seen"
        program = self.program(f'echo "$1" >>{shlex.quote(str(seen))}')
        done = self.compare("together", "--jobs", "3", EVODEVO_PROGRAM=program)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual([word for word in seen.read_text().split() if word.startswith("run")], ["run-many"])
        self.assertEqual(self.results("together"), self.results("alone"))

    def test_the_death_of_their_process_loses_no_run(self):
        self.assertEqual(self.compare("alone").returncode, 0)
        killer = self.program('[ "$1" != run-many ] || kill -9 $$')
        done = self.compare("together", "--jobs", "3", EVODEVO_PROGRAM=killer)
        self.assertEqual(done.returncode, 2)
        self.assertRegex(done.stderr, "together/runs/plain/seed-1: .*-9.*(?s:.*)the same command goes on")
        self.assertEqual(self.compare("together", "--jobs", "3").returncode, 0)
        self.assertEqual(self.results("together"), self.results("alone"))

    def test_options_of_another_launcher_are_refused(self):
        self.assertRegex(self.refused("--ranks", "3"), "--ranks: .*--launcher mpi.*local")
        self.assertRegex(self.refused("--launcher", "mpi", "--sbatch=--time=7"), "--sbatch: .*--launcher slurm.*mpi")
        self.assertRegex(self.refused("--launcher", "pbs"), "--launcher.*'pbs'.*'local', 'mpi', 'slurm'")

    def test_the_number_of_ranks_must_be_known(self):
        self.assertRegex(self.refused("--launcher", "mpi"), "--launcher mpi: .*--ranks N")

    def test_what_is_not_installed_is_named(self):
        # no program but this Python and evodevo
        nothing = str(self.folder / "nothing")
        said = self.refused("--launcher", "mpi", "--ranks", "2", PATH=nothing)
        self.assertRegex(said, "mpirun.*openmpi-bin")
        done = self.compare("out", "--launcher", "slurm", PATH=nothing)
        self.assertEqual(done.returncode, 2)
        self.assertRegex(done.stderr, "--launcher slurm: .*sbatch")
        self.assertFalse((self.folder / "out/slurm/job").exists())


if __name__ == "__main__":
    unittest.main()
