#!/usr/bin/python3
"""Inside LinuxCNC, as its display: homes, runs poses, enables the compensation, runs a program, writes what it saw.

Everything is read from and written to the current folder; the last line written to driver.txt is DONE.
"""
import os
import sys
import time

import hal
import linuxcnc
from operating import Operation, Stopped

with open("module.txt", encoding="ascii") as name:
    MODULE = name.read()
started = time.monotonic()
log = open("driver.txt", "w", buffering=1)
operation = Operation(limit_s=80)
ramp, program = operation.recorder(0), operation.recorder(1)
mdi, until, cycles = operation.mdi, operation.until, operation.cycles


def say(text):
    log.write(f"{time.monotonic() - started:.2f} {text}\n")


def write(name, rows):
    with open(name, "w") as out:
        out.writelines(" ".join(f"{value:.17g}" for value in row) + "\n" for row in rows)


def standing(place=None):
    """World position, tool length and joints, once the world is at `place` and the joints have followed."""
    world = [f"axis.{a}.pos-cmd" for a in "xyzac"]
    joints = [f"joint.{j}.motor-pos-cmd" for j in range(5)]
    if place:
        until(lambda: max(abs(hal.get_value(n) - p) for n, p in zip(world, place)) < 1e-6, f"world at {place}")
    before = None
    while True:
        cycles(12)
        now = [hal.get_value(name) for name in world + ["motion.tooloffset.z"] + joints]
        # Rounding may change from one cycle to the next.
        if before and max(abs(a - b) for a, b in zip(now, before)) < 1e-11:
            return now
        before = now


def drive():
    operation.switch_on()
    say("homed")
    mdi("G21 G90 G49 G61")

    # Enabling at a standing pose: recorded in every servo cycle.
    mdi("G0 X100 Y-80 Z-200 A-30 C60")
    standing([100, -80, -200, -30, 60])
    ramp.start()
    cycles(30)
    hal.set_p(MODULE + ".enable", "1")
    until(lambda: hal.get_value(MODULE + ".enabled") == 1, "the ramp")
    cycles(30)
    write("ramp.txt", ramp.stop())
    say("enabled")

    reached, tool = [], 0.0
    with open("poses.txt") as poses:
        for line in poses:
            x, y, z, a, c, length = (float(v) for v in line.split())
            if length != tool:
                mdi("T1 M6")
                mdi("G43 H1")
                tool = length
            # With G43 the program's Z is that of the tool's point.
            mdi(f"G0 X{x:.9f} Y{y:.9f} Z{z - length:.9f} A{a:.9f} C{c:.9f}")
            reached.append(standing([x, y, z, a, c]))
    write("reached.txt", reached)
    say("poses reached, status %d" % hal.get_value(MODULE + ".status"))

    mdi(open("start.ngc").read().strip())
    standing()
    write("program.txt", operation.run("five_axis.ngc", program))
    say("program run")

    # Outside the map: the pin is raised and LinuxCNC goes on.
    operation.mode(linuxcnc.MODE_MDI)
    mdi("G0 X0 Y0 Z-100 A0 C0")
    mdi("G0 X320")
    standing()
    say("outside map %d" % hal.get_value(MODULE + ".outside-map"))
    mdi("G0 X0")
    standing()
    say("inside map %d" % (not hal.get_value(MODULE + ".outside-map")))
    say("DONE")


try:
    drive()
except Stopped as why:
    say("FAILED " + str(why))
    sys.exit(1)
