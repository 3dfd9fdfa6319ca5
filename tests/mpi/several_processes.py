"""Runs the command in several processes of mpirun, and compares what it writes with what one process writes.

    several_processes.py CASE --abbe PROGRAM --mpirun PROGRAM --examples FOLDER --out FOLDER
"""

import argparse
import array
import os
import pathlib
import random
import re
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
        self.samples = 200000  # of a Monte Carlo that takes some 10 s, or 20 s on a slow processor

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
    # The readings of the third are the same, but not the rows of residuals.csv.
    require('\nname = "positioning"\n' in text, study, "has another first set-up now")
    for content, expected in ((text.replace("\nseed = 9\n", "\nseed = 99\n", 1), "of another problem"),
                              (None, "process 2 of 2"),
                              (text.replace('\nname = "positioning"\n', '\nname = "elsewhere"\n', 1),
                               "expected the same program and the same files")):
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


def monte_carlo_study(runs, name, samples, threads):
    """A study whose identification is short and whose Monte Carlo is as long as wanted."""
    text = (runs.examples / "three_axis/interferometer.study.toml").read_text()
    text = text.replace('"../machines/', f'"{runs.examples}/machines/', 1)
    text = text.replace("[identify]\n", f"[identify]\nmonte_carlo = {samples}\n", 1)
    text = text.replace("\nseed = 9\n", f"\nseed = 9\nthreads = {threads}\n", 1)
    require(f"monte_carlo = {samples}" in text and f"threads = {threads}" in text, "the study has changed")
    study = runs.out / f"{name}.study.toml"
    study.write_text(text)
    return study


def monte_carlo(runs):
    """Every file of the results of a Monte Carlo and its map, for 1, 2, 3, 5 processes and 1, 2 threads."""
    expected = None
    for threads in (1, 2):
        study = monte_carlo_study(runs, "study", 1000, threads)
        for processes in (0, 1, 2, 3, 5):
            out = runs.out / "results"
            run = runs.alone if processes == 0 else lambda *words, n=processes: runs.together(n, *words)
            done = run("run", study, "-o", out)
            require(done.returncode == 0, threads, processes, done.stderr)
            found = {path: content for path, content in files_of(out).items() if path.name != "study.toml"}
            # The study says how many threads it has.
            found = {path: content.replace(f"threads = {threads}".encode(), b"threads = T").replace(
                f'"threads": {threads}'.encode(), b'"threads": T') for path, content in found.items()}
            expected = expected or found
            require(found.keys() == expected.keys(), threads, processes, found.keys())
            for path, content in expected.items():
                require(found[path] == content, threads, processes, path, "has other bytes")
            require(not (runs.out / "results.unfinished").exists(), "short work has left a file")
            shutil.rmtree(out)
    require(b"monte_carlo" in expected[pathlib.Path("summary.json")], "no Monte Carlo in the results")


def map_words(runs, output, points, *more):
    return ("map", "--machine", runs.examples / "machines/trunnion-mill.machine.toml", "--errors",
            runs.examples / "compensate/trunnion.errors.toml", "--grid", f"X_mm=-100:100:{points}", "--grid",
            f"Y_mm=-100:100:{points}", "-o", output, *more)


def maps(runs):
    """The file and the figures of a map."""
    expected = None
    for processes in (0, 1, 2, 3, 5):
        run = runs.alone if processes == 0 else lambda *words, n=processes: runs.together(n, *words)
        done = run(*map_words(runs, runs.out / "map.csv", 20, "--force"))
        require(done.returncode == 0, processes, done.stderr)
        found = (done.stdout, (runs.out / "map.csv").read_bytes())
        expected = expected or found
        require(found == expected, processes, "processes: other bytes")


def ranks_of(job, word):
    """The numbers of the processes that mpirun has started."""
    children = subprocess.run(["ps", "-o", "pid=,args=", "--ppid", str(job.pid)], capture_output=True, text=True)
    return [int(line.split()[0]) for line in children.stdout.splitlines() if word in line]


