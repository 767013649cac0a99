"""A Slurm cluster of two nodes on this machine, for tests.

The cluster lives in namespaces of its own: processes, mounts, network and host name. When the first process of the
process namespace ends, for whatever reason, the kernel ends all others. So no daemon and no job outlives the test, and
no port or folder is shared with another cluster."""

import contextlib
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time

SKIPPED = 77
PROGRAMS = ("munged", "slurmctld", "slurmd", "srun", "sbatch", "scontrol", "squeue", "ip")
PACKAGES = "iproute2 munge slurmctld slurmd slurm-client slurm-wlm-basic-plugins"
NODES = ("one", "two")
ADDRESSES = {"one": "10.77.0.1", "two": "10.77.0.2"}
PORTS = {"one": 17001, "two": 17002}
MOST_PROCESSES = 300  # a cluster that runs a test has less than 100
PATIENCE = 300.0  # s, for what takes seconds on an idle machine

CONFIGURATION = """\
ClusterName=test
SlurmctldHost=one(10.77.0.1)
SlurmctldPort=17000
SlurmUser=root
SlurmdUser=root
AuthInfo=socket={folder}/munge.socket
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool-%n
TmpFS=/run
SlurmdPidFile=/run/slurmd.pid
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdParameters=config_overrides
SwitchType=switch/none
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=sched_interval=1,batch_sched_delay=0,bf_interval=1,requeue_delay=1
PreemptType=preempt/partition_prio
PreemptMode=REQUEUE
GresTypes=gpu
KillWait=30
SlurmdTimeout=20
MessageTimeout=60
TCPTimeout=30
BatchStartTimeout=60
ReturnToService=2
{nodes}
PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP PriorityTier=1 GraceTime=120
PartitionName=urgent Nodes=ALL MaxTime=INFINITE State=UP PriorityTier=2 PreemptMode=OFF
"""
NODE = "NodeName={name} NodeAddr={address} Port={port} CPUs=4 RealMemory=100 Gres=gpu:2 State=UNKNOWN"
GPUS = "NodeName=one,two Name=gpu File=/dev/null\nNodeName=one,two Name=gpu File=/dev/zero\n"


class Fault(Exception):
    """The cluster does not do what a test expects; the text has the ends of its logs."""


def skip(reason):
    print(f"skipped: {reason}")
    sys.exit(SKIPPED)


def enter_namespaces():
    """Runs this program in new namespaces, as the child of the first process of its process namespace, and exits with
    its result. There, it returns. Skips the test if Slurm is not installed, or if this system does not let it."""
    os.environ["PATH"] += ":/usr/sbin"  # where Debian has the daemons
    if os.environ.get("EVODEVO_IN_NAMESPACES") == "1":
        raise_first_process()
        return
    if missing := [program for program in PROGRAMS if not shutil.which(program)]:
        skip(f"there is no {', '.join(missing)}; apt-get install {PACKAGES}")
    if os.geteuid() != 0:
        skip("the daemons of Slurm need root")
    unshare = ["unshare", "--mount", "--pid", "--net", "--uts", "--fork", "--kill-child", "--mount-proc"]
    tried = subprocess.run([*unshare, "true"], capture_output=True, text=True)
    if tried.returncode != 0:
        skip(f"this system allows no namespaces: {tried.stderr.strip()}")
    # unshare ignores SIGTERM, and ends with this process
    command = ["setpriv", "--pdeathsig", "KILL", *unshare, sys.executable, *sys.argv]
    inside = subprocess.Popen(command, env=os.environ | {"EVODEVO_IN_NAMESPACES": "1"})
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: inside.kill())
    sys.exit(inside.wait() and 1)


def raise_first_process():
    """Goes on in a child. The parent, the first process of the namespace, collects what ends, and ends with its child,
    and with it the whole namespace."""
    child = os.fork()
    if child == 0:
        return
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: os._exit(1))
    ended = 0
    while ended != child:
        ended, status = os.wait()
    os._exit(os.waitstatus_to_exitcode(status) & 0xFF)


def guard_number_of_processes():
    """Ends everything in the namespace if there are far too many processes: root has no limit of its own."""

    def watch():
        while sum(name.isdecimal() for name in os.listdir("/proc")) < MOST_PROCESSES:
            time.sleep(0.2)
        print(f"more than {MOST_PROCESSES} processes; ending all", file=sys.stderr, flush=True)
        os.kill(-1, signal.SIGKILL)

    threading.Thread(target=watch, daemon=True).start()


def wait_until(condition, what, logs=lambda: ""):
    """Waits until a condition holds, and returns its value. Fails if that takes far too long."""
    end = time.monotonic() + PATIENCE
    while not (value := condition()):
        if time.monotonic() > end:
            raise Fault(f"waited {PATIENCE:.0f} s for this: {what}\n{logs()}")
        time.sleep(0.1)
    return value


def run(*command):
    """Runs a command and returns what it writes to standard output. Fails if the command does."""
    words = [*map(str, command)]
    finished = subprocess.run(words, capture_output=True, text=True)
    if finished.returncode != 0:
        said = finished.stdout + finished.stderr
        raise Fault(f"{' '.join(words)} ended with {finished.returncode}: {said}")
    return finished.stdout


