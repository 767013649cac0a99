"""A copy of the sources, which can be changed, built and tested without a trace in the user's own."""

import collections
import dataclasses
import hashlib
import json
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import time

from common.command_line import Failure

NOT_ASKED = {"gpu", "slow", "slurm", "viewer"}  # labels of tests that take long, or hardly depend on the C++ sources
LIMITS = ["prlimit", f"--as={16 << 30}", f"--fsize={4 << 30}"]  # of each process of a test, in bytes
# Nothing that a test starts outlives it or this process, or can end a process of others.
APART = ["setpriv", "--pdeathsig=KILL", "unshare", "--pid", "--fork", "--kill-child", "--mount-proc"]
APART += ["--user", "--map-current-user"] if os.getuid() else []
TOO_LONG = (124, 137)  # exit codes of `timeout`
QUICK = 0.05  # s that most cases of GoogleTest take at most
BUILD = 'source "$0/tools/setup" && evodevo_tests=ON && EVODEVO_PRESET=cpu evodevo_setup all && echo "$evodevo_build"'


class DoesNotCompile(Exception):
    """What was changed is no valid source."""


@dataclasses.dataclass(frozen=True)
class Group:
    """Tests that are run together."""

    name: str
    target: str  # what must be built for them
    command: list[str]
    folder: str  # in which they are run
    programs: dict[str, str]  # what they may use, by path in the build folder, with its hash without a fault
    cases: int
    is_googletest: bool
    seconds: float = 0  # that they take without a fault