def kill_when_kept(runs, job, kept, word, least_bytes):
    """Kills the second process as soon as the file of finished blocks has so many bytes."""
    for _ in range(60000):
        require(job.poll() is None, "the work ended before it was disturbed")
        if kept.exists() and kept.stat().st_size > least_bytes:
            break
        time.sleep(0.005)
    os.kill(max(ranks_of(job, word)), signal.SIGKILL)
    _, errors = job.communicate(timeout=120)
    require(job.returncode != 0 and "signal 9" in errors, errors)


def killed_and_resumed(runs):
    """A killed Monte Carlo goes on from its finished blocks, with any number of processes, to the same bytes."""
    study = monte_carlo_study(runs, "study", runs.samples, 1)
    out, kept = runs.out / "results", runs.out / "results.unfinished"
    alone = runs.alone("run", study, "-o", out)
    require(alone.returncode == 0, alone.stderr)
    require(not kept.exists(), "left over after the results are whole")
    expected = files_of(out)
    for processes in (0, 3):
        shutil.rmtree(out)
        job = subprocess.Popen([runs.mpirun, "-n", "2", str(runs.abbe), "run", str(study), "-o", str(out)],
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=runs.environment())
        kill_when_kept(runs, job, kept, str(study), 100)
        require(not out.exists() and kept.exists(), "results of a killed run")
        with kept.open("ab") as file:  # a record that was torn
            file.write(b"torn")
        words = ("run", study, "-o", out)
        done = runs.together(processes, *words) if processes else runs.alone(*words)
        require(done.returncode == 0, done.stderr)
        require("blocks of the Monte Carlo are taken from" in done.stderr, done.stderr)
        require(files_of(out) == expected, processes, "other bytes after a resumption")
        require(not kept.exists(), "left over after the results are whole")


def study_of_files(runs, copies):
    """The ball bar of the examples with its readings in two files, many times over, that do not fit into memory."""
    text = (runs.examples / "trunnion/ball-bar.study.toml").read_text()
    text = text.replace('"../machines/', f'"{runs.examples}/machines/', 1)
    simulated = runs.out / "simulated.study.toml"
    simulated.write_text(text)
    done = runs.alone("simulate", simulated, "-o", runs.out / "simulated")
    require(done.returncode == 0, done.stderr)
    header, rows = (runs.out / "simulated/bar.csv").read_text().split("\n", 1)
    names = [name for name in header.split(",") if name != "time_s"]
    at = header.split(",").index("time_s")
    rows = "".join(",".join(row.split(",")[:at] + row.split(",")[at + 1:]) + "\n" for row in rows.split())
    data = ""
    for name, times in (("first.csv", copies), ("second.csv", copies + 1)):
        (runs.out / name).write_text(",".join(names) + "\n" + times * rows)
        data += f'[[setup.data]]\nfile = "{name}"\n\n'
    text = re.sub(r"(?s)\[simulate\].*?(?=\[\[setup\]\])", "", text)
    text = re.sub(r"(?s)\[\[setup\.plan\]\].*?(?=\[\[setup\.plan\]\]|\[identify\])", "", text)
    text = re.sub(r"held_out_fraction = [\d.]+", "held_out_fraction = 0\nreadings_in_memory = 2000", text)
    study = runs.out / "bar.study.toml"
    study.write_text(text.replace("[identify]", data + "[identify]", 1))
    require("readings_in_memory" in study.read_text(), "the study has changed")
    return study


def read_again(runs):
    """Readings in files give the same bytes for any number of processes."""
    study = study_of_files(runs, 20)
    expected = None
    for processes in (0, 2, 3):
        out = runs.out / "results"
        done = runs.together(processes, "run", study, "-o", out) if processes else runs.alone("run", study, "-o", out)
        require("are read again for every sum" in done.stdout and done.returncode in (0, 1), done.stdout, done.stderr)
        expected = expected or files_of(out)
        require(files_of(out) == expected, processes, "processes: other bytes")
        shutil.rmtree(out)