class Cluster:
    """Two nodes, `one` and `two`, each with four processors and two GPUs that are none. Use it as a context manager."""

    def __init__(self):
        self._daemons = {}
        self._cleanup = contextlib.ExitStack()

    def __enter__(self):
        with self._cleanup:
            folder = tempfile.TemporaryDirectory(prefix="evodevo-slurm-")
            self.folder = pathlib.Path(self._cleanup.enter_context(folder))
            guard_number_of_processes()
            self._cleanup.callback(self._end_all)
            self._write_configuration()
            self._make_hosts()
            self._start_munge()
            self._start("slurmctld", "slurmctld", "-D")
            for name in NODES:
                self.start_node(name)
            self.wait_for_nodes()
            self._cleanup = self._cleanup.pop_all()
        return self

    def __exit__(self, *_):
        self._cleanup.close()

    def _write_configuration(self):
        for name in ("state", *(f"spool-{node}" for node in NODES)):
            (self.folder / name).mkdir()
        nodes = "\n".join(NODE.format(name=name, address=ADDRESSES[name], port=PORTS[name]) for name in NODES)
        (self.folder / "slurm.conf").write_text(CONFIGURATION.format(folder=self.folder, nodes=nodes))
        (self.folder / "gres.conf").write_text(GPUS)
        os.environ["SLURM_CONF"] = str(self.folder / "slurm.conf")
        os.environ["OMPI_MCA_btl"] = "tcp,self"

    def _start(self, daemon, *command):
        with open(self.folder / f"{daemon}.out", "ab") as out:
            self._daemons[daemon] = subprocess.Popen(
                command, stdin=subprocess.DEVNULL, stdout=out, stderr=out, start_new_session=True
            )

    def _start_munge(self):
        key = self.folder / "munge.key"
        key.write_bytes(os.urandom(128))
        key.chmod(0o600)
        files = {"key-file": "key", "socket": "socket", "pid-file": "pid", "log-file": "log", "seed-file": "seed"}
        options = [f"--{option}={self.folder}/munge.{ending}" for option, ending in files.items()]
        self._start("munged", "munged", "--foreground", "--force", *options)
        wait_until((self.folder / "munge.socket").exists, "munged", self.logs)

    def _make_hosts(self):
        """Makes this namespace the host `one`, and others for the host `two`, both with a name and a /run of their own;
        joins them by a network."""
        socket.sethostname("one")
        self._start("host-two", "unshare", "--mount", "--uts", "--net", "sleep", "infinity")
        other = self._daemons["host-two"].pid
        wait_until(lambda: os.readlink(f"/proc/{other}/ns/net") != os.readlink("/proc/self/ns/net"), "a new network")
        self._enter = {"one": [], "two": ["nsenter", f"--target={other}", "--mount", "--uts", "--net"]}
        run("ip", "link", "add", "one", "type", "veth", "peer", "name", "two", "netns", str(other))
        run(*self._enter["two"], "hostname", "two")
        for name, enter in self._enter.items():
            run(*enter, "mount", "-t", "tmpfs", "run", "/run")
            run(*enter, "ip", "address", "add", f"{ADDRESSES[name]}/24", "dev", name)
            for interface in ("lo", name):
                run(*enter, "ip", "link", "set", interface, "up")

    def start_node(self, name):
        """Starts the daemon of a node."""
        self._start(f"slurmd-{name}", *self._enter[name], "slurmd", "-D", "-N", name)

    def kill_node(self, name):
        """Kills the daemon of a node and all processes of its jobs, as if it had lost its power."""
        for process in self._processes_on(name):
            with contextlib.suppress(ProcessLookupError):
                os.kill(process, signal.SIGKILL)
        self._daemons.pop(f"slurmd-{name}").wait()

    def _processes_on(self, name):
        """Returns the processes of the daemon and the jobs of a node, by their ids."""
        network = os.readlink(f"/proc/{self._daemons[f'slurmd-{name}'].pid}/ns/net")
        keep = {1, os.getpid(), *(daemon.pid for key, daemon in self._daemons.items() if key != f"slurmd-{name}")}
        for process in {int(entry) for entry in os.listdir("/proc") if entry.isdecimal()} - keep:
            with contextlib.suppress(FileNotFoundError):
                if os.readlink(f"/proc/{process}/ns/net") == network:
                    yield process

    @staticmethod
    def is_quiet():
        """Returns whether no job has a process on any node."""
        names = []
        for file in pathlib.Path("/proc").glob("[0-9]*/comm"):
            with contextlib.suppress(OSError):  # it has ended meanwhile
                names.append(file.read_text().strip())
        return "slurmstepd" not in names

    def _end_all(self):
        for daemon in reversed(self._daemons.values()):
            daemon.kill()
            daemon.wait()

    def wait_for_nodes(self):
        """Waits until both nodes can take jobs."""

        def ready():
            said = subprocess.run(["sinfo", "-h", "-N", "-p", "main", "-o", "%T"], capture_output=True, text=True)
            return said.stdout.split() == ["idle"] * len(NODES)

        wait_until(ready, "both nodes are idle", self.logs)

    def logs(self):
        """Returns the ends of all logs."""
        files = self.folder.glob("*.out")
        return "\n".join(f"== {file.name}\n" + "\n".join(file.read_text().splitlines()[-25:]) for file in files)
