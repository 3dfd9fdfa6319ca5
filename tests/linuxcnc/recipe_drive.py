#!/usr/bin/python3
"""Inside LinuxCNC, as the display of linuxcnc/example: homes and moves as somebody would who tries it.

The last line written to driver.txt is DONE.
"""
import hal
from at_rest import Pins
from display_job import do_job
from operating import Stopped

# From home A stands parallel to the tool: a singular pose, left and reached again at ordinary speeds.
MOVES = ["G0 X10 Y20 Z-100 A-30 C45", "G0 A0 C0", "T1 M6", "G43 H1", "G1 X50 Y-40 Z-400 A-45 C120 F6000", "G0 X-20 Y15 Z-350 A0 C0",
         "G0 A-0.002 C3", "G0 A0.002 C-3", "G0 X0 Y0 A0 C0"]


def check(holds, what):
    if not holds:
        raise Stopped(what)


def drive(operation, job, _say):
    pins = Pins(operation, job["module"], "XYZAC", "XYZAC")
    operation.switch_on()
    operation.until(lambda: pins.get("enabled") == 1, "the ramp of the example")
    operation.mdi("G21 G90 G49")
    largest = 0.0
    for move in MOVES:
        operation.mdi(move)
        row = pins.here()
        world, joints, corrections = row[3:8], row[8:13], row[13:18]
        largest = max(largest, *map(abs, corrections[:3]))
        check(row[18:] == [-1, row[19], 1] and row[19] in (0, 2), f"{move}: uncertainty, status, enabled {row[18:]}")
        if world[3] == 0 and world[4] == 0:
            apart = max(abs(j - c - w) for j, c, w in zip(joints[:2], corrections, world))
            check(apart < 1e-9, f"{move}: joints less corrections are {apart} mm from the world")
    check(abs(hal.get_value("motion.tooloffset.z") - 150) < 1e-9, "the tool of the example has another length")
    check(pins.get("tooloffset-z") == hal.get_value("motion.tooloffset.z"), "the tool length is not wired")
    check(0.01 < largest < 4, f"the largest correction of a joint is {largest} mm")


do_job(drive, limit_s=90)
