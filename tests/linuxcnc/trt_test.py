#!/usr/bin/env python3
"""Pins of `abbe compensate kinematics --for linuxcnc` in LinuxCNC's own xyzac-trt-kins and xyzbc-trt-kins.

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

DISPLAY = "trt_drive.py"
LENGTH = 150.0  # mm, of the tool
GAUGE = (0.0, 0.0, 560.0)  # mm, the gauge point at zero
TABLE_POINT, CRADLE_POINT = (0.0, 0.0, 0.0), (0.03, 0.02, 50.0)  # mm
TABLE_SHIFT = {"X": 0.031, "Y": -0.024}  # mm
# Letter of the cradle, the direction of its axis, and its shift across it (mm).
CRADLES = (("A", "X", {"Y": 0.043, "Z": -0.037}), ("B", "Y", {"X": 0.043, "Z": -0.037}))


def machine_text(cradle):
    """Positive commands turn the table by the right-hand rule, as the modules of LinuxCNC 2.9 do: no primes."""
    return f"""name = "trunnion"
chain = "w C {cradle} Y' b X Z t"
[axis.C]
endless = true
[axis.{cradle}]
point_mm = {list(CRADLE_POINT)}
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
    """The point turned about the line through `centre` along X, Y or Z."""
    angle = math.radians(degrees)
    i, j = {"X": (1, 2), "Y": (2, 0), "Z": (0, 1)}[axis]
    result = list(point)
    u, v = point[i] - centre[i], point[j] - centre[j]
    result[i] = centre[i] + u * math.cos(angle) - v * math.sin(angle)
    result[j] = centre[j] + u * math.sin(angle) + v * math.cos(angle)
    return result


def shifted(point, shift):
    return [at + shift.get(letter, 0) for letter, at in zip("XYZ", point)]


def miss(place, joints, along, shift):
    """mm between the tool of the hidden machine and the point of the workpiece that the program names."""
    x, y, z, tilt, c = joints
    wanted = [gauge + at for gauge, at in zip(GAUGE, place[:3])]
    on_cradle = turned(wanted, shifted(TABLE_POINT, TABLE_SHIFT), "Z", c)
    on_bed = turned(on_cradle, shifted(CRADLE_POINT, shift), along, tilt)
    return math.dist(on_bed, (GAUGE[0] + x, GAUGE[1] + y, GAUGE[2] + z - LENGTH))


def pins_of(text):
    words = [line.split() for line in text.splitlines() if line.startswith("setp ")]
    return {name: float(value) for _, name, value in words}


def written_pins(abbe, folder, cradle, errors):
    (folder / "mill.machine.toml").write_text(machine_text(cradle))
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


def test(abbe, folder, cradle, along, shift):
    module, letters = f"xyz{cradle.lower()}c-trt-kins", f"XYZ{cradle}C"
    if not (module_run.MODULES / f"{module}.so").exists():
        module_run.skip(f"LinuxCNC has no {module}")
    hidden = {f"E{letter}0C": value for letter, value in TABLE_SHIFT.items()}
    hidden |= {f"E{letter}0{cradle}": value for letter, value in shift.items()}
    pins = {"nominal": written_pins(abbe, folder, cradle, {"EX0C": 0.0}),
            "written": written_pins(abbe, folder, cradle, hidden)}
    joints = [headless.Joint(letter, -99999, 99999) for letter in letters]
    (folder / "job.json").write_text(json.dumps({"length_mm": LENGTH, "letters": letters, "pins": pins}))
    module_run.copy_display_modules(folder)
    (folder / "places.txt").write_text("".join(" ".join(map(repr, place)) + "\n" for place in places()))
    lines = [f"net tool-offset motion.tooloffset.z => {module}.tool-offset"]
    headless.write_configuration(folder, module_run.HERE / DISPLAY,
                                 headless.ini_text(DISPLAY, module, joints, velocity=20000),
                                 headless.hal_text(len(joints), [["joint.0.motor-pos-cmd"]], lines),
                                 tool_table=f"T1 P1 Z{LENGTH} D6\n")
    module_run.run_to_its_end(folder, DISPLAY, 130)
    largest = {}
    for name in pins:
        reached = [[float(word) for word in line.split()] for line in (folder / f"{name}.txt").read_text().splitlines()]
        if len(reached) != len(places()):
            sys.exit(f"FAILED: {len(reached)} places")
        misses = [miss(place, at, along, shift) for place, at in zip(places(), reached)]
        largest[name] = max(misses)
        print(f"{module}, {name} pins: tool off by {1e3 * sum(misses) / len(misses):.4f} um in the mean, "
              f"{1e3 * max(misses):.5f} um at most")
    if not (largest["nominal"] > 0.05 and largest["written"] < 1e-7):
        sys.exit("FAILED: the written pins do not bring the tool there")


def main():
    abbe, place = sys.argv[1:3]
    try:
        headless.check_installed()
        with headless.only_one():
            for cradle in CRADLES:
                with headless.run_folder(place) as folder:
                    headless.check_that_it_runs(folder)
                    test(abbe, folder, *cradle)
    except headless.NotHere as why:
        module_run.skip(str(why))


main()
