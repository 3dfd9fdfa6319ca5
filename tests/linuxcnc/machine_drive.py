#!/usr/bin/python3
"""Inside LinuxCNC, as its display: homes, enables the compensation, runs poses and a program, writes what it saw.

Everything is read from and written to the current folder; the last line written to driver.txt is DONE.
"""
import json
import sys

from at_rest import Pins, numbers, write
from operating import Operation, Stopped


def drive(operation, job, say):
    pins = Pins(operation, job["module"], job["words"], job["axes"])
    program = operation.recorder(0)
    operation.switch_on()
    operation.mdi("G21 G90 G49 G61")
    pins.enable(1)
    say("enabled")
    reached, tool = [], 0
    for judged, number, x, y, z, *world in numbers("poses.txt"):
        if number != tool:
            # At home, where no axis is turned, the joints need not move for it.
            tool, before = number, pins.joints_now()
            pins.tool(int(tool))
            pins.here()
            moved = max(abs(a - b) for a, b in zip(pins.joints_now(), before))
            if moved > 1:
                raise Stopped(f"joints move by {moved} mm or degrees when the tool is changed")
        row = pins.go(world, (x, y, z))
        if judged:
            reached.append(row)
    write("reached.txt", reached)
    say("poses reached")
    with open("start.ngc", encoding="ascii") as start:
        operation.mdi(start.read().strip())
    pins.here()
    write("program.txt", operation.run("program.ngc", program))
    say("DONE")


def main():
    with open("job.json", encoding="ascii") as file, open("driver.txt", "w", buffering=1, encoding="utf-8") as log:
        operation = Operation(limit_s=120)
        try:
            drive(operation, json.load(file), lambda text: log.write(text + "\n"))
        except Stopped as why:
            log.write(f"FAILED {why}\n")
            sys.exit(1)


main()
