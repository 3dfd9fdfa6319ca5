"""Measures what several processes of mpirun gain for each kind of shared work, and fits the model of docs/scale.md.

    several_processes.py --abbe PROGRAM --mpirun PROGRAM --examples FOLDER [--rounds N] [--only KIND ...]

One and two processes, each bound to a core, on which it runs one thread, run in turn, for a small and a large amount of
work. Each figure is the best of its rounds, because other work on the machine only adds to it. Two kinds of time are
measured: that on the clock, and the mean processor time of the processes: as long as they do not wait for each other,
that is the time on the clock of a machine with nothing else to do. The model is, for n items in p processes,

    time = a + b n / p + c n (p - 1) / p

a: start, input and all that every process does by itself; b: computation of an item; c: what the first process spends
on an item that another one has computed. a and b come from one process, c from two. Items are samples, poses or points;
of a plan they are the readings to be chosen, with which the time grows faster than in proportion, so that its a, b and
c hold between both sizes only. Of a plan of many they are candidates.
"""

import argparse
import array
import os
import pathlib
import random
import re
import subprocess
import sys
import tempfile
import time

import streamed_readings

ENVIRONMENT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMPI_MCA_btl": "self,vader",
               "OMPI_MCA_rmaps_base_oversubscribe": "1", "OMPI_MCA_hwloc_base_binding_policy": "core"}

#: Runs the command and appends its processor time to a file. A computation that says no (1) is one like others.
TIMED = """import os, resource, subprocess, sys
code = subprocess.call(sys.argv[2:])
used = resource.getrusage(resource.RUSAGE_CHILDREN)
with open(sys.argv[1], "a") as file:
    file.write(f"{used.ru_utime + used.ru_stime}\\n")
sys.exit(0 if code == 1 else code)
"""


class Runs:
    def __init__(self, arguments, folder):
        self.arguments, self.folder = arguments, folder
        self.timed, self.times = folder / "timed.py", folder / "times"
        self.timed.write_text(TIMED)

    def measure(self, processes, words):
        """Seconds on the clock, and of the processor: the mean of the processes."""
        self.times.unlink(missing_ok=True)
        begin = time.perf_counter()
        done = subprocess.run([self.arguments.mpirun, "-n", str(processes), sys.executable, self.timed, self.times,
                               self.arguments.abbe, *map(str, words)], capture_output=True, text=True,
                              env={**os.environ, **ENVIRONMENT})
        clock = time.perf_counter() - begin
        if done.returncode != 0:
            sys.exit(done.stderr)
        return clock, sum(map(float, self.times.read_text().split())) / processes

    def measure_apart(self, words):
        """The same of two processes that share nothing, each on a core of its own: what the machine itself loses."""
        self.times.unlink(missing_ok=True)
        begin = time.perf_counter()
        jobs = []
        for core in sorted(os.sched_getaffinity(0))[:2]:
            own = [f"{word}-{core}" if word == self.folder / "results" else str(word) for word in words]
            jobs.append(subprocess.Popen([sys.executable, self.timed, self.times, self.arguments.abbe, *own],
                                         stdout=subprocess.DEVNULL, preexec_fn=lambda: os.sched_setaffinity(0, {core})))
        if any([job.wait() for job in jobs]):
            sys.exit("a process by itself has failed")
        return time.perf_counter() - begin, sum(map(float, self.times.read_text().split())) / 2


def monte_carlo(runs, items):
    text = (runs.arguments.examples / "three_axis/interferometer.study.toml").read_text()
    text = text.replace('"../machines/', f'"{runs.arguments.examples.resolve()}/machines/', 1)
    text = text.replace("[identify]\n", f"[identify]\nmonte_carlo = {items}\n", 1)
    text = text.replace("\nseed = 9\n", "\nseed = 9\nthreads = 1\n", 1)
    study = runs.folder / f"{items}.study.toml"
    study.write_text(text)
    return ("run", study, "-o", runs.folder / "results")


