#!/usr/bin/env python3
"""Faults while many readings or points are read: nothing is lost, nothing is counted twice.

    input_faults_test.py CASE ABBE SLOW_READS.so EXAMPLES FOLDER

SlowReader: readings in files and points on standard input come in parts, and calls are interrupted; the results have
the same bytes. (Files that are read whole are mapped into memory, where the kernel waits for the disk.)
DamagedReadings: a file that is cut off, and one that is there twice, are refused by name.
FullDisk: a file system of 48 KiB, or a limit of the size of files; nothing half done, older results stay.
KilledDeviation: `abbe deviate` killed while it reads a scan in blocks goes on with the same bytes; a second one on the
same output is refused meanwhile.
"""
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import time

if len(sys.argv) != 6:
    sys.exit(__doc__)
CASE, ABBE, SLOW = sys.argv[1:4]
EXAMPLES, FOLDER = map(pathlib.Path, sys.argv[4:6])
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "mpi"))
from several_processes import files_of, require, study_of_files  # noqa: E402


class Here:
    examples, out = EXAMPLES, FOLDER

    @staticmethod
    def alone(*words, **more):
        return subprocess.run([ABBE, *map(str, words)], capture_output=True, text=True, check=False, **more)


def slow_reader():
    study = study_of_files(Here, 6)
    points = (EXAMPLES / "fit/bore.csv").read_text()
    for words, given in ((["run", study, "-o", FOLDER / "results"], ""),
                         (["fit", "-", "--shape", "cylinder", "-o", FOLDER / "results"], points)):
        quick = Here.alone(*words, input=given)
        require(quick.returncode in (0, 1), quick.stderr)
        expected = files_of(FOLDER / "results")
        shutil.rmtree(FOLDER / "results")
        count = FOLDER / "count"
        slow = Here.alone(*words, input=given, env={**os.environ, "LD_PRELOAD": SLOW, "ABBE_SLOW_COUNT": str(count)})
        require(slow.returncode == quick.returncode and slow.stdout == quick.stdout, words, slow.stderr)
        require(int(count.read_text()) > (1 if given else 100), words, "hardly a call was slow:", count.read_text())
        require(files_of(FOLDER / "results") == expected, words, "has other bytes with a slow disk")
        shutil.rmtree(FOLDER / "results")


def damaged_readings():
    study = study_of_files(Here, 6)
    first, second = FOLDER / "first.csv", FOLDER / "second.csv"
    whole = second.read_bytes()
    for content, expected in ((whole[:-3], "ends within a row"), (first.read_bytes(), "has the same content as"),
                              (None, "is given twice"), (b"", "is empty")):
        second.unlink(missing_ok=True)
        if content is None:
            second.hardlink_to(first)
        else:
            second.write_bytes(content)
        done = Here.alone("run", study, "-o", FOLDER / "results")
        require(done.returncode == 2, expected, done.returncode, done.stderr)
        require("second.csv" in done.stderr and expected in done.stderr, done.stderr)
        require(not (FOLDER / "results").exists(), "results of", expected)
    second.unlink()
    second.write_bytes(whole)
    done = Here.alone("run", study, "-o", FOLDER / "results")
    require(done.returncode in (0, 1) and files_of(FOLDER / "results"), done.stderr)


def on_a_full_disk(words, place):
    """Runs the command with `place` on a small file system, or with a limit of the size of files; what is left."""
    script = ('mount -t tmpfs -o size=48k none "$0" 2>/dev/null || exit 99; cd "$0"; '
              '"$@" -o older >/dev/null 2>&1; rm -r older; echo kept >note.txt; "$@" -o results >&2; code=$?; '
              'find . -type f; exit $code')
    small = subprocess.run(["unshare", "-m", "sh", "-c", script, place, ABBE, *map(str, words)], capture_output=True,
                           text=True, check=False)
    if "unshare" not in small.stderr and small.returncode != 99:
        print("on a file system of 48 KiB")
        return small
    print("with a limit of the size of files (no right to mount)")
    script = 'cd "$0"; echo kept >note.txt; ulimit -f 32; "$@" -o results >&2; code=$?; find . -type f; exit $code'
    return subprocess.run(["sh", "-c", script, place, ABBE, *map(str, words)], capture_output=True, text=True, check=False)


def full_disk():
    words = ["deviate", EXAMPLES / "scan/pin-scan.csv", EXAMPLES / "scan/pin.stl", "--transform",
             EXAMPLES / "scan/pin-transform.csv"]
    for more in ([], ["--stream-above", "500"]):
        place = FOLDER / ("disk" + "".join(more))
        place.mkdir()
        done = on_a_full_disk(words + more, place)
        require(done.returncode == 2, "exit code", done.returncode, done.stderr)
        require("No space left" in done.stderr or "File too large" in done.stderr, done.stderr)
        require(sorted(done.stdout.split()) == ["./note.txt"], "left over:", done.stdout)
        require(Here.alone(*words, *more, "-o", FOLDER / "results").returncode == 0, "with space")
        shutil.rmtree(FOLDER / "results")


def long_scan(rows):
    """The scan of the pin many times over, so that reading it takes a few seconds on one thread."""
    header = [line for line in (EXAMPLES / "scan/pin-scan.csv").read_text().splitlines(True)]
    start = next(k for k, line in enumerate(header) if line.startswith("x_mm"))
    body = "".join(header[start + 1:])
    path = FOLDER / "scan.csv"
    with path.open("w", encoding="ascii") as out:
        out.write(header[start])
        for _ in range(rows // body.count("\n")):
            out.write(body)
    return path


def killed_deviation():
    words = ["deviate", long_scan(3_000_000), EXAMPLES / "scan/pin.stl", "--transform",
             EXAMPLES / "scan/pin-transform.csv", "--stream-above", "1000", "--threads", "1", "-o"]
    out, kept = FOLDER / "results", FOLDER / "results.unfinished"
    whole = Here.alone(*words, FOLDER / "whole")
    require(whole.returncode == 0, whole.stderr)
    expected = files_of(FOLDER / "whole")
    require(len(expected) > 3, "few files:", list(expected))
    job = subprocess.Popen([ABBE, *map(str, words), str(out)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    # Blocks are kept from the third second on. It stands still for that long, so that the next one is written.
    time.sleep(0.3)
    require(job.poll() is None, "the work ended before it was disturbed")
    job.send_signal(signal.SIGSTOP)
    time.sleep(2.5)
    job.send_signal(signal.SIGCONT)
    while not kept.exists() or kept.stat().st_size < 100:
        require(job.poll() is None, "the work ended before it was disturbed")
        time.sleep(0.002)
    job.send_signal(signal.SIGSTOP)
    second = Here.alone(*words, out)
    require(second.returncode == 2 and "another process works on these results" in second.stderr, second.stderr)
    job.kill()
    job.communicate()
    require(job.returncode == -signal.SIGKILL, job.returncode)
    require(not out.exists(), "results of a killed run")
    done = Here.alone(*words, out)
    require(done.returncode == 0 and "are taken from" in done.stderr, done.stderr)
    require(files_of(out) == expected, "other bytes after a kill")
    require(done.stdout.replace(str(out), "") == whole.stdout.replace(str(FOLDER / "whole"), ""), done.stdout)
    require(not kept.exists(), "left over after the results are whole")


shutil.rmtree(FOLDER, ignore_errors=True)
FOLDER.mkdir(parents=True)
{"SlowReader": slow_reader, "DamagedReadings": damaged_readings, "FullDisk": full_disk,
 "KilledDeviation": killed_deviation}[CASE]()
shutil.rmtree(FOLDER)