class Workshop:
    """The last commit of the checkout `root`, in a folder in which its build is kept, too. A group of tests has failed if
    it takes more than five times as long as without a fault, and `patience` seconds."""

    def __init__(self, root, folder, patience=60):
        self._root, self.sources, self._patience = root, (folder / "sources").resolve(), patience
        self._home = (folder / "home").resolve()  # of the programs that are tried, which may write there

    def open(self):
        """Brings the copy up to date, builds it, and runs its tests, which must pass."""
        if subprocess.run([*APART, *LIMITS, "true"], capture_output=True).returncode != 0:
            raise Failure("a program with a fault must not reach other processes, but `unshare --pid` does not work "
                          "here; try as root, or on a system that allows namespaces")  # fmt: skip
        for folder in (self.sources, self._home):
            folder.mkdir(parents=True, exist_ok=True)
        self.git("init", "--quiet")
        self.git("fetch", "--quiet", "--depth=1", self._root, "HEAD")
        self.restore("FETCH_HEAD")
        built = subprocess.run(["bash", "-c", BUILD, self.sources], stdout=subprocess.PIPE, text=True)
        if built.returncode != 0:
            raise Failure(f"{self.sources}: the last commit cannot be built; see above")
        self._build = pathlib.Path(built.stdout.strip())
        groups = [part for group in self._groups() for part in self._timed(group)]
        self.groups = sorted(groups, key=lambda group: group.seconds / group.cases)  # those first that ask the most in a second

    def restore(self, commit="HEAD"):
        self.git("checkout", "--quiet", "--force", "--detach", commit)

    def git(self, *words):
        if not shutil.which("git"):
            raise Failure("there is no git, with which the sources are copied; apt-get install git")
        done = self._done("git", "-C", self.sources, *words)
        if done.returncode != 0:
            raise Failure(f"git {words[0]}: {done.stderr.partition(chr(10))[0]}; this needs a checkout with a commit")
        return done.stdout

    def source_files(self):
        """Returns the files of the project that are part of a program."""
        read = re.findall(r"^ {4}(.*)$", self._ninja("-t", "deps").stdout, re.MULTILINE)
        inside = {os.path.relpath(self._build / each, self.sources) for each in set(read)}
        return sorted(inside.intersection(self.git("ls-files").splitlines()))

    def affected(self, group):
        """Builds what a group of tests needs; returns whether that differs from what it is without a fault."""
        if self._ninja(group.target).returncode != 0:
            raise DoesNotCompile
        return any(self._hash(program) != known for program, known in group.programs.items())

    def failed(self, group):
        """Runs a group of tests; returns what has failed, or None."""
        code, said = self._run(group, 5 * group.seconds + self._patience)
        return f"{group.name}: {failure(code, said)}" if code else None

    def _groups(self):
        """Returns a group for each program of GoogleTest, and one for all other tests."""
        listed = json.loads(self._done("ctest", "--test-dir", self._build, "--show-only=json-v1").stdout)["tests"]
        folders, cases, others = {}, collections.Counter(), []
        for test in listed:
            properties = {each["name"]: each["value"] for each in test["properties"]}
            if NOT_ASKED.intersection(properties.get("LABELS", ())):
                continue
            if any(word.startswith("--gtest_filter=") for word in test["command"]):
                folders[test["command"][0]] = properties["WORKING_DIRECTORY"]
                cases[test["command"][0]] += 1
            else:
                others.append(re.escape(test["name"]))
        for program, folder in folders.items():
            target = os.path.relpath(program, self._build)
            command = [program, "--gtest_fail_fast"]
            yield Group(pathlib.Path(program).name, target, command, folder, self._programs(target), cases[program], True)
        if others:
            command = ["ctest", "--parallel", str(os.cpu_count()), "--stop-on-failure", "-R", f"^({'|'.join(others)})$"]
            yield Group("ctest", "all", command, str(self._build), self._programs("all"), len(others), False)

    def _programs(self, target):
        outputs = re.findall(r" -o (\S+)", self._ninja("-t", "commands", target).stdout)
        return {each: self._hash(each) for each in outputs if not each.endswith(".o")}

    def _hash(self, program):
        return hashlib.sha256((self._build / program).read_bytes()).hexdigest()

    def _timed(self, group):
        """Runs tests, and yields them with the time that they take. The quick cases of a program are a group of their own, so
        that those of all programs can be run before the others."""
        times = self._home / "times.json"
        began = time.monotonic()
        code, said = self._run(group, 3600, {"GTEST_OUTPUT": f"json:{times}"} if group.is_googletest else {})
        if code != 0:
            what = f"{group.name}: {failure(code, said)}, though nothing is planted"
            raise Failure(f"{what}; first let the tests of the last commit pass")
        if not group.is_googletest:
            yield dataclasses.replace(group, seconds=time.monotonic() - began)
            return
        parts = {True: {}, False: {}}
        for suite in json.loads(times.read_text())["testsuites"]:
            for case in suite["testsuite"]:
                seconds = float(case["time"].removesuffix("s"))
                parts[seconds <= QUICK][f"{suite['name']}.{case['name']}"] = seconds
        for cases in filter(None, parts.values()):
            command = [*group.command, f"--gtest_filter={':'.join(cases)}"]
            yield dataclasses.replace(group, command=command, cases=len(cases), seconds=sum(cases.values()))

    def _run(self, group, seconds, variables={}):
        """Returns the exit code of tests, and the end of what they say."""
        with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as scratch:
            here = {name: value for name, value in os.environ.items() if not name.startswith("XDG_")}
            here |= {"HOME": str(self._home), "TMPDIR": scratch} | variables
            command = [*APART, "timeout", "--kill-after=10", str(seconds), *LIMITS, *group.command]
            with tempfile.TemporaryFile() as said:
                options = {"stdin": subprocess.DEVNULL, "stdout": said, "stderr": subprocess.STDOUT}
                code = subprocess.run(command, cwd=group.folder, env=here, **options).returncode
                said.seek(-min(100_000, said.seek(0, os.SEEK_END)), os.SEEK_END)
                return code, said.read().decode(errors="replace")

    def _ninja(self, *words):
        return self._done("ninja", "-C", self._build, *words)

    @staticmethod
    def _done(*command):
        return subprocess.run(command, capture_output=True, text=True)


def failure(code, said):
    """Returns what has failed first, given the exit code of tests and what they said."""
    if code in TOO_LONG:
        return "too long"
    case = re.search(r"\[  FAILED  \] (\S+\.[^\s,]+)|Test +#\d+: (\S+) .*\*\*\*", said)
    return (case[1] or case[2]) if case else f"exit code {code}"
