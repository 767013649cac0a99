"""Processes that make runs."""

import json
import pathlib
import signal
import subprocess
import tempfile

from common.command_line import Interrupted


def run_many(program, runs, jobs):
    """Makes runs in one process, `jobs` at a time, so that they share its GPUs. Each element of `runs` has the arguments of
    one `evodevo run`, with --out; what the run prints goes to that name with .log. Yields for each run, when it has
    ended, its index in `runs` and its exit code; for runs that the process has not ended, the exit code of the process."""
    if not runs:
        return
    left = set(range(len(runs)))
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder, "runs.jsonl")
        file.write_text("".join(f"{json.dumps([*map(str, arguments)])}\n" for arguments in runs))
        # in a process group of its own, so that Ctrl-C reaches only this process, which then asks the other to stop
        process = subprocess.Popen(
            [str(program), "run-many", str(file), "--jobs", str(jobs)], stdout=subprocess.PIPE, text=True, process_group=0
        )
        try:
            for line in process.stdout:
                ended = json.loads(line)
                left.remove(ended["run"])
                yield ended["run"], ended["exit_code"]
        finally:
            stop([process])
            process.stdout.close()
    for index in sorted(left):
        yield index, process.returncode


def stop(processes):
    """Asks each process to stop after the generations of its runs, and waits for it. A second interruption repeats the
    request, at which the processes stop without finishing their generations."""
    while alive := [process for process in processes if process.poll() is None]:
        try:
            for process in alive:
                process.send_signal(signal.SIGUSR1)  # which mpirun and srun forward, unlike SIGTERM
            for process in alive:
                process.wait()
        except Interrupted:
            continue
