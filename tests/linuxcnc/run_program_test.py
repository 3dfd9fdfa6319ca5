#!/usr/bin/env python3
"""linuxcnc/run-program against programs whose path is known. Usage: run_program_test.py RUN_PROGRAM ABBE MACHINE FOLDER

Exit code 77: skipped, and said why.
"""
import csv
import math
import pathlib
import subprocess
import sys
import tempfile

SKIPPED = 77
HEADER = ["time_s", "X_mm", "Y_mm", "Z_mm", "A_deg", "C_deg"]
FEED = 480  # mm/min
CORNERS = [(0, 0, 0), (12, 0, 0), (12, 9, -3), (2, 4, -6), (2, 4, -2)]
PROGRAM = f"G21 G90 G94 G61 F{FEED}\n" + "".join(f"G1 X{x} Y{y} Z{z}\n" for x, y, z in CORNERS[1:]) + "M2\n"
TURNS = "G21 G90 G94 G61 F1800\nG1 A-20 C45\nG1 A-10 C400\nM30\n"
# 2 degrees within 2 s each, beside 1 um: not in inverse time, whose least feed is 0.1 mm/min.
SLOW_TURNS = "G21 G90 G94 G64\nG1 X0.001 C2 F0.03\nG1 X0 C4\nG93 G1 X0.001 C6 F30\nM2\n"
BACK_AND_FORTH = f"G21 G90 G94 G61 F{FEED}\nG1 X14 Y3\nG1 Y1\nM2\n"
REFUSED = "G21 G90 G61\nG1 X12 F600\nG1 Y3 Q\nM2\n"
OUTSIDE = "G21 G90 G61\nG1 X12 F600\nG1 X400\nM2\n"


def check(holds, what):
    if not holds:
        sys.exit("FAILED: " + what)


def distance(point, start, end):
    along = [b - a for a, b in zip(start, end)]
    share = sum((p - a) * v for p, a, v in zip(point, start, along)) / sum(v * v for v in along)
    share = min(1.0, max(0.0, share))
    return math.dist(point, [a + share * v for a, v in zip(start, along)])


class Runner:
    def __init__(self, tool, abbe, machine, folder):
        self.tool, self.abbe, self.machine, self.folder = tool, abbe, machine, pathlib.Path(folder)

    def program(self, name, text):
        (self.folder / name).write_text(text)
        return str(self.folder / name)

    def __call__(self, *words, expected=0):
        ran = subprocess.run([self.tool, "--abbe", self.abbe, "--machine", self.machine, *words], check=False,
                             text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=120)
        if ran.returncode == SKIPPED:
            print("skipped:", ran.stderr)
            sys.exit(SKIPPED)
        check(ran.returncode == expected, f"exit code {ran.returncode}, not {expected}: {ran.stderr}")
        return ran.stderr

    def trace(self, name):
        with open(self.folder / name, encoding="ascii") as file:
            header, *rows = csv.reader(file)
        check(header == HEADER, f"columns {header}")
        rows = [[float(value) for value in row] for row in rows]
        late = max(abs(row[0] - 0.001 * k) for k, row in enumerate(rows))
        check(late < 1e-9, f"the rows are not a servo period apart: {late} s")
        return [row[1:] for row in rows]


def test_paths(run):
    """Three programs in one session."""
    run(run.program("corners.ngc", PROGRAM), "-o", str(run.folder / "corners.csv"), run.program("turns.ngc", TURNS),
        "-o", str(run.folder / "turns.csv"), run.program("slow.ngc", SLOW_TURNS), "-o", str(run.folder / "slow.csv"))
    rows = run.trace("corners.csv")
    left = [file.name for file in run.folder.iterdir() if file.suffix not in (".ngc", ".csv")]
    check(not left, f"files were left behind: {left}")
    check(math.dist(rows[0], [0] * 5) < 1e-9, f"the trace begins at {rows[0]}")
    check(math.dist(rows[-1], [*CORNERS[-1], 0, 0]) < 1e-6, f"the trace ends at {rows[-1]}")
    sides = list(zip(CORNERS, CORNERS[1:]))
    off = max(min(distance(row[:3], *side) for side in sides) for row in rows)
    check(off < 1e-3, f"the trace leaves the path by {1e3 * off} um")
    missed = max(min(math.dist(row[:3], corner) for row in rows) for corner in CORNERS)
    # LinuxCNC's interpolation cuts a sixth of a step off a corner.
    check(missed < FEED / 60 * 0.001 / 4, f"the trace misses a corner by {1e3 * missed} um")
    # Were a row missing or there twice, steps at the feed would not be those of one period.
    steps = [math.dist(a, b) for a, b in zip(rows, rows[1:])]
    step = FEED / 60 * 0.001
    at_feed = sum(abs(s - step) < 1e-6 for s in steps)
    length = sum(math.dist(*side) for side in sides)
    check(max(steps) < step + 1e-6 and at_feed > 0.95 * length / step,
          f"{at_feed} of {len(steps)} steps are those of the feed, the largest {max(steps)} mm")
    turns = run.trace("turns.csv")
    check(math.dist(turns[-1], [0, 0, 0, -10, 400]) < 1e-6, f"the second trace ends at {turns[-1]}")
    slow = run.trace("slow.csv")
    at = [next(k for k, row in enumerate(slow) if row[4] > angle - 1e-6) * 1e-3 for angle in (2, 4, 6)]
    check(abs(at[0] - 2) < 0.1 and abs(at[1] - at[0] - 2) < 0.1 and at[2] - at[1] < 1, f"slow turns end at {at} s")
    print(f"{len(rows)} cycles, at most {1e3 * off:.4f} um from the path")


