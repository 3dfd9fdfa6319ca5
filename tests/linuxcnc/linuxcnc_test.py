#!/usr/bin/env python3
"""The kinematics module in a real LinuxCNC without a screen. Usage: linuxcnc_test.py CASE MODULE.so FOLDER

CASE is the program linuxcnc_case, MODULE.so the module built under its test name. Everything is done in a new folder
below FOLDER (or the temporary one, where others may not look into FOLDER), because LinuxCNC refuses to run as root and
runs as `nobody`. Exit code 77: skipped, and said why.
"""
import os
import pathlib
import shutil
import subprocess
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "linuxcnc"))
import headless  # noqa: E402

SKIPPED = 77
MODULES = pathlib.Path("/usr/lib/linuxcnc/modules")
LONGEST_S = 100
AXES = "XYZAC"


def skip(why):
    print("skipped:", why)
    sys.exit(SKIPPED)


def configure(folder, module, model):
    joints = [headless.Joint(letter, *((-99999, 99999) if letter in "AC" else (-3000, 3000))) for letter in AXES]
    motors = [f"joint.{j}.motor-pos-cmd" for j in range(len(AXES))]
    world = [f"axis.{letter.lower()}.pos-cmd" for letter in AXES]
    lines = [f"setp {module}.ramp-seconds 0.4"]
    lines += [f"net tool-{axis} motion.tooloffset.{axis} => {module}.tooloffset-{axis}" for axis in "xyz"]
    headless.write_configuration(
        folder, HERE / "drive.py",
        headless.ini_text("drive.py", f"{module} model={folder / model}", joints, velocity=20000),
        headless.hal_text(len(AXES), [[*motors, f"{module}.enabled"], [*motors, *world]], lines),
        tool_table="T1 P1 Z50.0 D6 ;end mill\n")


def test(case, folder, module):
    headless.check_that_it_runs(folder)
    subprocess.run([case, "prepare", folder], check=True)
    (folder / "module.txt").write_text(module)

    configure(folder, module, "damaged.abbec")
    output, code = headless.run(folder, "drive.py", 40)
    if code == 0 or "its checksum is wrong" not in output or (folder / "driver.txt").exists():
        print(output)
        sys.exit("FAILED: LinuxCNC starts with a damaged file, or does not say why it does not")
    print("a damaged file: LinuxCNC does not start and says why")

    configure(folder, module, "mill.abbec")
    output, code = headless.run(folder, "drive.py", LONGEST_S)
    seen = (folder / "driver.txt").read_text() if (folder / "driver.txt").exists() else ""
    if "DONE" not in seen:
        print(output, seen, sep="\n")
        sys.exit(f"FAILED: LinuxCNC ended before its work was done (exit code {code})")
    if "outside map 1" not in seen or "inside map 1" not in seen:
        sys.exit("FAILED: the pin outside-map is wrong\n" + seen)
    judged = subprocess.run([case, "judge", folder], check=False)
    if judged.returncode != 0:
        print(seen)
        sys.exit(1)


def main():
    case, module_file, place = sys.argv[1:4]
    if not pathlib.Path(module_file).exists():
        skip("the module is not built: linuxcnc-uspace-dev is not installed")
    if os.geteuid() != 0:
        skip("only root may install a module for LinuxCNC and run it as another user")
    module = pathlib.Path(module_file).stem
    installed = MODULES / (module + ".so")
    started = time.monotonic()
    try:
        headless.check_installed()
        with headless.only_one(), headless.run_folder(place) as folder:
            try:
                shutil.copy(module_file, installed)
                os.chmod(installed, 0o644)
                test(case, folder, module)
            finally:
                installed.unlink(missing_ok=True)
    except headless.NotHere as why:
        skip(str(why))
    print(f"{time.monotonic() - started:.1f} s")


main()
