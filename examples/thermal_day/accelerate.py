#!/usr/bin/python3
"""The machine file for LinuxCNC's clock, on which the day is FACTOR times as short; prints the ranges of the states.

Usage: accelerate.py FOLDER. Writes accelerated.machine.toml beside day-mill.machine.toml: time constants divided by
FACTOR, nothing else. A range is that of the training days with a margin on both sides: what lies beyond is not used.
"""
import csv
import pathlib
import re
import sys

from in_linuxcnc import FACTOR

MARGIN_K = 4


def main():
    folder = pathlib.Path(sys.argv[1])
    text = (folder / "day-mill.machine.toml").read_text(encoding="utf-8")
    text, count = re.subn(r"(?m)^(time_constant_s = )(\S+)$", lambda m: f"{m[1]}{float(m[2]) / FACTOR!r}", text)
    if count == 0:
        sys.exit("accelerate: no time constants in day-mill.machine.toml")
    (folder / "accelerated.machine.toml").write_text(text, encoding="utf-8")
    with open(folder / "temperatures.csv", encoding="ascii") as file:
        names, *rows = list(csv.reader(file))
    for k, name in enumerate(names[1:], 1):
        values = [float(row[k]) for row in rows]
        print(f"{name}={min(values) - MARGIN_K:.2f}:{max(values) + MARGIN_K:.2f}")


main()
