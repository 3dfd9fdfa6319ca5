"""Operates a LinuxCNC from inside, for programs that are its display (system Python with LinuxCNC's modules)."""
import os
import time

import hal
import linuxcnc

RESTING_CYCLES = 20


class Stopped(Exception):
    """LinuxCNC refused something or took too long; the text is for people."""


class Recorder:
    """Values of pins in every servo cycle (headless.hal_text, `recorded`), between start() and stop()."""

    def __init__(self, component, number):
        self.name = f"sampler.{number}"
        self.stream = hal.stream(component, hal.sampler_base + number)
        self.rows = []
        self.last = None  # number of the sample before

    def start(self):
        self.rows.clear()
        hal.set_p(self.name + ".enable", "1")

    def collect(self):
        """Takes what has come in; to be called more often than the buffer fills (16384 cycles)."""
        while self.stream.readable:
            self.rows.append(self.stream.read())
            if self.last is not None and self.stream.sampleno != self.last + 1:
                raise Stopped(f"{self.stream.sampleno - self.last - 1} servo cycles were not recorded")
            self.last = self.stream.sampleno

    def stop(self):
        hal.set_p(self.name + ".enable", "0")
        self.collect()
        lost = hal.get_value(self.name + ".overruns")
        if lost:
            raise Stopped(f"{lost} servo cycles were not recorded: the buffer was full")
        return self.rows


class Operation:
    """The control, from switching on to the end of a program."""

    def __init__(self, limit_s):
        self.started = time.monotonic()
        self.limit_s = limit_s
        self.command, self.status, self.errors = linuxcnc.command(), linuxcnc.stat(), linuxcnc.error_channel()
        self.component = hal.component("display")
        self.recorders = []

    def recorder(self, number):
        self.recorders.append(Recorder(self.component, number))
        return self.recorders[-1]

    def messages(self):
        """Errors that LinuxCNC has reported since the last call."""
        found = []
        while message := self.errors.poll():
            if message[0] in (linuxcnc.OPERATOR_ERROR, linuxcnc.NML_ERROR):
                found.append(message[1].strip())
        return found

    def until(self, condition, what):
        """Waits for `condition`; an error that LinuxCNC reports, or the end of the time, is Stopped."""
        while True:
            # First the errors: what they interrupt looks finished afterwards.
            found = self.messages()
            if found:
                raise Stopped("; ".join(found))
            for recorder in self.recorders:
                recorder.collect()
            self.status.poll()
            if condition():
                return
            if time.monotonic() - self.started > self.limit_s:
                raise Stopped("no time left: " + what)
            time.sleep(0.001)

    def idle(self):
        status = self.status
        return (status.interp_state == linuxcnc.INTERP_IDLE and status.inpos and status.queue == 0
                and status.exec_state in (linuxcnc.EXEC_DONE, linuxcnc.EXEC_ERROR))

    def mode(self, mode):
        self.command.mode(mode)
        self.command.wait_complete()

    def mdi(self, text):
        self.command.mdi(text)
        self.command.wait_complete(20)
        self.until(self.idle, text)

    def cycles(self, count):
        """Waits until so many servo cycles have gone by: without real time, time alone says nothing of them."""
        end = hal.get_value("integ.0.out") + count + 0.5
        self.until(lambda: hal.get_value("integ.0.out") > end, "servo cycles")

    def switch_on(self):
        """Out of the emergency stop, on, homed, ready for MDI."""
        self.component.ready()
        self.until(lambda: self.status.task_state != 0, "the start of LinuxCNC")
        for state in (linuxcnc.STATE_ESTOP_RESET, linuxcnc.STATE_ON):
            self.command.state(state)
            self.command.wait_complete()
        self.mode(linuxcnc.MODE_MANUAL)
        self.command.teleop_enable(0)
        self.command.wait_complete()
        self.command.home(-1)
        self.until(lambda: all(self.status.homed[:self.status.joints]), "homing")
        self.mode(linuxcnc.MODE_MDI)

    def run(self, program, recorder, progress=lambda line: None):
        """Runs a program from its first line; what `recorder` saw, with some cycles at rest before and after.

        @param progress  called with the line that moves
        """
        self.mode(linuxcnc.MODE_AUTO)
        self.command.program_open(os.path.abspath(program))
        self.command.wait_complete()
        recorder.start()
        self.cycles(RESTING_CYCLES)
        self.command.auto(linuxcnc.AUTO_RUN, 0)

        def ended():
            if self.status.interp_state == linuxcnc.INTERP_PAUSED:  # M0, M60
                self.command.auto(linuxcnc.AUTO_RESUME)
            progress(self.status.motion_line)
            return self.idle()

        self.until(lambda: not self.idle(), "start of the program")
        self.until(ended, "end of the program")
        self.cycles(RESTING_CYCLES)
        return recorder.stop()
