"""Tests runs, job arrays and the batch script in tools/cluster/ on a Slurm cluster of two nodes."""

import contextlib
import os
import pathlib
import re
import sqlite3
import subprocess
import unittest

import slurm
from slurm import run, wait_until
from small_experiment import small_experiment

PROGRAM = os.environ["EVODEVO_PROGRAM"]
SCRIPT = pathlib.Path(__file__).parents[2] / "tools" / "cluster" / "run.sbatch"

# the experiments by name, with their numbers of evaluations: a run of `walk` takes two seconds, and one of `hike`
# fifteen, so that something can happen to it before it has ended; one of `trek` would take hours
EVALUATIONS = {"walk": 427, "hike": 3003, "trek": 4270003}
VALUES = {"population": 7, "size": "[3, 2, 2]", "cycle_time": 0.31, "springs": 3, "settle": 0.7, "window": 1.3}
TABLES = ("generations", "individuals", "scores", "lives", "memory", "verifications")


def setUpModule():
    global cluster
    cluster = unittest.enterModuleContext(slurm.Cluster())
    for name, count in EVALUATIONS.items():
        experiment(name).write_text(small_experiment(development=True, evaluations=count, **VALUES))
    for name in ("walk", "hike"):
        run(PROGRAM, "run", experiment(name), "--out", straight(name), "--no-report")


def experiment(name):
    return cluster.folder / f"{name}.toml"


def straight(name):
    """Returns the folder of a run of an experiment that one process has made."""
    return cluster.folder / f"straight-{name}"


