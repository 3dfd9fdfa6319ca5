#!/usr/bin/env python3
"""Random programs as LinuxCNC reads them, and as it reads what `abbe compensate gcode` makes of them without errors.

Usage: random_programs_test.py ABBE MACHINE FOLDER [FIRST_SEED PROGRAMS]. Exit code 77: skipped, and said why.
"""
import ctypes
import math
import os
import pathlib
import pickle
import shutil
import subprocess
import sys
import tempfile

from random_programs import RandomProgram

SKIPPED = 77
INCH = 25.4
SAME = 3e-6  # mm and degrees: nine decimals of inches and angles, and the sagitta of nothing
ZERO_ERRORS = '[[motion]]\nname = "EXX"\nbasis = "legendre"\norder = 1\ncoefficients_um = [0, 0]\n'
PARAMETERS = "".join(f"{first + k} 0\n" for first in (5161, 5181) for k in range(6)) + "5220 1\n"
TOOLS = {1: (0.0, 0.0, 50.0), 2: (1.0, 2.0, 30.0)}


class Canon:
    """What the module `gcode` calls; its lengths are inches."""

    spindle = 0

    def __init__(self, parameters):
        self.parameter_file, self.calls = parameters, []

    def __getattr__(self, name):
        if name.startswith("__"):
            raise AttributeError(name)
        return lambda *values: None if name in ("next_line", "comment") else self.calls.append((name, values))

    def check_abort(self):
        return 0

    def get_external_length_units(self):
        return 1.0

    def get_external_angular_units(self):
        return 1.0

    def get_axis_mask(self):
        return 0x3F

    def get_block_delete(self):
        return 0

    def get_tool(self, number):
        return (number if number in (0, 1, 2) else -1, *TOOLS.get(number, (0.0, 0.0, 0.0)), *[0.0] * 9, 0)


def moves(calls):
    """(kind, start, end, centre and turns of arcs, F) in mm and degrees of the machine."""
    offsets = {"set_g5x_offset": [0.0] * 6, "set_g92_offset": [0.0] * 6, "tool_offset": [0.0] * 6}
    plane, feed, now, found = 1, 0.0, [0.0] * 6, []
    for name, values in calls:
        if name in offsets:
            first = 1 if name == "set_g5x_offset" else 0
            offsets[name] = [v * (INCH if k < 3 else 1) for k, v in enumerate(values[first:first + 6])]
        elif name == "set_plane":
            plane = values[0]
        elif name == "set_feed_rate":
            feed = values[0] * INCH
        elif name == "dwell":
            found.append(("dwell", values[0]))
        elif name in ("straight_traverse", "straight_feed", "arc_feed"):
            total = [sum(k) for k in zip(*offsets.values())]
            arc = None
            if name == "arc_feed":
                a = {1: 0, 2: 1, 3: 2}[plane]
                end = [0.0] * 3 + list(values[6:9])
                for k, i in ((a, 0), ((a + 1) % 3, 1), ((a + 2) % 3, 5)):
                    end[k] = values[i] * INCH
                arc = (a, [values[2 + i] * INCH + total[(a + i) % 3] for i in range(2)], values[4])
            else:
                end = [v * (INCH if k < 3 else 1) for k, v in enumerate(values[:6])]
            end = [e + t for e, t in zip(end, total)]
            if arc or max(abs(e - n) for e, n in zip(end, now)) > 2e-7:
                found.append((name, now, end, arc, feed))
            now = end
    return found


def minutes(move):
    linear = math.dist(move[1][:3], move[2][:3])
    return (linear if linear > 1e-7 else math.dist(move[1][3:], move[2][3:])) / move[4]


def difference(original, written):
    """What differs, or None. Arcs have become chords: their nodes are on the arc, as long as it takes."""
    at = 0
    for move in original:
        if at == len(written):
            return f"{move} is missing"
        if move[0] == "dwell":
            if written[at][0] != "dwell" or abs(written[at][1] - move[1]) > 1e-9:
                return f"{move} is {written[at]}"
            at += 1
            continue
        expected = "straight_feed" if move[3] else move[0]
        pieces, least = 0, 4 * abs(move[3][2]) - 1 if move[3] else 0
        spent = 0.0
        while True:
            if at == len(written) or written[at][0] != expected:
                return f"{move} is {written[at] if at < len(written) else 'cut short'}"
            piece = written[at]
            at, pieces = at + 1, pieces + 1
            if expected == "straight_feed":
                spent += minutes(piece)
            if move[3]:
                a, centre, _ = move[3]
                radius = math.dist([move[1][a], move[1][(a + 1) % 3]], centre)
                if abs(math.dist([piece[2][a], piece[2][(a + 1) % 3]], centre) - radius) > 1e-4:
                    return f"{piece} is beside {move}"
            if pieces > least and max(abs(p - q) for p, q in zip(piece[2], move[2])) < SAME:
                break
            if not move[3]:
                return f"{piece} does not end as {move}"
        # The module divides F by 25.4 where it stands behind G21, that of angles too.
        rotary = math.dist(move[1][:3], move[2][:3]) < 1e-7 if not move[3] else False
        taken = [minutes(move) * factor for factor in ((1, INCH, 1 / INCH) if rotary else (1,))] if move[4] else []
        if move[0] == "straight_feed" and min(abs(spent - t) / t for t in taken) > 2e-4:
            return f"{move} takes {minutes(move)} min, written {spent} min"
    return f"{written[at]} is too many" if at < len(written) else None


