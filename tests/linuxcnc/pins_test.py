#!/usr/bin/env python3
"""Pins of the kinematics module and its refusals in a real LinuxCNC. Exit code 77: skipped, and said why.

Usage: pins_test.py CASE MODULE.so FOLDER. CASE is the program pins_case, MODULE.so the module built under its test name.
"""
import subprocess
import sys

import module_run
from module_run import headless

AXES = "XYZAC"
DISPLAY = "pins_drive.py"
FARTHEST = 400  # mm, limit of linear joints: further than the travel, to see what lies beyond


def configure(folder, module, model):
    joints = [headless.Joint(letter, -99999, 99999) if letter in "AC" else
              headless.Joint(letter, -FARTHEST if letter != "Z" else -3000, FARTHEST, world=module_run.WORLD)
              for letter in AXES]
    motors = [f"joint.{j}.motor-pos-cmd" for j in range(len(AXES))]
    corrections = [f"{module}.correction-{letter.lower()}" for letter in AXES]
    module_run.configure(folder, DISPLAY, f"{module} model={folder / model}", joints, {"module": module},
                         [[*motors, f"{module}.enabled", *corrections], ["axis.x.pos-cmd", *corrections]])


def main():
    case, module_file, place = sys.argv[1:4]
    with module_run.place_to_run(module_file, place) as (folder, module):
        subprocess.run([case, "prepare", folder], check=True)
        for model, said in (("damaged.abbec", "its checksum is wrong"), ("missing.abbec", "cannot read")):
            configure(folder, module, model)
            output, code = headless.run(folder, DISPLAY, 40)
            if code == 0 or said not in output or (folder / "driver.txt").exists():
                print(output)
                sys.exit(f"FAILED: LinuxCNC starts with {model}, or does not say why it does not")
            print(f"{model}: LinuxCNC does not start and says why")
        configure(folder, module, "mill.abbec")
        seen = module_run.run_to_its_end(folder, DISPLAY, 100)
        if "would exceed joint 0's positive limit" not in seen:
            sys.exit("FAILED: a joint may leave its limits\n" + seen)
        if subprocess.run([case, "judge", folder], check=False).returncode != 0:
            sys.exit(1)


main()
