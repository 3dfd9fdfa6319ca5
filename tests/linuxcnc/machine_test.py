#!/usr/bin/env python3
"""The kinematics module on one machine in a real LinuxCNC. Exit code 77: skipped, and said why.

Usage: machine_test.py CASE MODULE.so FOLDER MACHINE JOINTS WORDS SPACE POSES UNCERTAINTY COORDINATES

CASE is the program machine_case, MODULE.so the module built under its test name; COORDINATES says whether the module is
told the order of joints (given) or has its default; the others as for machine_case.
"""
import subprocess
import sys

import module_run
from module_run import headless

LONGEST_S = 150


def main():
    case, module_file, place, *words = sys.argv[1:]
    machine, axes, letters, space, poses, uncertainty, coordinates = words
    described = [machine, axes, letters, space, poses, uncertainty]
    with module_run.place_to_run(module_file, place) as (folder, module):
        subprocess.run([case, "prepare", folder, *described], check=True)
        joints = []
        for line in (folder / "joints.txt").read_text().splitlines():
            letter, *limits = line.split()
            low, high, home = map(float, limits)
            of_point = space == "tool" and letter in "XYZ"
            joints.append(headless.Joint(letter, low, high, home, world=module_run.WORLD if of_point else None))
        kinematics = f"{module} model={folder}/machine.abbec"
        kinematics += " space=axes" if space == "axes" else ""
        kinematics += f" coordinates={axes}" if coordinates == "given" else ""
        motors = [f"joint.{j}.motor-pos-cmd" for j in range(len(joints))]
        world = [f"axis.{letter.lower()}.pos-cmd" for letter in letters]
        module_run.configure(folder, "machine_drive.py", kinematics, joints,
                             {"module": module, "words": letters, "axes": axes.split(",")}, [[*motors, *world]],
                             ["ramp-seconds 0.1"])
        module_run.run_to_its_end(folder, "machine_drive.py", LONGEST_S)
        if subprocess.run([case, "judge", folder, *described], check=False).returncode != 0:
            sys.exit(1)


main()
