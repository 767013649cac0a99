"""Runs a program with the library of failing_calls/, which lets one call of the program fail or end it, and reads what the
library records."""

import dataclasses
import os
import shlex
import subprocess

from .calls import Broken


@dataclasses.dataclass(frozen=True)
class Call:
    """A call in the record of a program."""

    name: str
    result: int
    file: str  # a path in the folder, which begins with a slash; empty for the folder itself
    detail: str
    data: bytes  # what was written


def read_record(file):
    """Returns the calls in a record."""
    calls, data, place = [], file.read_bytes() if file.exists() else b"", 0
    while place < len(data):
        end = data.index(b"\n", place)
        name, result, path, detail, size = data[place:end].decode().split("\t")
        place = end + 1 + int(size)
        calls.append(Call(name, int(result), path, detail, data[end + 1 : place]))
    return calls


@dataclasses.dataclass(frozen=True)
class Fault:
    """A fault of the library: its kind, the number of the call that it strikes, and the rank of MPI, if any."""

    kind: str = ""
    at: int = 0
    rank: str = ""


class Faults:
    """Calls a program with faults. `folder`: where the files are that count."""

    def __init__(self, library, folder, seconds=60):
        self._library, self.folder, self._seconds = library, folder, seconds
        self.record = folder.with_name(folder.name + ".record")

    def call(self, command, fault=Fault()):
        """Returns the finished process; raises Broken if it does not end."""
        with self.begun(command, fault) as process:
            return self.ended(process, command)

    def recorded(self, rank=None):
        """Returns the calls of the last program, or of one of its ranks."""
        return read_record(self.record if rank is None else self.record.with_name(f"{self.record.name}.{rank}"))

    def begun(self, command, fault):
        for old in self.record.parent.glob(self.record.name + "*"):
            old.unlink()
        return subprocess.Popen(
            list(map(str, command)),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env=os.environ | self._variables(fault),
        )

    def ended(self, process, command):
        try:
            out, err = process.communicate(timeout=self._seconds)
        except subprocess.TimeoutExpired:
            process.kill()
            process.communicate()
            raise Broken(f"not done after {self._seconds} s") from None
        return subprocess.CompletedProcess(command, process.returncode, out, err)

    def is_stopped(self, process):
        """Waits until a process has stopped itself, and returns True, or has ended, and returns False."""
        state = os.waitid(os.P_PID, process.pid, os.WSTOPPED | os.WEXITED | os.WNOWAIT)
        return state.si_code == os.CLD_STOPPED

    def text(self, command, fault):
        """Returns a line for a shell that repeats a call."""
        words = [f"{name}={value}" for name, value in self._variables(fault).items()]
        return shlex.join(["env", *words, *map(str, command)])

    def _variables(self, fault):
        return {
            "LD_PRELOAD": str(self._library),
            "EVODEVO_FAULTS_FOLDER": str(self.folder),
            "EVODEVO_FAULTS_RECORD": str(self.record),
            "EVODEVO_FAULTS_KIND": fault.kind,
            "EVODEVO_FAULTS_AT": str(fault.at),
            "EVODEVO_FAULTS_RANK": fault.rank,
        }