def test_home_and_backlash(run):
    """Zero is outside the travel of X: it stands at its near end; Y has backlash, so its motor is half of it ahead."""
    text = pathlib.Path(run.machine).read_text()
    moved = text.replace("travel_mm = [-300, 300]", "travel_mm = [10, 300]")
    check(moved != text, "the machine file has another travel")
    other = Runner(run.tool, run.abbe, run.program("shifted.machine.toml", moved), run.folder)
    other(other.program("back.ngc", BACK_AND_FORTH), "-o", str(run.folder / "back.csv"), "--backlash", "Y=0.02")
    rows = other.trace("back.csv")
    check(abs(rows[0][0] - 10) < 1e-9, f"X begins at {rows[0][0]}")
    check(abs(rows[-1][0] - 14) < 1e-6, f"X ends at {rows[-1][0]}")
    ahead = [row[1] - 0.75 * (row[0] - 10) for row in rows[2:] if row[0] < 13.9]
    check(max(abs(value - 0.01) for value in ahead) < 1e-6, "on its way there Y is not 0.01 ahead")
    check(abs(rows[-1][1] - 0.99) < 1e-6, f"Y ends at {rows[-1][1]}, not 1 - 0.01")


def test_refusals(run):
    trace = run.folder / "none.csv"
    said = run(run.program("refused.ngc", REFUSED), "-o", str(trace), expected=1)
    check("refused.ngc: line 3: G1 Y3 Q" in said, said)
    said = run(run.program("outside.ngc", OUTSIDE), "-o", str(trace), expected=1)
    check("line 3 would exceed X's positive limit" in said, said)
    said = run(run.program("comp.ngc", PROGRAM), "-o", str(trace), "--comp",
               "X=" + run.program("x.comp", "0 0 0\n# a comment ends it for LinuxCNC\n1 0 0\n"), expected=2)
    check("x.comp:2: expected three numbers" in said, said)
    said = run(run.program("comp.ngc", PROGRAM), "-o", str(trace), "--comp",
               "X=" + run.program("y.comp", "0 0 0\n1 nan 0\n"), expected=2)
    check("y.comp:2: expected three numbers" in said, said)
    comp = run.program("z.comp", "0 0 0\n1 0 0\n")
    said = run(run.program("comp.ngc", PROGRAM), "-o", comp, "--comp", "X=" + comp, expected=2)
    check("replace neither an input" in said, said)
    check("the file is empty" in run(run.program("empty.ngc", ""), "-o", str(trace), expected=2), "an empty program")
    device = run.folder / "device"
    device.symlink_to("/dev/null")
    said = run(run.program("comp.ngc", PROGRAM), "-o", str(device), expected=2)
    check("is no file" in said and device.is_symlink(), said)
    kept = run.program("kept.csv", "the trace of another day\n")
    said = run(run.program("comp.ngc", PROGRAM), "-o", kept, expected=2)
    check("kept.csv: the file exists" in said and "--force" in said, said)
    with open(kept, encoding="ascii") as file:
        check(file.read() == "the trace of another day\n", "a trace was replaced without --force")
    for option in ("--backlash=X=nan", "--limit-s=inf"):
        run(run.program("comp.ngc", PROGRAM), "-o", str(trace), option, expected=2)
    check(not trace.exists(), "there is a trace of a program that was refused")


def main():
    tool, abbe, machine, place = sys.argv[1:5]
    with tempfile.TemporaryDirectory(prefix="run-program-", dir=place) as folder:
        run = Runner(tool, abbe, machine, folder)
        test_paths(run)
        test_home_and_backlash(run)
        test_refusals(run)


main()
