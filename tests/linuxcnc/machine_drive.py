#!/usr/bin/python3
"""Inside LinuxCNC, as its display: homes, enables the compensation, runs poses and a program, writes what it saw.

Everything is read from and written to the current folder; the last line written to driver.txt is DONE.
"""
from at_rest import Pins
from display_job import do_job, numbers, write
from operating import Stopped


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


do_job(drive, limit_s=120)
