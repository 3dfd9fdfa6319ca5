"""Runs `abbe plan` in several processes of mpirun.

    plans.py CASE --abbe PROGRAM --mpirun PROGRAM --examples FOLDER --out FOLDER
"""

import os
import pathlib
import signal
import subprocess
import sys
import time

sys.dont_write_bytecode = True
from several_processes import main, ranks_of, require  # noqa: E402


def plan_study(runs, name="trunnion.study.toml", readings=100, threads=0):
    """Candidates enough that the choice itself is shared."""
    text = (runs.examples / "trunnion/trunnion.study.toml").read_text()
    for before, after in (('"../machines/', f'"{runs.examples}/machines/'), ("\nposes = 1500\n", "\nposes = 500\n"),
                          ("\nreadings = 240\n", f"\nreadings = {readings}\n"),
                          ("\nseed = 5\n", f"\nseed = 5\nthreads = {threads}\n")):
        require(before in text, "the study has changed:", before)
        text = text.replace(before, after, 1)
    (runs.out / name).write_text(text)
    return runs.out / name


def same_plans(runs, studies, files, processes_of):
    """What every number of processes prints and writes; 0: without mpirun."""
    expected = None
    for processes in processes_of:
        study = studies[processes % len(studies)]
        words = ("plan", study, "-o", runs.out / files[0], "--report", runs.out / files[1], "--json", "--force")
        done = runs.together(processes, *words) if processes else runs.alone(*words)
        require(done.returncode == 0, processes, done.stderr)
        found = [done.stdout, *((runs.out / name).read_bytes() for name in files)]
        expected = expected or found
        require(found == expected, processes, "processes: other bytes")
    return expected[0]


def plans(runs):
    """The readings of a plan, and the grids that it is compared with, for 1 to 5 processes and 1, 2 threads."""
    (runs.out / "1").mkdir()
    (runs.out / "2").mkdir()
    studies = [plan_study(runs, f"{threads}/trunnion.study.toml", threads=threads) for threads in (1, 2)]
    words = same_plans(runs, studies, ("poses.csv", "page.html"), (0, 1, 2, 3, 4, 5))
    require("all axes together" in words, "no grids in", words)


def plans_of_setups(runs):
    """Which instruments are worth setting up: plans of their combinations within a time."""
    text = (runs.examples / "three_axis/interferometer.study.toml").read_text()
    text = text.replace('"../machines/', f'"{runs.examples}/machines/', 1)
    text += "\n[plan]\ntime_s = 5400\n"
    for name in ("positioning", "straightness", "diagonals", "step-diagonal"):
        require(f'name = "{name}"' in text, "the study has changed:", name)
        text += f"[plan.setup.{name}]\nset_up_s = 1200\n"
    study = runs.out / "setups.study.toml"
    study.write_text(text)
    words = same_plans(runs, [study], ("poses.csv", "page.html"), (0, 2, 3))
    require("step-diagonal" in words, "no combinations in", words)


def plans_of_other_files(runs):
    """A process whose study is another one is found out: another number of readings, another noise."""
    study, other, script = plan_study(runs), plan_study(runs, "other.study.toml", 101), runs.out / "abbe"
    noise = plan_study(runs, "noise.study.toml")
    text = noise.read_text()
    require("range_um = 2," in text, "the study has changed")
    noise.write_text(text.replace("range_um = 2,", "range_um = 2.001,", 1))
    for theirs in (other, noise):
        script.write_text(f'#!/bin/sh\nif [ "$OMPI_COMM_WORLD_RANK" = 1 ]; then set -- plan "{theirs}"; fi\n'
                          f'exec "{runs.abbe}" "$@"\n')
        script.chmod(0o755)
        done = subprocess.run([runs.mpirun, "-n", "2", script, "plan", study, "-o", runs.out / "poses.csv"],
                              capture_output=True, text=True, env=runs.environment())
        require(done.returncode == 2 and "of another problem" in done.stderr, theirs, done.returncode, done.stderr)
        require(not (runs.out / "poses.csv").exists(), "results were written")


def processor_time(process):
    fields = pathlib.Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def killed_plan(runs):
    """A process that is killed while readings are chosen ends the job, without results."""
    study = plan_study(runs, readings=400, threads=1)
    job = subprocess.Popen([runs.mpirun, "-n", "2", str(runs.abbe), "plan", str(study), "-o", str(runs.out / "poses.csv")],
                           stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=runs.environment())
    worker = None
    for _ in range(60000):
        require(job.poll() is None, "the job ended before it was disturbed")
        found = ranks_of(job, str(study))
        if len(found) == 2 and processor_time(max(found)) > 1:
            worker = max(found)
            break
        time.sleep(0.005)
    require(worker is not None, "no two processes were started")
    os.kill(worker, signal.SIGKILL)
    _, errors = job.communicate(timeout=120)
    require(job.returncode != 0 and "signal 9" in errors, job.returncode, errors)
    require(not (runs.out / "poses.csv").exists(), "results of a killed run")


CASES = {"Plans": plans, "PlansOfSetups": plans_of_setups, "PlansOfOtherFiles": plans_of_other_files,
         "KilledPlan": killed_plan}

if __name__ == "__main__":
    sys.exit(main(CASES))
