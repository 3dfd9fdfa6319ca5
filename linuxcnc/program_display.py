#!/usr/bin/python3
"""Inside LinuxCNC, as its display: homes, runs the programs of job.json, records the motors in every servo cycle.

Writes program-N.txt (positions, one row per cycle), outcome.json, and where it is into progress.txt.
"""
import json

import gcode
import hal
import linuxcnc
from operating import Operation, Stopped

RESET = "G17 G21 G40 G49 G54 G64 G80 G90 G94 G97"


class Reader:
    """What gcode.parse() tells the moves of a program to: nothing is done with them."""
    parameter_file = "run.var"

    def __init__(self, axis_mask):
        self.axis_mask = axis_mask

    def __getattr__(self, name):
        return {"get_external_length_units": lambda: 1 / 25.4, "get_external_angular_units": lambda: 1.0,
                "get_axis_mask": lambda: self.axis_mask, "get_block_delete": lambda: False,
                "get_tool": lambda pocket: (-1,) + 12 * (0.0,) + (0,)}.get(name, lambda *values: None)


def first_refused(lines, axis_mask):
    """Number of the line that LinuxCNC's interpreter refuses, or None."""
    with open("part.ngc", "w", encoding="utf-8", errors="surrogateescape") as file:
        file.writelines(line + "\n" for line in lines)
    result, number = gcode.parse("part.ngc", Reader(axis_mask), "G21", "")
    return number if result > gcode.MIN_ERROR else None


def refused_line(lines, axis_mask):
    """"line N: its text: " of the line that LinuxCNC's interpreter refuses, or nothing if it refuses none."""
    number = first_refused(lines, axis_mask)
    if number is None:
        return ""
    # What cannot be read is counted one line late, what cannot be done is not.
    number = min(number, len(lines))
    while number > 1 and first_refused(lines[:number - 1] + ["M2"], axis_mask) is not None:
        number -= 1
    return f"line {number}: {lines[number - 1].strip()}: "


def trimmed(rows):
    """From the last standing cycle before the first motion to the first one after the last."""
    moving = [k for k in range(1, len(rows)) if rows[k] != rows[k - 1]]
    return rows[moving[0] - 1:moving[-1] + 1] if moving else rows[:1]


def run_program(operation, recorder, name, home, progress):
    """One program from the home position; positions relative to the axes' zero."""
    operation.mode(linuxcnc.MODE_MDI)
    operation.mdi(RESET)
    operation.mdi(f"G53 G0 {home}")
    with open(name, encoding="utf-8", errors="surrogateescape") as file:
        lines = file.read().splitlines()
    try:
        rows = operation.run(name, recorder, lambda line: progress(line, len(lines)))
    except Stopped as why:
        raise Stopped(refused_line(lines, operation.status.axis_mask) + str(why)) from why
    zero = [hal.get_value(f"joint.{j}.motor-offset") for j in range(operation.status.joints)]
    return [[value - at for value, at in zip(row, zero)] for row in trimmed(rows)]


def main():
    with open("job.json", encoding="utf-8") as file:
        job = json.load(file)
    operation = Operation(job["limit_s"])
    recorder = operation.recorder(0)
    outcome = {"done": 0}
    try:
        operation.switch_on()
        for number in range(job["programs"]):
            def progress(line, lines, number=number):
                with open("progress.txt", "w", encoding="ascii") as file:
                    file.write(f"{number} {line} {lines}\n")
            rows = run_program(operation, recorder, f"program-{number}.ngc", job["home"], progress)
            with open(f"program-{number}.txt", "w", encoding="ascii") as file:
                file.writelines(" ".join(f"{value:.17g}" for value in row) + "\n" for row in rows)
            outcome["done"] = number + 1
    except Stopped as why:
        outcome["stopped"] = str(why)
    with open("outcome.json", "w", encoding="utf-8") as file:
        json.dump(outcome, file)


main()
