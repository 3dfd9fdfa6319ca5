#!/usr/bin/python3
"""Inside LinuxCNC, as its display: goes to poses with nominal pins of a stock kinematics module and with other ones.

Everything is read from and written to the current folder; the last line written to driver.txt is DONE.
"""
import hal
from display_job import do_job, numbers, write


def drive(operation, job, say):
    joints = [f"joint.{j}.motor-pos-cmd" for j in range(5)]
    world = [f"axis.{letter}.pos-cmd" for letter in job["letters"].lower()]
    operation.switch_on()
    operation.mdi("G21 G90 G49 G61")
    if job["switched"]:
        # The interpreter takes over the world of the other kinematics (LinuxCNC, "Switchable Kinematics").
        hal.set_p("motion.switchkins-type", "1")
        operation.cycles(20)
        operation.mdi("M66 E0 L0")
    operation.mdi("T1 M6")
    operation.mdi("G43 H1")

    def places_of(names):
        return [hal.get_value(name) for name in names]

    def go(*place):
        operation.mdi("G0 " + " ".join(f"{letter}{at}" for letter, at in zip(job["letters"], place)))
        wanted = [at + job["length_mm"] if letter == "Z" else at for letter, at in zip(job["letters"], place)]
        operation.until(lambda: max(abs(at - to) for at, to in zip(places_of(world), wanted)) < 1e-6, "the world")
        before = None
        while (now := places_of(joints)) != before:
            before = now
            operation.cycles(20)
        return now

    for name, pins in job["pins"].items():
        # At zero of the rotary axes the pins move no joint.
        go(0, 0, -300, 0, 0)
        for pin, value in pins.items():
            hal.set_p(pin, str(value))
        operation.cycles(20)
        write(f"{name}.txt", [go(*place) for place in numbers("places.txt")])
        say(name)


do_job(drive, limit_s=120)
