"""As several_processes.py, for so many processes that some relay what others send (mpi/process_tree.h).

Of eight processes, those with the ranks 1, 2, 4 and 6 stand below the first one, and 3, 5 and 7 below 2, 4 and 6.
"""

import os
import signal
import subprocess
import sys
import time

from plans import plan_study, processor_time
from scan_cases import register_words, scan_with_another_bit
from several_processes import (main, monte_carlo_study, ranks_of, require, require_same_results, scan_of_part)


def require_same(runs, words, files, processes_of):
    """What every number of processes prints and writes; 0: without mpirun."""
    expected = None
    for processes in processes_of:
        done = runs.together(processes, *words) if processes else runs.alone(*words)
        require(done.returncode == 0, words[0], processes, done.stderr)
        found = [done.stdout, *(path.read_bytes() for path in files)]
        expected = expected or found
        require(found == expected, words[0], processes, "processes: other bytes")


def any_number(runs):
    """Plans (in step), identifications with Monte Carlo (sums, numbered work) and registrations.

    With up to five processes all stand below the first one; of six, one relays; of nine, all four do.
    """
    numbers = (0, 1, 3, 5, 6, 9)
    poses, errors = runs.out / "poses.csv", runs.out / "found.errors.toml"
    study = monte_carlo_study(runs, "study", 1000, 1)
    require_same(runs, ("identify", study, "-o", errors, "--json", "--force"), [errors], numbers)
    study = plan_study(runs, readings=40, threads=1)
    require_same(runs, ("plan", study, "-o", poses, "--json", "--force"), [poses], numbers)
    words = register_words(runs, scan_of_part(runs, "scan.ply", 60), "--threads", 1)
    require_same_results(runs, words, tuple((processes, ()) for processes in (0, 1, 6, 9)))


def run_with_others(runs, words, others):
    """The job of eight processes where those with the given ranks run other commands."""
    def quoted(given):
        return " ".join(f"'{word}'" for word in given)
    script = runs.out / "abbe"
    lines = [f'if [ "$OMPI_COMM_WORLD_RANK" = {rank} ]; then exec "{runs.abbe}" {quoted(theirs)}; fi\n'
             for rank, theirs in others.items()]
    script.write_text("#!/bin/sh\n" + "".join(lines) + f'exec "{runs.abbe}" {quoted(words)}\n')
    script.chmod(0o755)
    return subprocess.run([runs.mpirun, "-n", "8", script], capture_output=True, text=True, env=runs.environment(),
                          timeout=120)


def kinds_of_work(runs):
    """Commands of each kind of shared work, and the same with other files."""
    plan, other_plan = plan_study(runs, threads=1), plan_study(runs, "other.study.toml", 101, 1)
    runs_study = monte_carlo_study(runs, "study", 20000, 1)
    other_study = runs.out / "other-run.study.toml"
    text = runs_study.read_text()
    require("\nseed = 9\n" in text, "the study has changed")
    other_study.write_text(text.replace("\nseed = 9\n", "\nseed = 99\n", 1))
    scan, other_scan = scan_of_part(runs, "scan.ply", 60), scan_with_another_bit(runs, "other.ply", 60)
    results = ("-o", runs.out / "results")
    return {"plan": [("plan", study, "-o", runs.out / "results") for study in (plan, other_plan)],
            "run": [("run", study, *results) for study in (runs_study, other_study)],
            "register": [(*register_words(runs, file), "--threads", 1) for file in (scan, other_scan)]}


def require_refused(runs, done, *words):
    require(done.returncode == 2 and "expected the same program and the same files" in done.stderr, *words,
            done.returncode, done.stderr)
    require(not (runs.out / "results").exists(), *words, "results were written")


def other_files(runs):
    """A process that relays, one below another that relays, or both, have other files."""
    for name, (words, theirs) in kinds_of_work(runs).items():
        for ranks in ((2,), (3,), (2, 3)):
            done = run_with_others(runs, words, dict.fromkeys(ranks, theirs))
            require_refused(runs, done, name, ranks)
            named = [rank for rank in ranks if f"process {rank + 1} of 8" in done.stderr]
            require(named and "of another problem" in done.stderr, name, ranks, done.stderr)


def other_commands(runs):
    """Processes that relay, or not, do work of another kind, or end early: none of the others hangs."""
    kinds = {name: words for name, (words, _) in kinds_of_work(runs).items()}
    ends = {"has ended": ("evaluate", "positioning", runs.examples / "evaluate/linear.csv"),
            "none.toml": ("plan", runs.out / "none.toml")}
    for name, words in kinds.items():
        for rank in (2, 3):
            for said, theirs in ends.items():
                done = run_with_others(runs, words, {rank: theirs})
                require_refused(runs, done, name, rank, said)
                require(f"process {rank + 1} of 8" in done.stderr and said in done.stderr, name, rank, done.stderr)
            for other, theirs in kinds.items():
                if other != name:
                    require_refused(runs, run_with_others(runs, words, {rank: theirs}), name, rank, other)


def killed_below(runs):
    """A killed process ends the job, also if another one stands between it and the first one."""
    study = plan_study(runs, readings=400, threads=1)
    for rank in (2, 3):
        words = ("plan", str(study), "-o", str(runs.out / "poses.csv"))
        job = subprocess.Popen([runs.mpirun, "-n", "8", str(runs.abbe), *words],
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=runs.environment())
        for _ in range(60000):
            require(job.poll() is None, "the job ended before it was disturbed")
            found = sorted(ranks_of(job, str(study)))
            if len(found) == 8 and processor_time(found[rank]) > 1:
                break
            time.sleep(0.005)
        os.kill(found[rank], signal.SIGKILL)
        _, errors = job.communicate(timeout=120)
        require(job.returncode != 0 and "signal 9" in errors, rank, job.returncode, errors)
        require(not (runs.out / "poses.csv").exists(), "results of a killed run")


CASES = {"AnyNumber": any_number, "OtherFilesBelow": other_files, "OtherCommandsBelow": other_commands,
         "KilledBelow": killed_below}

if __name__ == "__main__":
    sys.exit(main(CASES))
