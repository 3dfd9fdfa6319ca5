#!/usr/bin/env python3
"""Pins of `abbe compensate kinematics --for linuxcnc` in LinuxCNC's own xyzac-trt-kins.

Usage: trt_test.py ABBE FOLDER. Exit code 77: skipped, and said why.

The machine has hidden shifts of its rotary axes. LinuxCNC goes to poses with the pins of the nominal machine and with
those of Abbe. Where the tool then is against the workpiece is computed here from the joints, by rotations about the
displaced lines and nothing of the library.
"""
import json
import math
import pathlib
import random
import subprocess
import sys

import module_run
from module_run import headless

AXES = "XYZAC"
DISPLAY = "trt_drive.py"
MODULE = "xyzac-trt-kins"
LENGTH = 150.0  # mm, of the tool
GAUGE = (0.0, 0.0, 560.0)  # mm, the gauge point at zero
C_POINT, A_POINT = (0.0, 0.0, 0.0), (0.0, 0.02, 50.0)
SHIFTS = {"EX0C": 0.031, "EY0C": -0.024, "EY0A": 0.043, "EZ0A": -0.037}  # mm
# Positive commands turn the table by the right-hand rule, as the module of LinuxCNC 2.9 does: no primes.
MACHINE = f"""name = "trunnion"
chain = "w C A Y' b X Z t"
[axis.C]
endless = true
[axis.A]
point_mm = {list(A_POINT)}
travel_deg = [-110, 30]
[axis.Y]
travel_mm = [-300, 300]
[axis.X]
travel_mm = [-300, 300]
[axis.Z]
travel_mm = [-510, 0]
[tool]
reference_mm = {list(GAUGE)}
offset_mm = [0, 0, {-LENGTH}]
"""


def turned(point, centre, axis, degrees):
    """The point turned about the line through `centre` along X or Z."""
    angle = math.radians(degrees)
    i, j = {"X": (1, 2), "Z": (0, 1)}[axis]
    result = list(point)
    u, v = point[i] - centre[i], point[j] - centre[j]
    result[i] = centre[i] + u * math.cos(angle) - v * math.sin(angle)
    result[j] = centre[j] + u * math.sin(angle) + v * math.cos(angle)
    return result


def miss(place, joints):
    """mm between the tool of the hidden machine and the point of the workpiece that the program names."""
    x, y, z, a, c = joints
    point_c = [C_POINT[0] + SHIFTS["EX0C"], C_POINT[1] + SHIFTS["EY0C"], C_POINT[2]]
    point_a = [A_POINT[0], A_POINT[1] + SHIFTS["EY0A"], A_POINT[2] + SHIFTS["EZ0A"]]
    wanted = [gauge + at for gauge, at in zip(GAUGE, place[:3])]
    on_table = turned(turned(wanted, point_c, "Z", c), point_a, "X", a)
    tool = (GAUGE[0] + x, GAUGE[1] + y, GAUGE[2] + z - LENGTH)
    return math.dist(on_table, tool)


def pins_of(text):
    words = [line.split() for line in text.splitlines() if line.startswith("setp ")]
    return {name: float(value) for _, name, value in words}


def written_pins(abbe, folder, errors):
    (folder / "mill.machine.toml").write_text(MACHINE)
    (folder / "mill.errors.toml").write_text("".join(
        f'[[location]]\nname = "{name}"\nvalue_um = {1e3 * value}\n' for name, value in errors.items()))
    output = folder / "kinematics.hal"
    subprocess.run([abbe, "compensate", "kinematics", "--machine", folder / "mill.machine.toml", "--errors",
                    folder / "mill.errors.toml", "--for", "linuxcnc", "-o", output, "--force",
                    "--least-reduction-percent", "0"], check=True, stdout=subprocess.DEVNULL)
    return pins_of(output.read_text())


def places():
    generator = random.Random(5)
    return [(generator.uniform(-150, 150), generator.uniform(-150, 150), generator.uniform(-580, -420),
             generator.uniform(-100, 25), generator.uniform(-350, 350)) for _ in range(40)]


def test(abbe, folder):
    pins = {"nominal": written_pins(abbe, folder, {"EX0C": 0.0}), "written": written_pins(abbe, folder, SHIFTS)}
    joints = [headless.Joint(letter, -99999, 99999) for letter in AXES]
    job = {"length_mm": LENGTH, "pins": pins}
    (folder / "job.json").write_text(json.dumps(job))
    module_run.copy_display_modules(folder)
    (folder / "places.txt").write_text("".join(" ".join(map(repr, place)) + "\n" for place in places()))
    lines = [f"net tool-offset motion.tooloffset.z => {MODULE}.tool-offset"]
    headless.write_configuration(folder, module_run.HERE / DISPLAY,
                                 headless.ini_text(DISPLAY, MODULE, joints, velocity=20000),
                                 headless.hal_text(len(joints), [["joint.0.motor-pos-cmd"]], lines),
                                 tool_table=f"T1 P1 Z{LENGTH} D6\n")
    module_run.run_to_its_end(folder, DISPLAY, 150)
    largest = {}
    for name in pins:
        reached = [[float(word) for word in line.split()] for line in (folder / f"{name}.txt").read_text().splitlines()]
        if len(reached) != len(places()):
            sys.exit(f"FAILED: {len(reached)} places")
        misses = [miss(place, at) for place, at in zip(places(), reached)]
        largest[name] = max(misses)
        print(f"{name} pins: tool off by {1e3 * sum(misses) / len(misses):.4f} um in the mean, "
              f"{1e3 * max(misses):.4f} um at most")
    if not (largest["nominal"] > 0.05 and largest["written"] < 1e-5):
        sys.exit("FAILED: the written pins do not bring the tool there")


def main():
    abbe, place = sys.argv[1:3]
    try:
        headless.check_installed()
        with headless.only_one(), headless.run_folder(place) as folder:
            headless.check_that_it_runs(folder)
            if not (module_run.MODULES / f"{MODULE}.so").exists():
                module_run.skip(f"LinuxCNC has no {MODULE}")
            test(abbe, folder)
    except headless.NotHere as why:
        module_run.skip(str(why))


main()
