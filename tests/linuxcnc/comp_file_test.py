#!/usr/bin/env python3
"""Tables of `abbe compensate table --for linuxcnc` in a real LinuxCNC. Usage: comp_file_test.py CASE RUN_PROGRAM ABBE
MACHINE FOLDER

CASE is the program comp_file_case. Exit code 77: skipped, and said why.
"""
import pathlib
import subprocess
import sys
import tempfile

SKIPPED = 77
AXES = "XYZAC"


def run(*words):
    ran = subprocess.run([str(word) for word in words], check=False, text=True, stdout=subprocess.PIPE,
                         stderr=subprocess.STDOUT, timeout=200)
    if ran.returncode == SKIPPED:
        print("skipped:", ran.stdout)
        sys.exit(SKIPPED)
    if ran.returncode != 0:
        sys.exit(f"FAILED: exit code {ran.returncode} of {' '.join(str(word) for word in words)}\n{ran.stdout}")
    return ran.stdout


def test(case, run_program, abbe, machine, folder):
    run(case, "prepare", folder)
    for kind in (1, 0):
        tables = folder / f"type-{kind}"
        run(abbe, "compensate", "table", "--machine", machine, "--errors", folder / "identified.errors.toml", "--for",
            "linuxcnc", "--type", kind,
            "--interpolation-um", 0.2, "--interpolation-urad", 0.2, "-o", tables)
        words = [word for axis in AXES for word in ("--comp", f"{axis}={tables / (axis + '.comp')}")]
        traces = [folder / f"{name}-{kind}.csv" for name in ("poses", "circle")]
        run(run_program, folder / "poses.ngc", "-o", traces[0], folder / "circle.ngc", "-o", traces[1], "--abbe", abbe,
            "--machine", machine, "--comp-type", kind, *words)
        print(f"COMP_FILE_TYPE {kind}\n" + run(case, "judge", *traces), end="")


def main():
    *programs, place = sys.argv[1:6]
    with tempfile.TemporaryDirectory(prefix="comp-file-", dir=place) as folder:
        test(*programs, pathlib.Path(folder))


main()
