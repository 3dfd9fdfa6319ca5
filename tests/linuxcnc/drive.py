#!/usr/bin/python3
"""Inside LinuxCNC, as its display: homes, runs poses, enables the compensation, runs a program, writes what it saw.

Everything is read from and written to the current folder; the last line written to driver.txt is DONE.
"""
import os
import sys
import time

import hal
import linuxcnc

MODULE = os.environ["ABBEKINS"]
LIMIT_S = 80
started = time.monotonic()
log = open("driver.txt", "w", buffering=1)
command, status, errors = linuxcnc.command(), linuxcnc.stat(), linuxcnc.error_channel()
component = hal.component("drive")
component.ready()


def say(text):
    log.write(f"{time.monotonic() - started:.2f} {text}\n")


def stop(text):
    say("FAILED " + text)
    while True:
        message = errors.poll()
        if not message:
            break
        say(f"message {message}")
    sys.exit(1)


def until(condition, what):
    while not condition():
        if time.monotonic() - started > LIMIT_S:
            stop("no time left: " + what)
        time.sleep(0.001)


def idle():
    status.poll()
    return (status.interp_state == linuxcnc.INTERP_IDLE and status.inpos and status.exec_state == linuxcnc.EXEC_DONE
            and not status.queue)


def mdi(text):
    command.mdi(text)
    command.wait_complete(20)
    until(idle, text)


def cycles(count):
    """Waits until so many servo cycles have gone by: without real time, time alone says nothing of them."""
    end = hal.get_value("integ.0.out") + 0.001 * (count + 0.5)
    until(lambda: hal.get_value("integ.0.out") > end, "servo cycles")


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


until(lambda: (status.poll() or True) and status.task_state != 0, "no task")
command.state(linuxcnc.STATE_ESTOP_RESET)
command.wait_complete()
command.state(linuxcnc.STATE_ON)
command.wait_complete()
command.mode(linuxcnc.MODE_MANUAL)
command.wait_complete()
command.teleop_enable(0)
command.wait_complete()
command.home(-1)
until(lambda: (status.poll() or True) and all(status.homed[:5]), "homing")
command.mode(linuxcnc.MODE_MDI)
command.wait_complete()
say("homed")
mdi("G21 G90 G49 G61")

# Enabling at a standing pose: recorded in every servo cycle.
mdi("G0 X100 Y-80 Z-200 A-30 C60")
standing([100, -80, -200, -30, 60])
hal.set_p("sampler.0.enable", "1")
cycles(30)
hal.set_p(MODULE + ".enable", "1")
until(lambda: hal.get_value(MODULE + ".enabled") == 1, "the ramp")
cycles(30)
hal.set_p("sampler.0.enable", "0")
say("enabled")

with open("reached.txt", "w") as out:
    tool = 0.0
    for line in open("poses.txt"):
        x, y, z, a, c, length = (float(v) for v in line.split())
        if length != tool:
            mdi("T1 M6")
            mdi("G43 H1")
            tool = length
        # With G43 the program's Z is that of the tool's point.
        mdi(f"G0 X{x:.9f} Y{y:.9f} Z{z - length:.9f} A{a:.9f} C{c:.9f}")
        out.write(" ".join(f"{value:.17g}" for value in standing([x, y, z, a, c])) + "\n")
say("poses reached, status %d" % hal.get_value(MODULE + ".status"))

mdi(open("start.ngc").read().strip())
standing()
command.mode(linuxcnc.MODE_AUTO)
command.wait_complete()
command.program_open(os.path.abspath("five_axis.ngc"))
command.wait_complete()
hal.set_p("sampler.1.enable", "1")
command.auto(linuxcnc.AUTO_RUN, 0)
until(lambda: not idle(), "start of the program")
until(idle, "end of the program")
hal.set_p("sampler.1.enable", "0")
say("program run")

# Outside the map: the pin is raised and LinuxCNC goes on.
command.mode(linuxcnc.MODE_MDI)
command.wait_complete()
mdi("G0 X0 Y0 Z-100 A0 C0")
mdi("G0 X320")
standing()
say("outside map %d" % hal.get_value(MODULE + ".outside-map"))
mdi("G0 X0")
standing()
say("inside map %d" % (not hal.get_value(MODULE + ".outside-map")))
time.sleep(0.3)  # the samplers' programs write what they have
say("DONE")
