"""How the runs of a comparison are started: one after the other, several in one process, as groups of ranks, or as the
tasks of a job array."""

import dataclasses
import os
import pathlib
import shlex
import shutil
import subprocess

from common.command_line import Failure

SCRIPT = pathlib.Path(__file__).parents[2] / "cluster" / "run.sbatch"


@dataclasses.dataclass(frozen=True)
class Launcher:
    command: tuple = ()  # words before the command of a run
    options: tuple = ()  # options of the run
    in_one_process: bool = False  # all runs, which share its GPUs


def refuse_options(given):
    """Refuses options that belong to another launcher."""
    for name, launcher in (("ranks", "mpi"), ("sbatch", "slurm")):
        if getattr(given, name, None) and given.launcher != launcher:
            raise Failure(f"--{name}: only for --launcher {launcher}, not for {given.launcher}; leave it out")


def launcher(given):
    """Returns the launcher of each run, for `given.jobs` runs at once."""
    jobs = given.jobs or 1
    if given.launcher == "local":
        return Launcher(in_one_process=jobs > 1)
    if "SLURM_JOB_ID" in os.environ:
        return steps(given.ranks, jobs)
    if not given.ranks:
        raise Failure("--launcher mpi: outside a job of Slurm, give the number of ranks of each run with --ranks N")
    if not shutil.which("mpirun"):
        raise Failure("--launcher mpi: there is no mpirun; install Open MPI (Debian: openmpi-bin), or load its module")
    # several calls of mpirun do not know of each other, and would bind their ranks to the same cores
    return Launcher(("mpirun", "--bind-to", "none", "-n", given.ranks), threads(jobs * given.ranks))


def threads(shares):
    return ("--threads", max(1, (os.cpu_count() or 1) // shares))


def steps(ranks, jobs):
    """Returns the launcher of runs that are steps of the job that this program is part of."""
    tasks = int(os.environ.get("SLURM_NTASKS", 1))
    ranks = ranks or max(1, tasks // jobs)
    if jobs * ranks > tasks:
        raise Failure(
            f"--launcher mpi: {jobs} runs at once with {ranks} ranks each are more than the {tasks} tasks of this job; "
            "give less with --jobs or --ranks, or give the job more with --ntasks"
        )
    command = ("srun", "--exact", "--mpi=pmix", f"--ntasks={ranks}")
    cores = os.environ.get("SLURM_CPUS_PER_TASK")
    return Launcher((*command, f"--cpus-per-task={cores}"), ("--threads", cores)) if cores else Launcher(command)


def ask(*command, **options):
    """Runs a command of Slurm and returns what it prints."""
    try:
        done = subprocess.run([*map(str, command)], capture_output=True, text=True, **options)
    except FileNotFoundError:
        raise Failure(f"--launcher slurm: there is no {command[0]}; run this where Slurm is installed") from None
    if done.returncode != 0:
        raise Failure(f"{shlex.join(map(str, command))}: {done.stderr.strip() or f'ended with {done.returncode}'}")
    return done.stdout


class Array:
    """The job array of a comparison. Its folder has the batch script, which users may change, the arguments of each
    task, the number of the last job, and what the tasks printed."""

    def __init__(self, program, out):
        self._program = program
        self._folder = (out / "slurm").resolve()
        self._job = self._folder / "job"

    def is_queued(self):
        """Returns whether tasks of the last array are waiting or running."""
        return self._job.exists() and self.number() in ask("squeue", "--noheader", "--format=%F").split()

    def number(self):
        return self._job.read_text().strip()

    def submit(self, arguments, jobs, options):
        """Submits an array with one task for each element of `arguments`, which has the arguments of a run. At most
        `jobs` tasks run at once, or any number if it is None. `options` are those of sbatch. Returns the number of the
        job."""
        self._folder.mkdir(parents=True, exist_ok=True)
        script = self._folder / SCRIPT.name
        if not script.exists():
            shutil.copy(SCRIPT, script)
        tasks = self._folder / "arguments"
        tasks.write_text("".join(f"{shlex.join(map(str, each))}\n" for each in arguments))
        limit = f"%{jobs}" if jobs else ""
        job = ask(
            "sbatch",
            "--parsable",
            f"--array=1-{len(arguments)}{limit}",
            f"--output={self._folder}/%A_%a.log",
            *options,
            script,
            tasks,
            env=os.environ | {"EVODEVO_PROGRAM": self._program},
        )
        self._job.write_text(job.split(";")[0].strip() + "\n")  # after ";", the name of the cluster
        return self.number()


def make_in_array(runs, program, out, jobs, options, tell):
    """Submits those runs that are not complete, unless they are in the queue. Returns whether all are complete."""
    array = Array(program, out)
    queued = array.is_queued()  # first, since a run may be completed meanwhile
    waiting = runs.waiting()
    if not waiting:
        return True
    complete = f"{len(runs.all) - len(waiting)} of {len(runs.all)} runs are complete"
    if queued:
        tell(f"{complete}; job {array.number()} makes the others: squeue --job={array.number()}")
    else:
        for run in waiting:
            runs.clear(run)
        job = array.submit([runs.arguments(run) for run in waiting], jobs, options)
        tell(f"{complete}; submitted job {job} for the others, which prints to {out / 'slurm'}")
    tell("when it has ended, the same command makes the report, or submits again what is not complete")
    return False
