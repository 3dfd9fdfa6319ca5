#!/usr/bin/env python3
"""How long the build and the tests take from a fresh clone with empty caches.

    benchmarks/build_times.py demo           make demo, and make demo again
    benchmarks/build_times.py release        the release build alone
    benchmarks/build_times.py test           make test
    benchmarks/build_times.py touch          what is built again in the release and the development build after one
                                                   source file, or one header that nearly all include, has changed

Several may be named; each is measured in a clone of its own of the last commit, with an empty ccache and an empty npm cache.
Packages are not removed: install them first (.ci/set-up test), so that their time is not counted. Seconds of the clock
depend on what else the machine does; seconds of the processor, of all programs together, hardly do. The longest steps come
from ninja's log. --keep FOLDER measures in FOLDER and leaves it there.
"""
import argparse
import os
import resource
import subprocess
import sys
import tempfile
import time

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
LONGEST = 12
# A source file of usual length in the middle of the library, and the header of rigid transforms.
TOUCHED = ["src/abbe/identify/gauge.cpp", "src/abbe/formats/study/study_level.cpp", "apps/run.cpp",
           "include/abbe/geometry/rigid_transform.h"]


class Measurement:
    def __init__(self, folder):
        self.clone = os.path.join(folder, "clone")
        subprocess.run(["git", "clone", "--quiet", ROOT, self.clone], check=True)
        self.environment = dict(os.environ, CCACHE_DIR=os.path.join(folder, "ccache"),
                                npm_config_cache=os.path.join(folder, "npm"))

    def time(self, title, command):
        """Runs the command in the clone and prints what it took; ends the program if the command fails."""
        print(f"{title}: {' '.join(command)}", flush=True)
        before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
        log = os.path.join(os.path.dirname(self.clone), "log")
        with open(log, "a", encoding="utf-8") as out:
            result = subprocess.run(command, cwd=self.clone, env=self.environment, stdin=subprocess.DEVNULL, stdout=out,
                                    stderr=subprocess.STDOUT)
        wall = time.monotonic() - start
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        processor = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        print(f"  {wall:8.1f} s   {processor:8.1f} s of the processor", flush=True)
        if result.returncode != 0:
            with open(log, encoding="utf-8", errors="replace") as text:
                sys.stderr.writelines(text.readlines()[-40:])
            sys.exit(f"exit code {result.returncode}")

    def longest(self, preset):
        """The longest steps of a build, s of the clock."""
        steps = {}
        with open(os.path.join(self.clone, "build", preset, ".ninja_log"), encoding="utf-8") as log:
            for line in log:
                if line.startswith("#"):
                    continue
                start, end, _, output, _ = line.rstrip("\n").split("\t")
                steps[output] = (int(end) - int(start)) / 1000
        print(f"  {len(steps)} steps; the longest:")
        for output, seconds in sorted(steps.items(), key=lambda step: -step[1])[:LONGEST]:
            print(f"  {seconds:8.1f} s   {output}")


def touch(measurement, preset):
    measurement.time(f"{preset} build", [".ci/build", preset])
    measurement.time(f"{preset} build, nothing changed", [".ci/build", preset])
    for path in TOUCHED:
        with open(os.path.join(measurement.clone, path), "a", encoding="utf-8") as source:
            source.write("// changed\n")
        measurement.time(f"{preset} build after {path} has changed", [".ci/build", preset])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", nargs="+", choices=["demo", "release", "test", "touch"])
    parser.add_argument("--keep", metavar="FOLDER", help="where to measure; it is left there")
    arguments = parser.parse_args()
    print(f"{os.cpu_count()} processors, load {os.getloadavg()[0]:.1f}")
    for what in arguments.what:
        with tempfile.TemporaryDirectory() as folder:
            if arguments.keep:
                folder = os.path.join(os.path.abspath(arguments.keep), what)
                os.makedirs(folder)
            measurement = Measurement(folder)
            if what == "demo":
                measurement.time("first", ["make", "demo"])
                measurement.longest("release")
                measurement.time("second", ["make", "demo"])
            elif what == "release":
                measurement.time("release build", [".ci/build", "release"])
                measurement.longest("release")
            elif what == "test":
                measurement.time("all tests", ["make", "test"])
                for preset in ("dev", "asan"):
                    print(preset)
                    measurement.longest(preset)
            else:
                touch(measurement, "release")
                touch(measurement, "dev")


if __name__ == "__main__":
    main()
