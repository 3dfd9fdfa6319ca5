#!/usr/bin/env python3
"""A compensation that depends on a temperature in a real LinuxCNC: pins, a sensor that fails, states over a restart.

Usage: states_test.py CASE MODULE.so KEEP FOLDER. CASE is the program states_case, MODULE.so the module built under its
test name, KEEP linuxcnc/keep-states. Exit code 77: skipped, and said why.
"""
import math
import re
import shutil
import subprocess
import sys

import module_run
from module_run import headless

AXES = "XYZAC"
DISPLAY = "states_drive.py"
TIME_CONSTANT_S = 900
WARM = 28


def configure(folder, module, keep, first):
    joints = [headless.Joint(letter, -99999, 99999) if letter in "AC" else
              headless.Joint(letter, -600, 600, world=module_run.WORLD) for letter in AXES]
    motors = [f"joint.{j}.motor-pos-cmd" for j in range(len(AXES))]
    corrections = [f"{module}.correction-{letter.lower()}" for letter in AXES]
    states = [f"{module}.{name}" for name in ("state-ambient-used", "lag-column", "states-behind-um", "enabled")]
    lines = []
    if first:
        shutil.copy(keep, folder / "keep-states")
        lines = [f"loadusr -W {folder}/keep-states {folder}/mill.states --module {module} --every-s 0.5"]
    module_run.configure(folder, DISPLAY, f"{module} model={folder}/mill.abbec states={folder}/mill.states", joints,
                         {"module": module, "first": first}, [[*motors, *corrections, *states]], lines=lines)
    (folder / "driver.txt").unlink(missing_ok=True)


def lag_of_later_run(folder):
    seen = module_run.run_to_its_end(folder, DISPLAY, 60)
    found = re.search(r"lag (\S+) at (\S+)", seen)
    return float(found[1]), float(found[2]), (folder / "printed.txt").read_text(errors="replace")


def main():
    case, module_file, keep, place = sys.argv[1:5]
    with module_run.place_to_run(module_file, place) as (folder, module):
        subprocess.run([case, "prepare", folder], check=True)
        configure(folder, module, keep, first=True)
        print(module_run.run_to_its_end(folder, DISPLAY, 100))
        if subprocess.run([case, "judge", folder], check=False).returncode != 0:
            sys.exit(1)
        stored = (folder / "mill.states").read_text()
        then, channel, lag = (float(re.search(rf"^{word} (\S+)$", stored, re.MULTILINE)[1])
                              for word in ("time", "channel ambient", "lag column"))
        print(stored)
        if not (abs(channel - WARM) < 1e-9 and lag < WARM - 2):
            sys.exit("FAILED: the states that were stored are not those of the end")

        configure(folder, module, keep, first=False)
        taken_up, now, _ = lag_of_later_run(folder)
        expected = WARM + (lag - WARM) * math.exp(-(now - then) / TIME_CONSTANT_S)
        print(f"after {now - then:.1f} s: lag {taken_up:.6f}, by exact decay {expected:.6f}, in equilibrium {WARM}")
        if not abs(taken_up - expected) < 5e-3:
            sys.exit("FAILED: the lag is not that of exact decay")

        for said, text in (("of another compensation", re.sub("(?m)^compensation .*$", "compensation " + 16 * "0", stored)),
                           ("too old", re.sub("(?m)^time .*$", f"time {then - 25 * 3600}", stored)),
                           ("truncated", stored[:len(stored) // 2])):
            (folder / "mill.states").write_text(text)
            configure(folder, module, keep, first=False)
            fresh, _, printed = lag_of_later_run(folder)
            if said not in printed or abs(fresh - WARM) > 1e-9:
                sys.exit(f"FAILED: stored states are taken up, or not refused as {said}: lag {fresh}\n{printed}")
            print(f"stored states refused: {said}")


main()