def parse(gcode, folder, text):
    """In a process of its own: the module keeps state from one program to the next."""
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reading)
        (folder / "p.ngc").write_text(text)
        (folder / "p.var").write_text(PARAMETERS)
        canon = Canon(str(folder / "p.var"))
        code, line = gcode.parse(str(folder / "p.ngc"), canon, "", "")
        with os.fdopen(writing, "wb") as out:
            pickle.dump((canon.calls, "" if code <= 1 else f"line {line}: {gcode.strerror(code)}"), out)
        os._exit(0)
    os.close(writing)
    with os.fdopen(reading, "rb") as result:
        data = result.read()
    os.waitpid(child, 0)
    return pickle.loads(data) if data else ([], "the module gcode has crashed")


def main():
    abbe, machine, place = sys.argv[1:4]
    first, count = (int(sys.argv[4]), int(sys.argv[5])) if len(sys.argv) > 4 else (1, 150)
    if shutil.which("rs274") is None:
        print("skipped: rs274 (Debian package linuxcnc-uspace) is not installed")
        sys.exit(SKIPPED)
    with tempfile.TemporaryDirectory(prefix="random-programs-", dir=place) as name:
        folder = pathlib.Path(name)
        os.environ["HOME"] = name
        (folder / "p.ngc").write_text("M2\n")
        (folder / "p.var").write_text(PARAMETERS)
        tools = "".join(f"T{t} P{t} X{x:.12f} Y{y:.12f} Z{z:.12f}\n" for t, (x, y, z) in TOOLS.items())
        (folder / "tools.tbl").write_text(tools)
        inches = "".join(f"T{t} P{t} X{x / INCH:.12f} Y{y / INCH:.12f} Z{z / INCH:.12f}\n" for t, (x, y, z) in TOOLS.items())
        (folder / "inches.tbl").write_text(inches)
        (folder / "start.var").write_text(PARAMETERS)
        (folder / "errors.toml").write_text(ZERO_ERRORS)
        travel = pathlib.Path(machine).read_text()
        for old in ("[-255, 255]", "[-300, 300]", "[-510, 0]", "[-120, 30]"):
            travel = travel.replace(old, "[-90000, 90000]")
        (folder / "wide.machine.toml").write_text(travel)
        subprocess.run(["rs274", "-g", "-v", name + "/p.var", "-t", name + "/inches.tbl", name + "/p.ngc"], check=False,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=30)
        try:
            import gcode
            ctypes.CDLL("libtooldata.so.0")._Z14tool_mmap_userv()
        except (ImportError, OSError) as problem:
            print("skipped: LinuxCNC's Python module gcode is not there:", problem)
            sys.exit(SKIPPED)
        compared = 0
        for seed in range(first, first + count):
            text = RandomProgram(seed).text()
            (folder / "in.ngc").write_text(text)
            calls, problem = parse(gcode, folder, text)
            ran = subprocess.run([abbe, "compensate", "gcode", name + "/in.ngc", "--machine", name + "/wide.machine.toml", "--errors",
                                  name + "/errors.toml", "--force", "-o", name + "/out.ngc", "--parameters", name + "/start.var",
                                  "--tool-table", name + "/tools.tbl", "--decimals", "9",
                                  *[w for a in ("X_mm", "Y_mm", "Z_mm", "A_deg", "C_deg") for w in ("--start", a + "=0")]],
                                 check=False, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=60)
            if problem or ran.returncode != 0:
                sys.exit(f"FAILED: seed {seed}: LinuxCNC: {problem or 'runs it'}; abbe: {ran.stderr}\n{text}")
            written = (folder / "out.ngc").read_text()
            again, problem = parse(gcode, folder, written)
            problem = problem or difference(moves(calls), moves(again))
            if problem:
                sys.exit(f"FAILED: seed {seed}: {problem}\n{text}")
            compared += len(moves(calls))
    if compared < 15 * count:
        sys.exit(f"FAILED: only {compared} moves in {count} programs")
    print(f"{count} programs, {compared} moves")


main()
