#!/usr/bin/python3
"""Inside LinuxCNC, as its display: goes to poses and writes where the joints then stand.

Everything is read from and written to the current folder; the last line written to driver.txt is DONE. Two kinds of
runs: without temperatures every pose at once, first without and then with the compensation; with them each pose at its
hour of the day, on the clock of `thermometers`.
"""
import time

import hal
from at_rest import Pins
from display_job import do_job, numbers, write
from operating import Stopped

OFFSET = (0, 0, 120)  # of the tool, as in tools.tbl
SETTLED_CYCLES = 8


def joints(pins):
    return [hal.get_value(name) for name in pins.joints]


def at_once(operation, pins):
    """Rows: hour (as it is asked for), part compensated, nominal X Y Z, joints X Y Z."""
    rows = []
    for enabled in (0, 1):
        pins.enable(enabled)
        for hour, *world in numbers("poses.txt"):
            pins.go(world, OFFSET)
            rows.append([hour, enabled, *world, *joints(pins)])
            if pins.get("status") < 0 or pins.get("outside-map") or pins.get("outside-tool"):
                raise Stopped(f"the module is not sure of {world}")
    write("reached.txt", rows)


def settled_row(operation, pins, job, hour):
    """Hour, joints, um behind, states ok, lags, channels as used: no value of a channel changed just before."""
    while True:
        used = [pins.get(f"state-{name}-used") for name in job["channels"]]
        operation.cycles(SETTLED_CYCLES)
        begin, at = hour(), joints(pins)
        row = [(begin + hour()) / 2, *at, pins.get("states-behind-um"), pins.get("states-ok"),
               *(pins.get(f"lag-{name}") for name in job["lags"])]
        if used == [pins.get(f"state-{name}-used") for name in job["channels"]]:
            return row + used


def over_the_day(operation, pins, job, say):
    """Rows: hour, part compensated, nominal X Y Z, joints X Y Z, um behind, states ok, lags, channels as used."""
    pins.enable(1)
    operation.cycles(100)
    start = time.monotonic() + 0.1
    hal.set_p("thermometers.start", repr(start))

    def hour():
        return job["first_h"] + (time.monotonic() - start) * job["factor"] / 3600

    rows, late = [], 0
    for asked, *world in numbers("poses.txt"):
        operation.until(lambda asked=asked: hour() >= asked, "the hour")
        if hour() >= job["last_h"]:
            break
        operation.mdi("G0 " + pins.words_of(world, OFFSET))
        operation.until(lambda world=world: max(abs(hal.get_value(name) - place)
                                                for name, place in zip(pins.world, world)) < 1e-6, f"world at {world}")
        row = settled_row(operation, pins, job, hour)
        late = max(late, row[0] - asked)
        rows.append([row[0], pins.get("enabled"), *world, *row[1:]])
        if pins.get("status") < 0 or pins.get("outside-map") or pins.get("outside-tool"):
            raise Stopped(f"the module is not sure of {world}")
    write("reached.txt", rows)
    say(f"{len(rows)} poses, at most {60 * late:.1f} min of the day late")


def drive(operation, job, say):
    pins = Pins(operation, job["module"], "XYZ", "XYZ")
    operation.switch_on()
    operation.mdi("G21 G90 G49 G61")
    pins.set("ramp-seconds", 0.1)
    pins.tool(1)
    if "factor" in job:
        over_the_day(operation, pins, job, say)
    else:
        at_once(operation, pins)


do_job(drive, limit_s=420)
