"""As several_processes.py, on two nodes: this machine and a network namespace with a name and an address of its own.

mpirun starts a daemon in the namespace, as it does on another machine, and the processes are joined by TCP. It needs
root and iproute2; without them the tests are skipped (exit code 77).
"""

import contextlib
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import time

from plans import plan_study
from scan_cases import register_words
from several_processes import (deviate_words, files_of, main, monte_carlo_study, require, scan_of_part)


def skipped(why):
    print("skipped:", why)
    return 77


class TwoNodes:
    """The second node, for as long as the context lasts."""

    def __init__(self, runs):
        self.runs, number = runs, os.getpid() % 60000
        self.name, self.here, self.there = f"abbe-{number}", f"abh{number}", f"abt{number}"
        self.network, *self.addresses = (f"10.213.{number % 256}.{number % 64 * 4 + k}" for k in range(3))

    def ip(self, *words):
        try:
            return subprocess.run(["ip", *words], capture_output=True, text=True)
        except FileNotFoundError:
            sys.exit(skipped("there is no ip (iproute2)"))

    def __enter__(self):
        there = ("netns", "exec", self.name, "ip")
        for words in (("netns", "add", self.name),
                      ("link", "add", self.here, "type", "veth", "peer", "name", self.there),
                      ("link", "set", self.there, "netns", self.name),
                      ("addr", "add", f"{self.addresses[0]}/30", "dev", self.here), ("link", "set", self.here, "up"),
                      (*there, "addr", "add", f"{self.addresses[1]}/30", "dev", self.there),
                      (*there, "link", "set", self.there, "up"), (*there, "link", "set", "lo", "up")):
            done = self.ip(*words)
            if done.returncode != 0:
                self.__exit__()
                sys.exit(skipped(f"no second node can be made: {done.stderr.strip()}"))
        self.agent, self.hosts = self.runs.out / "agent", self.runs.out / "hosts"
        self.agent.write_text("#!/bin/sh\n# What mpirun would run on a machine of that name by ssh.\nshift\n"
                              f'exec ip netns exec {self.name} unshare --uts sh -c "hostname {self.name}; $*"\n')
        self.agent.chmod(0o755)
        self.hosts.write_text("".join(f"{address} slots=1\n" for address in self.addresses))
        return self

    def __exit__(self, *_):
        for process in self.processes():
            with contextlib.suppress(ProcessLookupError):
                os.kill(process, signal.SIGKILL)
        self.ip("link", "delete", self.here)
        self.ip("netns", "delete", self.name)

    def processes(self):
        """Numbers of those on the second node."""
        return [int(line) for line in self.ip("netns", "pids", self.name).stdout.split()]

    def daemon(self):
        """The number of mpirun's daemon there."""
        (found,) = [one for one in self.processes() if pathlib.Path(f"/proc/{one}/comm").read_text() == "orted\n"]
        return found

    def cut_off(self):
        """As if its power were gone: nothing that is sent arrives, and no connection is closed."""
        self.ip("netns", "exec", self.name, "ip", "link", "set", self.there, "down")

    def start(self, *words, options=()):
        network = f"{self.network}/30"
        command = [self.runs.mpirun, "--hostfile", self.hosts, "--map-by", "node", "-n", "2", "--mca",
                   "plm_rsh_agent", self.agent, "--mca", "btl", "tcp,self", "--mca", "oob_tcp_if_include", network,
                   "--mca", "btl_tcp_if_include", network, *options, self.runs.abbe, *words]
        return subprocess.Popen([str(word) for word in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                text=True, env=self.runs.environment(), start_new_session=True)

    def run(self, *words):
        job = self.start(*words)
        printed, errors = job.communicate(timeout=240)
        require(job.returncode == 0, words[0], errors)
        return printed


def two_nodes(runs):
    """What a study, a plan, a registration and deviations print and write."""
    study = runs.examples / "aguado/aguado.study.toml"
    scan, results = scan_of_part(runs, "scan.ply", 60), runs.out / "results"
    with TwoNodes(runs) as nodes:
        for words in (("run", study, "-o", results), ("plan", plan_study(runs, readings=40)),
                      register_words(runs, scan), deviate_words(runs, scan)):
            alone = runs.alone(*words)
            require(alone.returncode == 0, words[0], alone.stderr)
            expected = files_of(results) if results.exists() else {}
            shutil.rmtree(results, ignore_errors=True)
            require(nodes.run(*words) == alone.stdout, words[0], "prints something else")
            require((files_of(results) if results.exists() else {}) == expected, words[0], "other bytes")
            shutil.rmtree(results, ignore_errors=True)


def start_long_work(runs, nodes, kept, options=()):
    """A Monte Carlo that both nodes have begun, or begun again."""
    before = kept.stat().st_size if kept.exists() else 0
    job = nodes.start("run", monte_carlo_study(runs, "study", runs.samples, 1), "-o", runs.out / "results",
                      options=options)
    for _ in range(6000):
        require(job.poll() is None, "the work ended before it was disturbed")
        if kept.exists() and kept.stat().st_size > before + 8_000_000:
            return job
        time.sleep(0.01)
    sys.exit("FAILED: no finished blocks after a minute")


def lost_node(runs):
    """A node that fails, and one that falls silent: the job says so, and is resumed with the bytes of one process."""
    kept = runs.out / "results.unfinished"
    quick = ("--mca", "oob_tcp_keepalive_time", "10", "--mca", "oob_tcp_keepalive_intvl", "2", "--mca",
             "oob_tcp_keepalive_probes", "3")
    for silent in (False, True):
        with TwoNodes(runs) as nodes:
            job = start_long_work(runs, nodes, kept, quick if silent else ())
            if silent:
                nodes.cut_off()
            else:
                os.kill(nodes.daemon(), signal.SIGKILL)
            try:
                _, errors = job.communicate(timeout=120)
            finally:
                if job.poll() is None:
                    os.killpg(job.pid, signal.SIGKILL)
            require(job.returncode != 0, "exit code 0")
            require("lost communication" in errors and nodes.addresses[1] in errors, errors)
            require(not (runs.out / "results").exists(), "results were written")
            require(kept.exists(), "the finished blocks are gone")
    words = ("run", runs.out / "study.study.toml", "-o", runs.out / "results")
    resumed = runs.together(2, *words)
    require(resumed.returncode == 0 and "are taken from" in resumed.stderr, resumed.stderr)
    found = files_of(runs.out / "results")
    shutil.rmtree(runs.out / "results")
    alone = runs.alone(*words)
    require(alone.returncode == 0 and resumed.stdout == alone.stdout, alone.stderr)
    require(found == files_of(runs.out / "results"), "other bytes")


CASES = {"TwoNodes": two_nodes, "LostNode": lost_node}

if __name__ == "__main__":
    sys.exit(main(CASES))
