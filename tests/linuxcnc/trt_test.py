#!/usr/bin/env python3
"""Pins of `abbe compensate kinematics --for linuxcnc` in LinuxCNC's own kinematics modules.

Usage: trt_test.py ABBE FOLDER. Exit code 77: skipped, and said why.

The machine has hidden shifts of its rotary axes. LinuxCNC goes to poses with the pins of the nominal machine and with
those of Abbe. Where the tool then is against the workpiece is computed here from the joints, by rotations about the
displaced lines and nothing of the library.
"""
import dataclasses
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


@dataclasses.dataclass
class Turn:
    """A rotary axis: the line about which it turns, and the sense (1: by the right-hand rule about +X, +Y, +Z)."""
    name: str
    point: tuple[float, float, float]  # mm
    along: str  # "X", "Y" or "Z"
    sense: int
    hidden: dict[str, float]  # mm, by letter: the shift of the line

    def displaced(self, point, degrees):
        return turned(point, [at + self.hidden.get(letter, 0) for letter, at in zip("XYZ", self.point)], self.along,
                      self.sense * degrees)


@dataclasses.dataclass
class Case:
    """A machine that a module of LinuxCNC moves."""
    module: str
    chain: str
    table: list[Turn]  # from the workpiece to the bed
    head: list[Turn]  # from the tool to the bed
    joints: str  # letters, in the order of the joints
    angles: dict[str, tuple[float, float]]  # degrees, of the places to go to
    lines: list[str]  # of the HAL file
    switched: bool = False  # the module turns the axes only where motion.switchkins-type is 1


def trunnion(cradle, along, point, hidden):
    """By the right-hand rule, as the modules of LinuxCNC 2.9 turn the table: no primes."""
    module = f"xyz{cradle.lower()}c-trt-kins"
    return Case(module, f"w C {cradle} Y' b X Z t",
                [Turn("C", (0, 0, 0), "Z", 1, {"X": 0.031, "Y": -0.024}), Turn(cradle, point, along, 1, hidden)], [],
                f"XYZ{cradle}C", {cradle: (-100, 25), "C": (-350, 350)},
                [f"net tool-offset motion.tooloffset.z => {module}.tool-offset"])


CASES = [
    trunnion("A", "X", (0.03, 0.02, 50.0), {"Y": 0.043, "Z": -0.037}),
    trunnion("B", "Y", (0.03, 0.02, 50.0), {"X": 0.043, "Z": -0.037}),
    Case("xyzab_tdr_kins", "w A' B' Y' b X Z t",
         [Turn("A", (3, 20, 70), "X", -1, {"Y": 0.031, "Z": -0.024}),
          Turn("B", (-12, 5, 40), "Y", -1, {"X": 0.043, "Z": -0.037})], [],
         "XYZAB", {"A": (-170, 170), "B": (-90, 90)},
         ["net tool-offset motion.tooloffset.z => xyzab_tdr_kins.tool-offset-z"], switched=True),
    Case("5axiskins", "w Y' b X Z C B t", [],
         [Turn("B", (0, 0, 810), "Y", -1, {"Z": 0.043}), Turn("C", (0, 0, 0), "Z", 1, {})],
         "XYZBCW", {"B": (-100, 100), "C": (-350, 350)},
         ["loadrt sum2 names=spindle-pivot", "addf spindle-pivot servo-thread",
          "net tool-offset motion.tooloffset.z => spindle-pivot.in1",
          "net pivot-length spindle-pivot.out => 5axiskins.pivot-length"]),
]


