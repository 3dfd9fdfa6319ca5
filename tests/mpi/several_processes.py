"""Runs the command in several processes of mpirun, and compares what it writes with what one process writes.

    several_processes.py CASE --abbe PROGRAM --mpirun PROGRAM --examples FOLDER --out FOLDER
"""

import argparse
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import time

#: Open MPI asks for more cores than a small machine has, and refuses root without these.
ENVIRONMENT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMPI_MCA_btl": "self,vader",
               "OMPI_MCA_rmaps_base_oversubscribe": "1", "OMPI_MCA_hwloc_base_binding_policy": "none"}


class Runs:
    def __init__(self, arguments):
        self.abbe, self.mpirun = arguments.abbe, arguments.mpirun
        self.examples, self.out = arguments.examples, arguments.out

    def environment(self, **more):
        return {**os.environ, **ENVIRONMENT, **more}

    def alone(self, *words):
        return subprocess.run([self.abbe, *map(str, words)], capture_output=True, text=True)

    def together(self, processes, *words, **more):
        return subprocess.run([self.mpirun, "-n", str(processes), str(self.abbe), *map(str, words)],
                              capture_output=True, text=True, env=self.environment(**more))


def require(true, *words):
    if not true:
        sys.exit("FAILED: " + " ".join(map(str, words)))


def files_of(folder):
    return {path.relative_to(folder): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


def same_bytes(runs):
    """Every file of the results, for 2, 3 and 5 processes."""
    for study in ("three_axis/interferometer.study.toml", "trunnion/polygon-and-r-test.study.toml"):
        name = pathlib.Path(study).stem
        alone = runs.alone("run", runs.examples / study, "-o", runs.out / name / "results")
        require(alone.returncode == 0, study, alone.stderr)
        expected = files_of(runs.out / name / "results")
        require(len(expected) > 3, "few files:", list(expected))
        (runs.out / name / "results").rename(runs.out / name / "alone")
        for processes in (2, 3, 5):
            done = runs.together(processes, "run", runs.examples / study, "-o", runs.out / name / "results")
            require(done.returncode == 0, study, processes, done.stderr)
            require(done.stdout == alone.stdout, study, processes, "prints", done.stdout)
            found = files_of(runs.out / name / "results")
            require(found.keys() == expected.keys(), processes, found.keys(), expected.keys())
            for path, content in expected.items():
                require(found[path] == content, study, processes, path, "has other bytes")
            shutil.rmtree(runs.out / name / "results")


def other_files(runs):
    """A process that reads another study than the first one, or finds none."""
    study, other, script = runs.examples / "three_axis/interferometer.study.toml", runs.out / "other.toml", runs.out / "abbe"
    text = study.read_text().replace('"../machines/', f'"{runs.examples}/machines/', 1)
    require("\nseed = 9\n" in text, study, "has another seed now")
    script.write_text("#!/bin/sh\n"
                      f'if [ "$OMPI_COMM_WORLD_RANK" = 1 ]; then set -- run "{other}" -o "{runs.out}/of-other"; fi\n'
                      f'exec "{runs.abbe}" "$@"\n')
    script.chmod(0o755)
    for content, expected in ((text.replace("\nseed = 9\n", "\nseed = 99\n", 1), "of another problem"),
                              (None, "process 2 of 2")):
        other.unlink(missing_ok=True)
        if content:
            other.write_text(content)
        done = subprocess.run([runs.mpirun, "-n", "2", script, "run", study, "-o", runs.out / "results"],
                              capture_output=True, text=True, env=runs.environment())
        require(done.returncode == 2, "exit code", done.returncode, done.stderr)
        require("abbe: " in done.stderr and expected in done.stderr, done.stderr)
        require(not (runs.out / "results").exists(), "results were written")


def lost_process(runs):
    """A process that is killed ends the job, and nothing is left half done."""
    study = runs.examples / "aguado/aguado.study.toml"
    job = subprocess.Popen([runs.mpirun, "-n", "2", str(runs.abbe), "run", str(study), "-o", str(runs.out / "results")],
                           stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=runs.environment())
    worker = None
    for _ in range(2000):
        children = subprocess.run(["ps", "-o", "pid=,args=", "--ppid", str(job.pid)], capture_output=True, text=True)
        found = [int(line.split()[0]) for line in children.stdout.splitlines() if str(study) in line]
        if len(found) == 2:
            worker = max(found)
            break
        require(job.poll() is None, "the job ended before it was disturbed")
        time.sleep(0.005)
    require(worker is not None, "no two processes were started")
    os.kill(worker, signal.SIGKILL)
    _, errors = job.communicate(timeout=120)
    require(job.returncode != 0, "exit code 0")
    require("signal 9" in errors, errors)
    left = files_of(runs.out / "results") if (runs.out / "results").exists() else {}
    require(not left, "left over:", list(left))


def other_subcommands(runs):
    """Only the first process works and writes."""
    words = ("evaluate", "positioning", runs.examples / "evaluate/linear.csv")
    alone, done = runs.alone(*words), runs.together(3, *words)
    require(done.returncode == alone.returncode and done.stdout == alone.stdout, done.stdout, done.stderr)
    quiet = runs.together(2, "-q", "run", runs.examples / "three_axis/interferometer.study.toml", "-o", runs.out / "quiet")
    require(quiet.returncode == 0 and not quiet.stdout, "an option before the subcommand:", quiet.stderr)
    require((runs.out / "quiet/errors.toml").is_file(), "no results")
    study = runs.out / "readings.study.toml"
    text = (runs.examples / "three_axis/interferometer.study.toml").read_text()
    study.write_text(text[:text.index("[identify")].replace('"../machines/', f'"{runs.examples}/machines/', 1))
    alone, done = runs.alone("run", study, "-o", runs.out / "a"), runs.together(2, "run", study, "-o", runs.out / "b")
    require(done.returncode == alone.returncode, "without [identify]:", done.stderr)
    wrong = runs.together(3, "run", runs.out / "none.toml")
    require(wrong.returncode == 2, wrong.returncode)
    require(wrong.stderr.count("none.toml") == 1, "said more than once:", wrong.stderr)


def missing_program(runs):
    done = runs.together(2, "--version", ABBE_MPI_PROGRAM=str(runs.out / "no-program"))
    require(done.returncode == 2, done.returncode, done.stdout)
    require(done.stderr.count("no-program") == 1, done.stderr)


CASES = {"SameBytes": same_bytes, "WorkersOfOtherFiles": other_files, "LostProcess": lost_process,
         "OtherSubcommands": other_subcommands, "MissingProgram": missing_program}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("case", choices=CASES)
    for name in ("--abbe", "--mpirun", "--examples", "--out"):
        parser.add_argument(name, required=True, type=pathlib.Path)
    arguments = parser.parse_args()
    shutil.rmtree(arguments.out, ignore_errors=True)
    arguments.out.mkdir(parents=True)
    CASES[arguments.case](Runs(arguments))
    return 0


if __name__ == "__main__":
    sys.exit(main())
