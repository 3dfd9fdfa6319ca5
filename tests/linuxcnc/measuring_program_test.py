#!/usr/bin/env python3
"""A measuring program of `abbe program` in a real LinuxCNC: it stands at every reading, and for as long as it should.

Usage: measuring_program_test.py RUN_PROGRAM ABBE SOURCE FOLDER. Exit code 77: skipped, and said why.
"""
import csv
import pathlib
import subprocess
import sys
import tempfile

SKIPPED = 77
AXES = ["C_deg", "A_deg", "Y_mm", "X_mm", "Z_mm"]
DWELL, PULSE = 0.15, 0.1  # s
PERIOD = 0.001  # s


def check(holds, what):
    if not holds:
        sys.exit("FAILED: " + what)


def rows_of(file):
    with open(file, encoding="utf-8") as lines:
        return [[float(row[axis]) for axis in AXES] for row in csv.DictReader(line for line in lines if line[0] != "#")]


def stands(trace):
    """Poses at which the axes stand, and how long, s; those before the first move and after the last one are not."""
    found, begin = [], 0
    for number in range(1, len(trace)):
        if trace[number] != trace[number - 1]:
            if number - begin > 20:
                found.append((trace[begin], (number - begin) * PERIOD))
            begin = number
    return found


def main():
    run_program, abbe, source, place = sys.argv[1:5]
    machine = f"{source}/examples/machines/trunnion-mill.machine.toml"
    poses = f"{source}/examples/measuring_program/poses.csv"
    with tempfile.TemporaryDirectory(prefix="measuring-", dir=place) as name:
        folder = pathlib.Path(name)
        subprocess.run([abbe, "program", poses, "--machine", machine, "--dialect", "linuxcnc", "-o", folder / "m.ngc",
                        "--trigger", "output", "--trigger-number", "0", "--dwell-s", str(DWELL), "--pulse-s", str(PULSE),
                        "--stop-at", "none", "--obstacle-box-mm", "table=-60,-60,0,60,60,80", "--tool-radius-mm", "5",
                        "--tool-length-mm", "150", "--clearance-mm", "200", "-q"], check=True)
        ran = subprocess.run([run_program, "--abbe", abbe, "--machine", machine, folder / "m.ngc", "-o",
                              folder / "trace.csv"], check=False, text=True, stdout=subprocess.PIPE,
                             stderr=subprocess.STDOUT, timeout=200)
        if ran.returncode == SKIPPED:
            print("skipped:", ran.stdout)
            sys.exit(SKIPPED)
        check(ran.returncode == 0, ran.stdout)
        trace = rows_of(folder / "trace.csv")
    wanted = rows_of(poses)
    places = [(pose, sum(other == pose for other in wanted)) for number, pose in enumerate(wanted)
              if number == 0 or pose != wanted[number - 1]]
    found = stands(trace)
    # The trace ends with the last motion.
    check(len(found) == len(places) - 1, f"it stands at {len(found)} places, not at {len(places) - 1}")
    for (pose, seconds), (where, readings) in zip(found, places):
        off = max(abs(a - b) for a, b in zip(pose, where))
        check(off < 1e-6, f"it stands {off} mm or degrees from {where}")
        check(seconds >= readings * (DWELL + PULSE), f"it stands {seconds} s at {where}, for {readings} readings")
    off = max(abs(a - b) for a, b in zip(trace[-1], places[-1][0]))
    check(off < 1e-6, f"it ends {off} mm or degrees from {places[-1][0]}")
    print(f"{len(places)} places, {len(trace)} cycles")


main()
