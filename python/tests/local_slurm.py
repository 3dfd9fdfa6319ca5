"""A Slurm of one node in a temporary folder, for a test: munged, slurmctld and slurmd, which stop with it."""

import getpass
import os
import shutil
import socket
import subprocess
import time
from pathlib import Path

CONFIGURATION = """
ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={controller}
SlurmdPort={node}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
CredType=cred/munge
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
ReturnToService=2
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=sched_interval=2,bf_interval=2
NodeName={host} NodeAddr=127.0.0.1 CPUs={cpus} State=UNKNOWN
PartitionName=test Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""
PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch", "squeue", "scontrol")


def missing_programs():
    path = os.pathsep.join([os.environ.get("PATH", ""), "/usr/sbin", "/sbin"])
    return [name for name in PROGRAMS if shutil.which(name, path=path) is None]


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


class LocalSlurm:
    """with LocalSlurm(folder) as slurm: subprocess.run(["sbatch", ...], env=slurm.environment)"""

    def __init__(self, folder):
        self.folder = Path(folder)
        self.environment = dict(os.environ, SLURM_CONF=str(self.folder / "slurm.conf"),
                                PATH=os.environ["PATH"] + ":/usr/sbin:/sbin")
        self._processes = []

    def _start(self, *command):
        log = open(self.folder / f"{Path(command[0]).name}.out", "wb")
        self._processes.append(subprocess.Popen(command, env=self.environment, stdout=log, stderr=log,
                                                stdin=subprocess.DEVNULL, start_new_session=True))

    def __enter__(self):
        try:
            self._enter()
        except BaseException:
            self.__exit__()
            raise
        return self

    def _enter(self):
        for name in ("state", "spool"):
            (self.folder / name).mkdir(parents=True, exist_ok=True)
        self.folder.chmod(0o755)
        key = self.folder / "munge.key"
        key.write_bytes(os.urandom(128))
        key.chmod(0o400)
        (self.folder / "slurm.conf").write_text(CONFIGURATION.format(
            host=socket.gethostname().split(".")[0], controller=free_port(), node=free_port(), user=getpass.getuser(),
            folder=self.folder, cpus=os.cpu_count()))
        self._start("munged", "--foreground", "--force", f"--socket={self.folder}/munge.socket", f"--key-file={key}",
                    f"--pid-file={self.folder}/munged.pid", f"--log-file={self.folder}/munged.log",
                    f"--seed-file={self.folder}/munge.seed")
        self._wait(lambda: (self.folder / "munge.socket").exists(), "munged did not open its socket")
        self._start("slurmctld", "-D", "-f", str(self.folder / "slurm.conf"))
        self._start("slurmd", "-D", "-f", str(self.folder / "slurm.conf"))
        self._wait(lambda: "idle" in self.output("sinfo", "-h", "-o", "%T"), "no node is idle")

    def output(self, *command):
        done = subprocess.run(command, env=self.environment, capture_output=True, text=True, timeout=60)
        return done.stdout + done.stderr

    def logs(self):
        return "\n".join(f"== {path.name}\n{path.read_text(errors='replace')[-2000:]}"
                         for path in sorted(self.folder.glob("*.log")) + sorted(self.folder.glob("*.out")))

    def _wait(self, is_so, problem, seconds=60):
        end = time.monotonic() + seconds
        while not is_so():
            died = [process.args[0] for process in self._processes if process.poll() is not None]
            if died or time.monotonic() > end:
                raise RuntimeError(f"{problem}; ended: {died}\n{self.logs()}")
            time.sleep(0.2)

    def wait_for_jobs(self, seconds=240):
        self._wait(lambda: self.output("squeue", "-h").strip() == "", "jobs are still in the queue", seconds)

    def _cancel_jobs(self):
        """A job outlives slurmd, which would find it again."""
        try:
            self.output("scancel", f"--user={getpass.getuser()}")
            self._wait(lambda: self.output("squeue", "-h").strip() == "", "jobs do not end", 20)
        except (RuntimeError, OSError, subprocess.TimeoutExpired):
            pass  # then the test has failed already, and its message is the one to be seen

    def __exit__(self, *_):
        if (self.folder / "slurmctld.pid").exists():
            self._cancel_jobs()
        for process in reversed(self._processes):
            process.terminate()
        for process in reversed(self._processes):
            try:
                process.wait(20)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
