#!/usr/bin/python3
"""Inside LinuxCNC, as its display: homes and runs the probing program of the current folder."""
from display_job import do_job


def drive(operation, job, say):
    recorder = operation.recorder(0)
    operation.switch_on()
    operation.mdi("G21 G90 G49 G61")
    operation.run("probe.ngc", recorder)
    say("probed")


do_job(drive, limit_s=240)
