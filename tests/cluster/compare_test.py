"""Tests comparisons whose runs Slurm starts."""

import csv
import os
import pathlib
import subprocess
import sys
import unittest

import slurm
from slurm import run, wait_until
from small_experiment import small_experiment

COMPARE = [sys.executable, "-P", "-m", "compare"]

VALUES = {"evaluations": 65, "population": 7, "window": 0.13}
PLAIN = small_experiment(**VALUES)
DEVELOPING = small_experiment(development=True, cycle_time=0.07, **VALUES)


def setUpModule():
    global cluster
    cluster = unittest.enterModuleContext(slurm.Cluster())


class Comparison(unittest.TestCase):
    def setUp(self):
        self.folder = cluster.folder / self.id().split(".")[-1]
        self.folder.mkdir()
        os.chdir(self.folder)
        self.addCleanup(run, "scancel", "--user=root")
        pathlib.Path("a plain.toml").write_text(PLAIN)
        pathlib.Path("developing.toml").write_text(DEVELOPING)

    def compare(self, out, *more, before=()):
        return run(*before, *COMPARE, "a plain.toml", "developing.toml", "--seeds", "2", "--out", out, *more)

    def slurm(self, *more):
        return self.compare("out", "--launcher", "slurm", "--sbatch=--time=10", *more)

    def refused(self, *more, before=()):
        command = [*before, *COMPARE, "a plain.toml", "--out", "out", *more]
        refused = subprocess.run(command, capture_output=True, text=True)
        self.assertEqual(refused.returncode, 2)
        return refused.stderr

    def wait_until_idle(self):
        wait_until(lambda: not run("squeue", "--noheader"), "no job is left", cluster.logs)

    def expect_same_results(self, out):
        local = cluster.folder / "local"
        if not local.exists():  # the same for all tests
            self.compare(local)
        results = []
        for folder in (local, out):
            with open(f"{folder}/results.csv", newline="") as stream:
                results.append([row[:-1] for row in csv.reader(stream)])  # without the wall time
        self.assertEqual(*results)
        self.assertEqual(len(results[0]), 1 + 2 * 2 * 10)  # a header; experiments, seeds, generations

    def test_an_array_makes_the_runs_that_are_neither_complete_nor_in_the_queue(self):
        self.slurm("--sbatch=--hold")
        queued = run("squeue", "--noheader", "--format=%i")
        self.assertIn("0 of 4 runs are complete", self.slurm())
        self.assertEqual(run("squeue", "--noheader", "--format=%i"), queued)
        self.assertFalse(pathlib.Path("out/report.md").exists())

        run("scancel", "--user=root")
        self.wait_until_idle()
        kept = pathlib.Path("out/slurm/run.sbatch")
        kept.write_text(kept.read_text() + "# changed\n")
        complete = "out/runs/developing/seed-2"
        run(os.environ["EVODEVO_PROGRAM"], "run", "developing.toml", "--seed", 2, "--out", complete, "--no-report")
        written = pathlib.Path(complete, "run.sqlite").stat().st_mtime_ns
        self.assertIn("1 of 4 runs are complete", self.slurm("--jobs", "3"))
        self.wait_until_idle()
        self.assertIn("| `developing` |", self.slurm())
        self.assertEqual(pathlib.Path(complete, "run.sqlite").stat().st_mtime_ns, written)
        self.assertTrue(kept.read_text().endswith("# changed\n"))
        self.expect_same_results("out")

    def test_runs_share_the_ranks_of_a_job(self):
        job = ("salloc", "--quiet", "--nodes=2", "--ntasks=4", "--ntasks-per-node=2")
        self.assertIn("| `developing` |", self.compare("out", "--launcher", "mpi", "--jobs", "2", before=job))
        log = pathlib.Path("out/runs/developing/seed-1.log").read_text()
        self.assertRegex(log, "(?m)^rank 1 on ")
        self.assertNotRegex(log, "(?m)^rank 2 on ")
        self.expect_same_results("out")

    def test_more_ranks_than_a_job_has_are_refused(self):
        job = ("salloc", "--quiet", "--ntasks=5")
        said = self.refused("--launcher", "mpi", "--jobs", "3", "--ranks", "2", before=job)
        self.assertRegex(said, "3 runs at once with 2 ranks each .* 5 tasks .*--ntasks")
        self.assertFalse(pathlib.Path("out").exists())

    def test_options_that_sbatch_refuses_are_named(self):
        said = self.refused("--launcher", "slurm", "--sbatch=--partition=none-such")
        self.assertRegex(said, "compare: sbatch .*--partition=none-such.*invalid partition")
        self.assertEqual(run("squeue", "--noheader"), "")


if __name__ == "__main__":
    slurm.enter_namespaces()
    unittest.main()