def read_again_after_a_kill(runs):
    """Readings in files: a run that was killed goes on from its sums to the same bytes."""
    study, out, kept = study_of_files(runs, 500), runs.out / "results", runs.out / "results.unfinished"
    alone = runs.alone("run", study, "-o", out)
    require(alone.returncode in (0, 1), alone.stderr)
    expected = files_of(out)
    shutil.rmtree(out)
    first = subprocess.Popen([runs.abbe, "run", study, "-o", out], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    while not kept.exists() or kept.stat().st_size < 100000:
        require(first.poll() is None, "the work ended before it was disturbed")
        time.sleep(0.005)
    first.kill()
    first.communicate()
    require(not out.exists(), "results of a killed run")
    done = runs.alone("run", study, "-o", out)
    require("blocks of the sums over the readings are taken from" in done.stderr, done.stderr)
    require(files_of(out) == expected, "other bytes after a resumption")
    require(not kept.exists(), "left over after the results are whole")


def read_again_faults(runs):
    """Readings in files: a wrong field is named whoever finds it, and nobody works on files of his own."""
    study, script = study_of_files(runs, 60), runs.out / "abbe"
    data = runs.out / "second.csv"
    good = data.read_text()
    lines = good.splitlines()
    other = runs.out / "other"
    other.mkdir()
    shutil.copy(runs.out / "first.csv", other)
    (other / "second.csv").write_text(good[:-2] + ("1" if good[-2] != "1" else "2") + "\n")
    shutil.copy(study, other)
    script.write_text("#!/bin/sh\n"
                      f'if [ "$OMPI_COMM_WORLD_RANK" = 1 ]; then set -- run "{other / study.name}" -o "{runs.out}/o"; fi\n'
                      f'exec "{runs.abbe}" "$@"\n')
    script.chmod(0o755)
    done = subprocess.run([runs.mpirun, "-n", "2", script, "run", study, "-o", runs.out / "results"],
                          capture_output=True, text=True, env=runs.environment())
    require(done.returncode == 2 and "abbe: " in done.stderr, "other files:", done.returncode, done.stderr)
    require(not (runs.out / "results").exists() and not (runs.out / "o").exists(), "results of other files")
    data.write_text("\n".join(lines[:-1] + [lines[-1] + "mm"]) + "\n")
    for processes in (0, 2, 3):
        words = ("run", study, "-o", runs.out / "results")
        done = runs.together(processes, *words) if processes else runs.alone(*words)
        require(done.returncode == 2, processes, done.returncode, done.stderr)
        require(f"second.csv:{len(lines)}" in done.stderr and "length_mm" in done.stderr, processes, done.stderr)
        require(not (runs.out / "results").exists(), processes, "results from wrong readings")


def two_jobs(runs):
    """A second job on the same results is refused as long as the first one works."""
    study = monte_carlo_study(runs, "study", runs.samples, 1)
    out, kept = runs.out / "results", runs.out / "results.unfinished"
    first = subprocess.Popen([runs.abbe, "run", study, "-o", out], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    while not kept.exists():
        require(first.poll() is None, "the work ended before a second job was tried")
        time.sleep(0.005)
    second = runs.together(2, "run", study, "-o", out)
    require(second.returncode == 2 and "another process works on these results" in second.stderr, second.stderr)
    os.kill(first.pid, signal.SIGKILL)
    first.wait()
    full = subprocess.run(["sh", "-c", 'ulimit -f "$0"; exec "$@"', str(kept.stat().st_size // 512 + 8), runs.abbe, "run",
                           study, "-o", out], capture_output=True, text=True)
    require(full.returncode == 2 and "results.unfinished: cannot be written" in full.stderr, full.returncode, full.stderr)
    require(not out.exists(), "results without space")
    last = runs.alone("run", study, "-o", out)
    require(last.returncode == 0 and "are taken from" in last.stderr, last.stderr)


def scan_of_part(runs, name, copies):
    """The scan of the bracket in the examples many times over, each time displaced a little, as binary PLY."""
    lines = (runs.examples / "scan/bracket-scan.csv").read_text().splitlines()
    points = [tuple(map(float, line.split(","))) for line in lines if line[0] not in "#x"]
    draw, numbers = random.Random(3), array.array("f")
    for _ in range(copies):
        shift = [draw.gauss(0, 0.02) for _ in range(3)]
        for point in points:
            numbers.extend(value + move for value, move in zip(point, shift))
    header = "".join(f"property float {axis}\n" for axis in "xyz")
    path = runs.out / name
    path.write_bytes(f"ply\nformat binary_little_endian 1.0\nelement vertex {len(numbers) // 3}\n{header}end_header\n"
                     .encode() + numbers.tobytes())
    return path


def deviate_words(runs, scan, *more):
    scans = runs.examples / "scan"
    return ("deviate", scan, scans / "bracket.stl", "--transform", scans / "bracket-transform.csv", "--largest-mm", 0.3,
            "--faces-deg", 30, "-o", runs.out / "results", *more)


def require_same_results(runs, words, runs_of):
    """The text and every file in results/ for each of (processes, further words); 0 processes: without mpirun."""
    expected = None
    for processes, more in runs_of:
        run = runs.together if processes else lambda _, *all_words: runs.alone(*all_words)
        done = run(processes, *words, *more)
        require(done.returncode == 0, processes, more, done.returncode, done.stderr)
        found = (done.stdout, files_of(runs.out / "results"))
        expected = expected or found
        require(found[1].keys() == expected[1].keys() and len(found[1]) > 2, processes, more, list(found[1]))
        for path, content in expected[1].items():
            require(path.name.startswith(".") or found[1][path] == content, processes, more, path, "has other bytes")
        require(found[0] == expected[0], processes, more, "prints", found[0])
        require(not (runs.out / "results.unfinished").exists(), "left over after the results are whole")
        shutil.rmtree(runs.out / "results")


TIMES = tuple((processes, ("--threads", threads)) for processes in (0, 1, 2, 3, 5) for threads in (1, 2))


def deviations(runs):
    """Deviations of a scan in memory, for 1, 2, 3, 5 processes and 1, 2 threads."""
    scan = scan_of_part(runs, "scan.ply", 100)
    require_same_results(runs, deviate_words(runs, scan), TIMES)


def streamed_deviations(runs):
    """Deviations of a scan that is read in blocks, so long that a part of its points is shown."""
    scan = scan_of_part(runs, "scan.ply", 1200)
    require_same_results(runs, deviate_words(runs, scan, "--stream-above", 1000), TIMES[::3])


def deviations_after_a_kill(runs):
    """A killed comparison goes on from its finished pieces, with any number of processes, to the same bytes."""
    scan = scan_of_part(runs, "scan.ply", 6000)
    out, kept = runs.out / "results", runs.out / "results.unfinished"
    words = deviate_words(runs, scan, "--stream-above", 1000, "--threads", 1)
    alone = runs.alone(*words)
    require(alone.returncode == 0 and not kept.exists(), alone.stderr)
    expected = files_of(out)
    for processes in (0, 3):
        shutil.rmtree(out)
        job = subprocess.Popen([runs.mpirun, "-n", "2", str(runs.abbe), *map(str, words)],
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=runs.environment())
        kill_when_kept(runs, job, kept, str(scan), 100)
        require(not out.exists() and kept.exists(), "results of a killed run")
        done = runs.together(processes, *words) if processes else runs.alone(*words)
        require(done.returncode == 0 and done.stdout == alone.stdout, done.stderr)
        require("blocks of the comparison of the scan are taken from" in done.stderr, done.stderr)
        found = files_of(out)
        for path, content in expected.items():
            require(path.name.startswith(".") or found[path] == content, path, "has other bytes after a resumption")
        require(not kept.exists(), "left over after the results are whole")


CASES = {"MonteCarlo": monte_carlo, "Maps": maps, "KilledAndResumed": killed_and_resumed, "TwoJobs": two_jobs,
         "ReadAgain": read_again, "ReadAgainAfterAKill": read_again_after_a_kill,
         "ReadAgainFaults": read_again_faults,
         "Deviations": deviations, "StreamedDeviations": streamed_deviations,
         "DeviationsAfterAKill": deviations_after_a_kill,
         "SameBytes": same_bytes, "WorkersOfOtherFiles": other_files, "LostProcess": lost_process,
         "OtherSubcommands": other_subcommands, "MissingProgram": missing_program}


def main(cases):
    parser = argparse.ArgumentParser()
    parser.add_argument("case", choices=cases)
    for name in ("--abbe", "--mpirun", "--examples", "--out"):
        parser.add_argument(name, required=True, type=pathlib.Path)
    arguments = parser.parse_args()
    shutil.rmtree(arguments.out, ignore_errors=True)
    arguments.out.mkdir(parents=True)
    cases[arguments.case](Runs(arguments))
    return 0


if __name__ == "__main__":
    sys.exit(main(CASES))
