#!/usr/bin/python3
"""Inside LinuxCNC, as its display: gives temperatures to the kinematics module and writes what its pins say.

Everything is read from and written to the current folder; the last line written to driver.txt is DONE.
"""
import os
import time

from at_rest import Pins
from display_job import do_job, numbers, write
from operating import Stopped

HELD, RAMPING, AT_REFERENCE, OUT_OF_RANGE, DEAD = 1, 2, 4, 8, 16
WARM = 28


class Channel:
    def __init__(self, pins, operation):
        self.pins, self.operation = pins, operation

    def give(self, value):
        self.pins.set("state-ambient", value)

    def flags(self):
        return int(self.pins.get("state-ambient-flags"))

    def used(self):
        return self.pins.get("state-ambient-used")

    def until(self, condition, what):
        self.operation.until(condition, f"{what}: flags {self.flags()}, used {self.used()}")

    def arrive(self):
        self.operation.cycles(10)
        self.until(lambda: self.pins.get("states-behind-um") == 0, "arrived")


def first_run(operation, pins, say):
    channel = Channel(pins, operation)
    recorder = operation.recorder(0)
    operation.switch_on()
    operation.cycles(20)
    if channel.flags() != DEAD | AT_REFERENCE or pins.get("states-ok"):
        raise Stopped(f"a pin that nothing is connected to has the flags {channel.flags()}")
    pins.set("ramp-seconds", 0.2)
    pins.set("states-hold-seconds", 0.5)
    pins.set("states-ramp-per-second", 1)
    pins.set("states-rate-um-per-second", 100)
    operation.mdi("G21 G90 G49 G61")
    pins.go(numbers("place.txt")[0], (0, 0, 0))
    channel.give(22)
    channel.until(lambda: channel.flags() == 0, "good")
    pins.enable(1)
    channel.arrive()
    recorder.start()
    for value in (18, 29, 24):
        channel.give(value)
        channel.arrive()
        operation.cycles(200)
    channel.give("nan")
    channel.until(lambda: channel.flags() == DEAD | HELD, "held")
    if channel.used() != 24:
        raise Stopped(f"held at {channel.used()}")
    channel.until(lambda: channel.flags() == DEAD | RAMPING, "ramp")
    channel.until(lambda: channel.flags() == DEAD | AT_REFERENCE, "reference")
    channel.arrive()
    operation.cycles(200)
    channel.give(40)
    channel.until(lambda: channel.flags() == OUT_OF_RANGE | AT_REFERENCE | 0, "out of range")
    channel.give(WARM)
    channel.until(lambda: channel.flags() == RAMPING, "back")
    channel.until(lambda: channel.flags() == 0 and channel.used() == WARM, "good again")
    channel.arrive()
    operation.cycles(2000)
    write("samples.txt", recorder.stop())
    say(f"flags as they should be, lag {pins.get('lag-column'):.6f}")
    stored = time.time()
    operation.until(lambda: os.path.exists("mill.states") and os.path.getmtime("mill.states") > stored, "stored states")


def later_run(operation, pins, say):
    """The lag as soon as there is one."""
    pins.set("state-ambient", WARM)
    operation.switch_on()
    operation.until(lambda: pins.get("lag-column") > 0, "the lag")
    say(f"lag {pins.get('lag-column'):.9f} at {time.time():.6f}")


def drive(operation, job, say):
    pins = Pins(operation, job["module"], "XYZAC", "XYZAC")
    (first_run if job["first"] else later_run)(operation, pins, say)


do_job(drive, limit_s=90)
