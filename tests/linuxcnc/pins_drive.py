#!/usr/bin/python3
"""Inside LinuxCNC, as its display: turns the compensation on and off, goes to places, writes what the pins say.

Everything is read from and written to the current folder; the last line written to driver.txt is DONE.
"""
import time

from at_rest import Pins
from display_job import do_job, numbers, write
from operating import Stopped

SINGLE = ("outside-map", "outside-tool", "turn-limited", "largest-correction")


class Pinned(Pins):
    def here(self):
        return super().here() + [float(self.get(name)) for name in SINGLE]


def ramp(pins, recorder, name, seconds, steps):
    """Records every servo cycle of some ramps; how long they were and took.

    @param steps  each: wanted of `enable`, and the part enabled at which the next one begins
    """
    pins.set("ramp-seconds", seconds)
    recorder.start()
    pins.operation.cycles(30)
    started = time.monotonic()
    for wanted, end in steps:
        pins.set("enable", wanted)
        pins.operation.until(lambda: pins.get("enabled") >= end if wanted else pins.get("enabled") <= end, "the ramp")
    taken = time.monotonic() - started
    pins.operation.cycles(30)
    write(name, recorder.stop())
    return seconds, taken


def drive(operation, job, say):
    pins = Pinned(operation, job["module"], "XYZAC", "XYZAC")
    recorder, edge = operation.recorder(0), operation.recorder(1)
    operation.switch_on()
    operation.mdi("G21 G90 G49 G61")
    places = numbers("places.txt")
    first, *others = places
    reached = [pins.go(first[4:], first[1:4])]
    ramps = [ramp(pins, recorder, "on.txt", 0.4, [(1, 1)])]
    reached.append(pins.here())
    ramps += [ramp(pins, recorder, "off.txt", 1.2, [(0, 0)]),
              ramp(pins, recorder, "interrupted.txt", 0.4, [(1, 0.5), (0, 0.2), (1, 1)])]
    write("ramps.txt", ramps)
    tool = 0
    for number, x, y, z, *world in others:
        if number != tool:
            tool = number
            operation.mdi("G0 A0 C0")
            pins.tool(int(tool))
        reached.append(pins.go(world, (x, y, z)))
    write("reached.txt", reached)
    say("places reached")

    operation.mdi("G0 X280 Y0 Z-150 A-40 C0")
    pins.here()
    edge.start()
    operation.mdi("G94 G1 X330 F6000")
    operation.cycles(20)
    write("edge.txt", edge.stop())
    say("over the edge")

    # The world may go further, the joint may not.
    operation.mdi("G0 X0")
    try:
        operation.mdi("G0 X450")
        say("no limit")
    except Stopped as why:
        say(f"limit: {why}")


do_job(drive, limit_s=90)