def poses(runs, items):
    side = round((items / 125) ** 0.5)  # the other axes: five positions each
    machine = runs.arguments.examples / "machines/trunnion-mill.machine.toml"
    errors = runs.arguments.errors or runs.arguments.examples / "compensate/trunnion.errors.toml"
    return ("map", "--machine", machine, "--errors", errors, "--grid", f"X_mm=-100:100:{side}",
            "--grid", f"Y_mm=-100:100:{side}")


def scan_of_part(runs, items):
    """The scan of the bracket in the examples many times over, each time displaced a little, as binary PLY."""
    path = runs.folder / f"{items}.ply"
    if path.exists():
        return path
    lines = (runs.arguments.examples / "scan/bracket-scan.csv").read_text().splitlines()
    points = [tuple(map(float, line.split(","))) for line in lines if line[0] not in "#x"]
    draw, numbers = random.Random(3), array.array("f")
    for _ in range(items // len(points)):
        shift = [draw.gauss(0, 0.02) for _ in range(3)]
        for point in points:
            numbers.extend(value + move for value, move in zip(point, shift))
    properties = "".join(f"property float {axis}\n" for axis in "xyz")
    header = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(numbers) // 3}\n{properties}end_header\n"
    path.write_bytes(header.encode() + numbers.tobytes())
    return path


def deviations(runs, items, *more):
    scans = runs.arguments.examples / "scan"
    return ("deviate", scan_of_part(runs, items), scans / "bracket.stl", "--transform", scans / "bracket-transform.csv",
            "--largest-mm", 0.3, "--threads", 1, *more)


def deviation_files(runs, items):
    return deviations(runs, items, "-o", runs.folder / "results")


def streamed_deviations(runs, items):
    return deviations(runs, items, "--stream-above", 1000)


def registration(runs, items):
    return ("register", scan_of_part(runs, items), runs.arguments.examples / "scan/bracket.stl", "--threads", 1)


def plan(runs, items):
    text = (runs.arguments.examples / "trunnion/trunnion.study.toml").read_text()
    text = text.replace('"../machines/', f'"{runs.arguments.examples.resolve()}/machines/', 1)
    text = text.replace("\nreadings = 240\n", f"\nreadings = {items}\n", 1)
    text = re.sub(r"\nseed = (\d+)\n", r"\nseed = \1\nthreads = 1\n", text, count=1)
    if "\nthreads = 1\n" not in text or f"\nreadings = {items}\n" not in text:
        sys.exit("the study of the trunnion has changed")
    study = runs.folder / f"plan-{items}.study.toml"
    study.write_text(text)
    return ("plan", study)


def plan_of_many(runs, items):
    """Lengths from four stations to three reflectors: twelve candidates at every pose."""
    text = (runs.arguments.examples / "three_axis/tracking-interferometer.study.toml").read_text()
    text = text.replace('"../machines/', f'"{runs.arguments.examples.resolve()}/machines/', 1)
    text = text.replace("\nseed = 5\n", "\nseed = 5\nthreads = 1\n", 1)
    text = re.sub(r"(?m)^\[\[setup\.plan\]\]\n(?:[^\[\n].*\n)+", "", text)  # or else its grid is what there is
    text += f"\n[plan]\nreadings = 65\nposes = {items // 12}\n"
    if "\nthreads = 1\n" not in text or "setup.plan" in text:
        sys.exit("the study of the tracking interferometer has changed")
    study = runs.folder / f"plan-of-{items}.study.toml"
    study.write_text(text)
    return ("plan", study)


def ball_bar_study(runs, items, in_memory):
    """Readings of the ball bar of the trunnion in four files (streamed_readings.py)."""
    folder = runs.folder / f"ball-bar-{items}-{in_memory}"
    if not folder.exists():
        folder.mkdir()
        examples = runs.arguments.examples.resolve()
        example, machine = streamed_readings.inputs_of(examples.parent)
        rows = streamed_readings.simulated_rows(runs.arguments.abbe, example, machine, folder)
        shards = streamed_readings.write_shards(folder, *rows, items)
        streamed_readings.measured_study(example, machine, shards, in_memory, folder)
    return ("run", folder / "bar.study.toml", "-o", runs.folder / "results")


def identification(runs, items):
    return ball_bar_study(runs, items, 0)


def streamed_identification(runs, items):
    return ball_bar_study(runs, items, 50000)


APART = "apart"


def report(name, runs, words, sizes):
    best = {}
    for _ in range(runs.arguments.rounds):
        for items in sizes:
            for processes in (1, 2, APART):
                if processes == APART and (items != sizes[-1] or not runs.arguments.apart):
                    continue
                given = words(runs, items)
                found = runs.measure_apart(given) if processes == APART else runs.measure(processes, given)
                before = best.get((items, processes), found)
                best[items, processes] = tuple(map(min, before, found))
    small, large = sizes
    for kind, k in (("clock", 0), ("processor", 1)):
        one, two = best[large, 1][k], best[large, 2][k]
        slope_one = (one - best[small, 1][k]) / (large - small)
        slope_two = (two - best[small, 2][k]) / (large - small)
        a, b = one - slope_one * large, slope_one
        c = 2 * slope_two - slope_one
        print(f"{name}, {kind}: {large} items in {one:.2f} s with 1, {two:.2f} s with 2 processes: "
              f"efficiency {one / two / 2:.3f}; of an item alone {slope_one / slope_two / 2:.3f}; "
              f"a = {a:.2f} s, b = {1e6 * b:.2f} us, c = {1e6 * c:.2f} us")
        if (large, APART) in best:
            apart = best[large, APART][k]
            print(f"{name}, {kind}: two that share nothing take {apart:.2f} s each; "
                  f"efficiency against these {apart / two / 2:.3f}")


def main():
    parser = argparse.ArgumentParser()
    for name in ("--abbe", "--mpirun", "--examples"):
        parser.add_argument(name, required=True, type=pathlib.Path)
    parser.add_argument("--errors", type=pathlib.Path, help="errors of the trunnion mill with covariance")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--samples", type=int, default=400000)
    parser.add_argument("--poses", type=int, default=400000)
    parser.add_argument("--points", type=int, default=16000000, help="of a scan, at least 8000")
    parser.add_argument("--readings", type=int, default=480, help="of a plan, at least 400")
    parser.add_argument("--measured", type=int, default=1000000, help="readings of an identification")
    parser.add_argument("--apart", action="store_true", help="also run two processes that share nothing")
    parser.add_argument("--candidates", type=int, default=1000000, help="of a plan of many, at least 1000")
    parser.add_argument("--only", nargs="+", metavar="KIND", help="identify, identify-in-pieces, monte-carlo, map, "
                        "deviate, deviate-files, deviate-in-blocks, register, plan, plan-of-many; default: all")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        runs = Runs(arguments, pathlib.Path(folder))
        kinds = {"identify": (identification, arguments.measured),
                 "identify-in-pieces": (streamed_identification, arguments.measured),
                 "monte-carlo": (monte_carlo, arguments.samples), "map": (poses, arguments.poses),
                 "deviate": (deviations, arguments.points), "deviate-files": (deviation_files, arguments.points),
                 "deviate-in-blocks": (streamed_deviations, arguments.points),
                 "register": (registration, arguments.points), "plan": (plan, arguments.readings),
                 "plan-of-many": (plan_of_many, arguments.candidates)}
        for name in arguments.only or kinds:
            if name not in kinds:
                sys.exit(f"{name}: unknown; expected {', '.join(kinds)}")
            words, items = kinds[name]
            # Few readings do not determine what is planned for.
            report(name, runs, words, (items // 2 if name == "plan" else items // 4, items))


if __name__ == "__main__":
    main()
