#!/usr/bin/env python3
"""Whatever fails while results are written, nothing is lost.

    faults_test.py ABBE FAULTS.so EXAMPLES

A command writes over older results, in a folder with a note of somebody's, while the n-th call that changes files fails
(no space, input/output error) or the process is killed there, for every n. The results are then the older or the new
ones, whole, and the note is there; after the next run nothing else is. Then runs side by side whose process numbers
are the same, in containers of their own.
"""
import os
import pathlib
import subprocess
import sys
import tempfile

ABBE, FAULTS, EXAMPLES = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3])
KINDS = ["EIO", "ENOSPC", "KILL"]
NOTE = "note of somebody"


def run(folder, words, fault=None, count=None):
    environment = dict(os.environ, LD_PRELOAD=FAULTS) if fault or count else dict(os.environ)
    if fault:
        environment["ABBE_FAULT"] = fault
    if count:
        environment["ABBE_FAULT_COUNT"] = str(count)
    return subprocess.run([ABBE, *words], cwd=folder, env=environment, capture_output=True, text=True, check=False)


def contents(place):
    """All files, or one, by name."""
    if place.is_file():
        return {place.name: place.read_bytes()}
    return {str(file.relative_to(place)): file.read_bytes() for file in sorted(place.rglob("*")) if file.is_file()}


class Case:
    """A command that writes `output`; `older` and `newer` are its words for different results. Without `older` nothing
    is there before, and `newer` does not replace what is."""

    def __init__(self, output, older, newer, has_note):
        self.output, self.older, self.newer, self.has_note = output, older, newer, has_note
        with tempfile.TemporaryDirectory() as folder:
            place = pathlib.Path(folder)
            self.start(place)
            self.before = contents(place / output)
            done = run(place, newer, count=place / "count")
            assert done.returncode == 0, done.stderr
            self.calls = int((place / "count").read_text())
            self.after = contents(place / output)
        assert self.before != self.after, "the two results are the same"
        assert not has_note or "note.txt" in self.after, "the note was lost"
        assert self.calls > 3, "no calls were counted"

    def start(self, place):
        if self.older is None:
            return
        done = run(place, self.older)
        assert done.returncode == 0, done.stderr
        if self.has_note:
            (place / self.output / "note.txt").write_text(NOTE)

    def with_fault(self, fault):
        with tempfile.TemporaryDirectory() as folder:
            place = pathlib.Path(folder)
            self.start(place)
            done = run(place, self.newer, fault=fault)
            found = contents(place / self.output)
            killed = fault.endswith("KILL")
            # Of a run that did not end well the note may stand beside the results until the next one.
            if self.has_note and done.returncode != 0:
                found = {**found, "note.txt": NOTE.encode()}
            assert found in (self.before, self.after), f"{fault}: neither the older nor the new results: {list(found)}"
            assert "terminate called" not in done.stderr and done.returncode in ((-9, 0) if killed else (0, 2)), \
                f"{fault}: exit code {done.returncode}: {done.stderr}"
            if done.returncode == 0:
                assert found == self.after, f"{fault}: exit code 0 and the older results"
            again = run(place, self.newer)
            refused = self.older is None and found == self.after
            assert again.returncode == (2 if refused else 0), f"{fault}: the next run: {again.stderr}"
            assert contents(place / self.output) == self.after, f"{fault}: lost after the next run"
            left = [entry.name for entry in place.iterdir()]
            assert left == [self.output], f"{fault}: left behind {left}"


def same_process_numbers():
    """Two commands at once in PID namespaces of their own, where both have the same number, and one output."""
    apart = ["unshare", "--pid", "--fork", "--mount-proc"]
    if os.geteuid() != 0 or subprocess.run([*apart, "true"], check=False, stderr=subprocess.DEVNULL).returncode != 0:
        print("no namespaces here: not two containers with one folder")
        return 0
    count = 30
    with tempfile.TemporaryDirectory() as folder:
        place = pathlib.Path(folder)
        whole = []
        for words in (FOLDER.older, FOLDER.newer):
            assert run(place, words).returncode == 0
            whole.append(contents(place / FOLDER.output))
        for _ in range(count):
            both = [subprocess.Popen([*apart, ABBE, *words], cwd=place, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
                    for words in (FOLDER.older, FOLDER.newer)]
            for process in both:
                _, error = process.communicate()
                assert process.returncode == 0, error
            assert contents(place / FOLDER.output) in whole, "mixed results"
            left = [entry.name for entry in place.iterdir()]
            assert left == [FOLDER.output], f"left behind {left}"
    return count


def fit(points, output):
    return ["fit", str(points), "--shape", "cylinder", "-o", output]


bore = EXAMPLES / "fit" / "bore.csv"
FOLDER = Case("results", [*fit(bore, "results")], [*fit(bore, "results"), "--method", "minimum-zone"], True)
scan = EXAMPLES / "scan"
deviate = ["deviate", str(scan / "bracket-scan.csv"), str(scan / "bracket.stl"), "--transform",
           str(scan / "bracket-transform.csv"), "-o", "results", "--largest-mm"]
LONG_TEXT = Case("results", [*deviate, "0.3"], [*deviate, "0.2"], True)
piece = ["test-piece", "cone-frustum", "-o", "piece.csv", "--chord-um"]
FILE = Case("piece.csv", [*piece, "50"], [*piece, "20", "--force"], False)
NEW_FILE = Case("piece.csv", None, [*piece, "20"], False)
total = 0
for case in (FOLDER, LONG_TEXT, FILE, NEW_FILE):
    for kind in KINDS:
        for n in range(1, case.calls + 1):
            case.with_fault(f"{n}:{kind}")
            total += 1
total += same_process_numbers()
print(f"{total} faults, kills and meetings: nothing lost")