def machine_text(case):
    text = f"""name = "mill"
chain = "{case.chain}"
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
    for turn in case.table + case.head:
        text += f"[axis.{turn.name}]\npoint_mm = {list(turn.point)}\ntravel_deg = [-360, 360]\n"
        if turn in case.head and turn.sense < 0:
            text += f"direction = {[-float(letter == turn.along) for letter in 'XYZ']}\n"
    return text


def turned(point, centre, axis, degrees):
    """The point turned about the line through `centre` along X, Y or Z."""
    angle = math.radians(degrees)
    i, j = {"X": (1, 2), "Y": (2, 0), "Z": (0, 1)}[axis]
    result = list(point)
    u, v = point[i] - centre[i], point[j] - centre[j]
    result[i] = centre[i] + u * math.cos(angle) - v * math.sin(angle)
    result[j] = centre[j] + u * math.sin(angle) + v * math.cos(angle)
    return result


def miss(case, place, joints):
    """mm between the tool of the hidden machine and the point of the workpiece that the program names."""
    angle = dict(zip(case.joints[3:], place[3:]))
    point = [gauge + at for gauge, at in zip(GAUGE, place[:3])]
    for turn in case.table:
        point = turn.displaced(point, angle[turn.name])
    tip = [GAUGE[0], GAUGE[1], GAUGE[2] - LENGTH]
    for turn in case.head:
        tip = turn.displaced(tip, angle[turn.name])
    return math.dist(point, [at + joint for at, joint in zip(tip, joints[:3])])


def pins_of(text):
    words = [line.split() for line in text.splitlines() if line.startswith("setp ")]
    return {name: float(value) for _, name, value in words}


def written_pins(abbe, folder, case, errors):
    (folder / "mill.machine.toml").write_text(machine_text(case))
    (folder / "mill.errors.toml").write_text("".join(
        f'[[location]]\nname = "{name}"\nvalue_um = {1e3 * value}\n' for name, value in errors.items()))
    output = folder / "kinematics.hal"
    subprocess.run([abbe, "compensate", "kinematics", "--machine", folder / "mill.machine.toml", "--errors",
                    folder / "mill.errors.toml", "--for", "linuxcnc", "-o", output, "--force",
                    "--least-reduction-percent", "0"], check=True, stdout=subprocess.DEVNULL)
    return pins_of(output.read_text())


def places(case):
    generator = random.Random(5)
    return [(generator.uniform(-150, 150), generator.uniform(-150, 150), generator.uniform(-580, -420),
             *(generator.uniform(*limits) for limits in case.angles.values())) for _ in range(40)]


def test(abbe, folder, case):
    if not (module_run.MODULES / f"{case.module}.so").exists():
        module_run.skip(f"LinuxCNC has no {case.module}")
    hidden = {f"E{letter}0{turn.name}": value for turn in case.table + case.head
              for letter, value in turn.hidden.items()}
    pins = {"nominal": written_pins(abbe, folder, case, {name: 0.0 for name in hidden}),
            "written": written_pins(abbe, folder, case, hidden)}
    joints = [headless.Joint(letter, -99999, 99999) for letter in case.joints]
    letters = case.joints[:3] + "".join(case.angles)
    (folder / "job.json").write_text(json.dumps({"length_mm": LENGTH, "letters": letters, "pins": pins,
                                                 "switched": case.switched}))
    module_run.copy_display_modules(folder)
    (folder / "places.txt").write_text("".join(" ".join(map(repr, place)) + "\n" for place in places(case)))
    headless.write_configuration(folder, module_run.HERE / DISPLAY,
                                 headless.ini_text(DISPLAY, case.module, joints, velocity=20000),
                                 headless.hal_text(len(joints), [["joint.0.motor-pos-cmd"]], case.lines),
                                 tool_table=f"T1 P1 Z{LENGTH} D6\n")
    module_run.run_to_its_end(folder, DISPLAY, 130)
    largest = {}
    for name in pins:
        reached = [[float(word) for word in line.split()] for line in (folder / f"{name}.txt").read_text().splitlines()]
        if len(reached) != len(places(case)):
            sys.exit(f"FAILED: {len(reached)} places")
        misses = [miss(case, place, at) for place, at in zip(places(case), reached)]
        largest[name] = max(misses)
        print(f"{case.module}, {name} pins: tool off by {1e3 * sum(misses) / len(misses):.4f} um in the mean, "
              f"{1e3 * max(misses):.5f} um at most")
    if not (largest["nominal"] > 0.05 and largest["written"] < 1e-7):
        sys.exit("FAILED: the written pins do not bring the tool there")


def main():
    abbe, place = sys.argv[1:3]
    try:
        headless.check_installed()
        with headless.only_one():
            for case in CASES:
                with headless.run_folder(place) as folder:
                    headless.check_that_it_runs(folder)
                    test(abbe, folder, case)
    except headless.NotHere as why:
        module_run.skip(str(why))


main()