class Runs(unittest.TestCase):
    def setUp(self):
        self.folder = cluster.folder / self.id().split(".")[-1]
        self.folder.mkdir()
        self.addCleanup(run, "scancel", "--user=root")
        os.chdir(self.folder)

    def submit(self, *words):
        """Submits the batch script and returns the number of the job."""
        return run("sbatch", "--parsable", "--time=10", *words).strip()

    def state(self, job):
        """Returns the state of a job, and how often it was put into the queue again."""
        shown = run("scontrol", "show", "job", job)
        return re.search(r"JobState=(\w+)", shown)[1], int(re.search(r"Restarts=(\d+)", shown)[1])

    def printed(self, job):
        return "\n".join(file.read_text() for file in self.folder.glob(f"*{job}*.log"))

    def said(self, job):
        return f"{run('scontrol', 'show', 'job', job)}\n{self.printed(job)}\n{cluster.logs()}"

    def wait_for_generations(self, folder, count, job):
        def enough():
            with contextlib.closing(sqlite3.connect(f"file:{folder}/run.sqlite?mode=ro", uri=True)) as file:
                with contextlib.suppress(sqlite3.OperationalError):  # not yet begun
                    return file.execute("SELECT count(*) FROM generations").fetchone()[0] >= count

        def begun():
            return pathlib.Path(folder, "run.sqlite").exists() and enough()

        wait_until(begun, f"{count} generations of {folder}", lambda: self.said(job))

    def wait_for_end(self, job, state="COMPLETED", restarts=None):
        """Waits until a job has ended, and expects that it is in this state, and was queued again so many times."""

        def has_ended():
            return self.state(job)[0] in ("COMPLETED", "FAILED", "CANCELLED", "TIMEOUT", "NODE_FAIL")

        wait_until(has_ended, f"job {job} ends", lambda: self.said(job))
        ended = self.state(job)
        self.assertEqual(ended, (state, ended[1] if restarts is None else restarts), self.said(job))

    def wait_for_restart(self, job):
        """Waits until a job is in the queue again, and lets it start before the two minutes that Slurm waits. But a
        node refuses a job that starts in the second in which it ended."""
        wait_until(lambda: self.state(job) == ("PENDING", 1), f"job {job} is queued again", lambda: self.said(job))
        wait_until(cluster.is_quiet, "nothing of the job is left", cluster.logs)
        run("scontrol", "update", f"JobId={job}", "StartTime=now+2")

    @staticmethod
    def rows(folder):
        """Returns the rows of a run, without the wall time and without what evaluated an individual."""
        found = {}
        with contextlib.closing(sqlite3.connect(pathlib.Path(folder, "run.sqlite"))) as file:
            file.row_factory = sqlite3.Row
            for table in TABLES:
                found[table] = [dict(row) for row in file.execute(f"SELECT * FROM {table}")]
                for row in found[table]:
                    row.pop("wall_time", None)
                    row.pop("provenance", None)
        return found

    def expect_same_rows(self, folder, name="walk"):
        expected = self.rows(straight(name))
        self.assertEqual(len(expected["individuals"]), EVALUATIONS[name])
        self.assertEqual(self.rows(folder), expected)

    def test_two_nodes_make_the_same_run_as_one_process(self):
        printed = run("srun", "--nodes=2", "--ntasks=2", "--gpus-per-task=1", "--mpi=pmix", PROGRAM, "run",
                      experiment("walk"), "--device", "cpu", "--out", "ranks", "--no-report")
        self.assertRegex(printed, r"rank 0 on one: .*\nrank 1 on two: ")
        self.expect_same_rows("ranks")

    def test_each_rank_gets_a_gpu_of_its_own(self):
        printed = run("srun", "--nodes=1", "--ntasks=2", "--gpus-per-task=1", "--mpi=pmix", "sh", "-c",
                      "echo $PMIX_RANK $CUDA_VISIBLE_DEVICES")
        self.assertEqual(sorted(printed.split("\n")), ["", "0 0", "1 1"])

    def test_the_batch_script_makes_a_run_of_several_ranks(self):
        two = ("--nodes=2", "--ntasks=2", "--gpus-per-task=1")
        job = self.submit("--wait", *two, SCRIPT, experiment("walk"), "--out", "ranks")
        self.wait_for_end(job)
        self.assertIn("rank 1 on two", self.printed(job))
        self.expect_same_rows("ranks")

    def test_each_task_of_an_array_makes_a_run(self):
        seeds = {1: 3, 2: 17, 3: 1}
        walk = experiment("walk")
        lines = (f"{walk} --out 'a {task}' --seed {seed}\n" for task, seed in seeds.items())
        pathlib.Path("tasks").write_text("".join(lines))
        self.submit("--wait", "--array=1-3", SCRIPT, "tasks")
        for task, seed in seeds.items():
            run(PROGRAM, "run", walk, "--out", f"alone-{task}", "--seed", seed, "--no-report")
            self.assertEqual(self.rows(f"a {task}"), self.rows(f"alone-{task}"))

    def begin(self, *words, name="hike"):
        """Submits a run that has begun when this returns."""
        job = self.submit(*words, SCRIPT, experiment(name), "--out", "resumed")
        self.wait_for_generations("resumed", 3, job)
        made = len(self.rows("resumed")["individuals"])
        self.assertLess(made, EVALUATIONS[name], "it was done before it could be interrupted")
        return job

    def test_a_job_with_a_fault_is_not_queued_again(self):
        text = experiment("walk").read_text()
        pathlib.Path("walk.toml").write_text(text.replace("evaluations = ", "evaluation = "))
        finished = subprocess.run(["sbatch", "--parsable", "--wait", SCRIPT, "walk.toml", "--out", "none"],
                                  capture_output=True, text=True)
        job = finished.stdout.strip()
        self.wait_for_end(job, "FAILED", restarts=0)
        self.assertEqual(finished.returncode, 2)
        self.assertRegex(self.printed(job), "walk.toml:2:.*evaluation")

    def test_a_signal_before_the_time_limit_ends_a_run_that_the_requeued_job_continues(self):
        job = self.begin("--ntasks=2", "--nodes=2")
        run("scancel", "--batch", "--signal=USR1", job)
        self.wait_for_restart(job)
        self.wait_for_end(job)
        self.assertIn("ended early", self.printed(job))
        self.expect_same_rows("resumed", "hike")

    def test_a_cancelled_job_is_not_queued_again(self):
        job = self.begin(name="trek")
        run("scancel", job)
        wait_until(cluster.is_quiet, "nothing of the job is left", cluster.logs)
        self.wait_for_end(job, "CANCELLED", restarts=0)

    def test_options_that_the_script_adds_may_be_given(self):
        job = self.submit("--wait", "--cpus-per-task=1", SCRIPT, experiment("walk"), "--resume", "--threads=1",
                          "--out", "given")
        self.wait_for_end(job)
        self.expect_same_rows("given")

    def test_slurm_sends_that_signal_itself(self):
        # a minute with a signal that is due two minutes before its end
        job = self.submit("--time=1", SCRIPT, experiment("trek"), "--out", "long")
        wait_until(lambda: self.state(job) == ("PENDING", 1), f"job {job} is queued again", lambda: self.said(job))
        # the signal may come before the run has begun, so it need not have said anything
        self.assertIn("Exited with exit code 130", self.printed(job))
        self.assertNotIn("DUE TO TIME LIMIT", self.printed(job))

    def test_a_requeued_run_goes_on(self):
        job = self.begin()
        run("scontrol", "requeue", job)
        self.wait_for_restart(job)
        self.wait_for_end(job)
        self.expect_same_rows("resumed", "hike")

    def test_a_preempted_run_goes_on(self):
        job = self.begin("--exclusive", "--nodes=2", "--ntasks=2")
        run("srun", "--partition=urgent", "--exclusive", "--nodes=2", "--ntasks=2", "true")
        self.wait_for_restart(job)
        self.wait_for_end(job)
        self.expect_same_rows("resumed", "hike")

    def test_a_run_whose_node_dies_goes_on_elsewhere(self):
        job = self.begin("--nodes=2", "--ntasks=2")
        cluster.kill_node("two")
        self.addCleanup(cluster.wait_for_nodes)
        self.addCleanup(cluster.start_node, "two")
        self.wait_for_restart(job)
        self.assertLess(len(self.rows("resumed")["individuals"]), EVALUATIONS["hike"])
        run("scontrol", "update", f"JobId={job}", "NumNodes=1")  # which are left
        self.wait_for_end(job)
        self.assertIn("rank 1 on one", self.printed(job))
        self.expect_same_rows("resumed", "hike")


if __name__ == "__main__":
    slurm.enter_namespaces()
    unittest.main()
