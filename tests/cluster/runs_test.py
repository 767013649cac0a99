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
# fifteen, so that much can happen to it before it has ended; one of `trek` would take hours
EVALUATIONS = {"walk": 427, "hike": 3003, "trek": 4270003}
VALUES = {"population": 7, "size": "[3, 2, 2]", "cycle_time": 0.31, "springs": 3, "settle": 0.7, "window": 1.3}
TABLES = ("generations", "individuals", "scores", "lives", "memory", "verifications")


def setUpModule():
    global cluster, straight_runs
    cluster = unittest.enterModuleContext(slurm.Cluster())
    for name, count in EVALUATIONS.items():
        experiment(name).write_text(small_experiment(development=True, evaluations=count, **VALUES))
    # while the first tests run
    straight_runs = {name: subprocess.Popen([PROGRAM, "run", experiment(name), "--out", straight(name), "--no-report"],
                                            stdout=subprocess.DEVNULL) for name in ("walk", "hike")}
    unittest.addModuleCleanup(lambda: [each.kill() or each.wait() for each in straight_runs.values()])


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
            with contextlib.suppress(sqlite3.OperationalError):  # not yet begun
                with contextlib.closing(sqlite3.connect(f"file:{folder}/run.sqlite?mode=ro", uri=True)) as file:
                    return file.execute("SELECT count(*) FROM generations").fetchone()[0] >= count

        wait_until(enough, f"{count} generations of {folder}", lambda: self.said(job))

    def wait_for_end(self, job, state="COMPLETED", restarts=None):
        """Waits until a job has ended, and expects that it is in this state, and was queued again so many times."""

        def has_ended():
            return self.state(job)[0] in ("COMPLETED", "FAILED", "CANCELLED", "TIMEOUT", "NODE_FAIL")

        wait_until(has_ended, f"job {job} ends", lambda: self.said(job))
        ended = self.state(job)
        self.assertEqual(ended, (state, ended[1] if restarts is None else restarts), self.said(job))

    def wait_for_restart(self, job, restarts=1):
        """Waits until a job is in the queue again, and lets it start before the two minutes that Slurm waits. But a
        node refuses a job that starts in the second in which it ended."""
        queued = ("PENDING", restarts)
        wait_until(lambda: self.state(job) == queued, f"job {job} is queued again", lambda: self.said(job))
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
        self.assertEqual(straight_runs[name].wait(), 0)
        expected = self.rows(straight(name))
        self.assertEqual(len(expected["individuals"]), EVALUATIONS[name])
        self.assertEqual(self.rows(folder), expected)

    def test_each_rank_gets_a_gpu_of_its_own(self):
        printed = run("srun", "--nodes=1", "--ntasks=2", "--gpus-per-task=1", "--mpi=pmix", "sh", "-c",
                      "echo $PMIX_RANK $CUDA_VISIBLE_DEVICES")
        self.assertEqual(sorted(printed.split("\n")), ["", "0 0", "1 1"])

    def test_the_batch_script_makes_the_same_run_on_two_nodes_as_one_process_does(self):
        two = ("--nodes=2", "--ntasks=2", "--gpus-per-task=1", "--cpus-per-task=1")
        added = ("--resume", "--threads=1")  # which the script would add
        job = self.submit("--wait", *two, SCRIPT, experiment("walk"), *added, "--out", "ranks")
        self.wait_for_end(job)
        self.assertRegex(self.printed(job), r"rank 0 on one: .*\nrank 1 on two: ")
        self.expect_same_rows("ranks")

    def test_each_task_of_an_array_makes_a_run(self):
        walk, seeds = experiment("walk"), (3, 17)
        lines = (f"{walk} --out 'a {seed}' --seed {seed}\n" for seed in seeds)
        pathlib.Path("tasks").write_text("".join(lines))
        self.submit("--wait", "--array=1-2", SCRIPT, "tasks")
        for seed in seeds:
            run(PROGRAM, "run", walk, "--out", f"alone-{seed}", "--seed", seed, "--no-report")
            self.assertEqual(self.rows(f"a {seed}"), self.rows(f"alone-{seed}"))

    def wait_for_more(self, name, job, generations=0):
        """Waits until a run has made more generations, and expects that it has not ended."""
        self.wait_for_generations("resumed", generations + 3, job)
        made = len(self.rows("resumed")["individuals"])
        self.assertLess(made, EVALUATIONS[name], "it was done before it could be interrupted")

    def test_a_job_with_a_fault_is_not_queued_again(self):
        text = experiment("walk").read_text()
        pathlib.Path("walk.toml").write_text(text.replace("evaluations = ", "evaluation = "))
        finished = subprocess.run(["sbatch", "--parsable", "--wait", SCRIPT, "walk.toml", "--out", "none"],
                                  capture_output=True, text=True)
        job = finished.stdout.strip()
        self.wait_for_end(job, "FAILED", restarts=0)
        self.assertEqual(finished.returncode, 2)
        self.assertRegex(self.printed(job), "walk.toml:2:.*evaluation")

    def test_a_run_goes_on_after_whatever_interrupts_it(self):
        def kill_node():
            self.addCleanup(cluster.wait_for_nodes)
            self.addCleanup(cluster.start_node, "two")
            cluster.kill_node("two")

        two = ("--nodes=2", "--ntasks=2", "--exclusive")
        job, generations = self.submit(*two, SCRIPT, experiment("hike"), "--out", "resumed"), 0
        for restarts, interrupt in enumerate((
            lambda: run("scancel", "--batch", "--signal=USR1", job),  # as before the time limit
            lambda: run("scontrol", "requeue", job),
            lambda: run("srun", "--partition=urgent", *two, "true"),  # preempts it
            kill_node,
        ), 1):
            self.wait_for_more("hike", job, generations)
            interrupt()
            self.wait_for_restart(job, restarts)
            generations = len(self.rows("resumed")["generations"])
            if restarts == 1:
                self.assertIn("ended early", self.printed(job))
        self.assertLess(len(self.rows("resumed")["individuals"]), EVALUATIONS["hike"])
        self.assertNotIn("rank 1 on one", self.printed(job))
        run("scontrol", "update", f"JobId={job}", "NumNodes=1")  # which are left
        self.wait_for_end(job)
        self.assertIn("rank 1 on one", self.printed(job))
        self.expect_same_rows("resumed", "hike")

    def test_a_cancelled_job_is_not_queued_again(self):
        job = self.submit(SCRIPT, experiment("trek"), "--out", "resumed")
        self.wait_for_more("trek", job)
        run("scancel", job)
        wait_until(cluster.is_quiet, "nothing of the job is left", cluster.logs)
        self.wait_for_end(job, "CANCELLED", restarts=0)

    def test_slurm_sends_a_signal_before_the_time_limit(self):
        # a minute with a signal that is due two minutes before its end
        job = self.submit("--time=1", SCRIPT, experiment("trek"), "--out", "long")
        wait_until(lambda: self.state(job) == ("PENDING", 1), f"job {job} is queued again", lambda: self.said(job))
        # the signal may come before the run has begun, so it need not have said anything
        self.assertIn("Exited with exit code 130", self.printed(job))
        self.assertNotIn("DUE TO TIME LIMIT", self.printed(job))


if __name__ == "__main__":
    slurm.enter_namespaces()
    unittest.main()
