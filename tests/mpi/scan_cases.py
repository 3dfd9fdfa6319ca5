"""As several_processes.py, for figures of deviations, for registrations, and for processes with other scans."""

import array
import os
import signal
import subprocess
import sys
import time

from several_processes import (TIMES, deviate_words, main, ranks_of, require, require_same_results, scan_of_part)


def deviation_figures(runs):
    """Of a scan that is read in pieces, in every kind of file, and of tables that are not: figures alone, and files."""
    lines = (runs.examples / "scan/bracket-scan.csv").read_text().splitlines()
    rows = [line for line in lines if line[0] not in "#x"] * 40
    numbers = array.array("f", (float(word) for row in rows for word in row.split(",")))
    header = f"FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH {len(rows)}\nHEIGHT 1\nPOINTS {len(rows)}\n"
    contents = {"scan.csv": "x_mm,y_mm,z_mm\n" + "\n".join(rows) + "\n",
                "scan.xyz": "\n".join(rows).replace(",", " ") + "\n",
                "other.csv": "x_mm;y_mm;z_mm\n" + "\n".join(rows).replace(",", ";") + "\n"}
    for name, text in contents.items():
        (runs.out / name).write_text(text)
    (runs.out / "scan.pcd").write_bytes(f"VERSION .7\n{header}DATA binary\n".encode() + numbers.tobytes())
    scan_of_part(runs, "scan.ply", 100)
    for name in (*contents, "scan.pcd", "scan.ply"):
        words = deviate_words(runs, runs.out / name, "--json")
        at = words.index("-o")
        words = words[:at] + words[at + 2:]
        alone = runs.alone(*words)
        require(alone.returncode == 0 and '"p95"' in alone.stdout, name, alone.stderr)
        for processes, threads in TIMES if name == "scan.ply" else TIMES[3::4]:
            done = runs.together(processes, *words, *threads) if processes else runs.alone(*words, *threads)
            require(done.returncode == 0 and done.stdout == alone.stdout, name, processes, threads, done.stderr)
        require_same_results(runs, deviate_words(runs, runs.out / name), (*TIMES[:1], *TIMES[3::4]))


def run_with_other_file(runs, words, scan, other):
    """The job where the second process is given another scan."""
    script = runs.out / "abbe"
    mine, theirs = (" ".join(f"'{file if word == scan else word}'" for word in words) for file in (scan, other))
    script.write_text(f'#!/bin/sh\nif [ "$OMPI_COMM_WORLD_RANK" = 1 ]; then exec "{runs.abbe}" {theirs}; fi\n'
                      f'exec "{runs.abbe}" {mine}\n')
    script.chmod(0o755)
    return subprocess.run([runs.mpirun, "-n", "2", script], capture_output=True, text=True, env=runs.environment())


def scan_with_another_bit(runs, name, copies):
    other = scan_of_part(runs, name, copies)
    content = bytearray(other.read_bytes())
    content[-1] ^= 1  # a sign or an exponent of the last number
    other.write_bytes(content)
    return other


def deviations_of_other_files(runs):
    """A process whose scan is another one is found out, in memory and in blocks, with files and with figures alone."""
    scan, other = scan_of_part(runs, "scan.ply", 100), scan_with_another_bit(runs, "other.ply", 100)
    words = deviate_words(runs, scan)
    at = words.index("-o")
    for asked in (words, (*words, "--stream-above", 1000), words[:at] + words[at + 2:]):
        done = run_with_other_file(runs, asked, scan, other)
        require(done.returncode == 2 and "of another problem" in done.stderr, asked, done.returncode, done.stderr)
        require(not (runs.out / "results").exists(), "results were written")
    same = scan_of_part(runs, "same.ply", 100)
    os.utime(same, (1, 1))
    done = run_with_other_file(runs, words[:at] + words[at + 2:], scan, same)
    require(done.returncode == 0, "a copy with another time of change:", done.stderr)


def register_words(runs, scan, *more):
    return ("register", scan, runs.examples / "scan/bracket.stl", "-o", runs.out / "results", *more)


def registrations(runs):
    """The pose of a scan, its covariance, and the scan on its part, for up to 5 processes; also of few points."""
    scan = scan_of_part(runs, "scan.ply", 60)
    require_same_results(runs, register_words(runs, scan),
                         tuple((processes, ("--threads", 1 + processes % 2)) for processes in range(6)))
    require_same_results(runs, register_words(runs, runs.examples / "scan/bracket-scan.csv"), TIMES[::4])


def registrations_of_other_files(runs):
    """A process whose scan or part is another one is found out."""
    scan, other = scan_of_part(runs, "scan.ply", 60), scan_with_another_bit(runs, "other.ply", 60)
    part = runs.examples / "scan/bracket.stl"
    for mine, theirs in ((scan, other), (part, runs.examples / "scan/pin.stl")):
        done = run_with_other_file(runs, register_words(runs, scan), mine, theirs)
        require(done.returncode == 2 and "expected the same program and the same files" in done.stderr, theirs,
                done.returncode, done.stderr)
        require(not (runs.out / "results").exists(), "results were written")


def registration_without_a_process(runs):
    """A process that is killed during a registration ends the job without results; the next one has the same bytes."""
    scan = scan_of_part(runs, "scan.ply", 600)
    words = register_words(runs, scan, "--threads", 1)
    job = subprocess.Popen([runs.mpirun, "-n", "2", str(runs.abbe), *map(str, words)],
                           stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=runs.environment())
    begin = time.monotonic()
    while len(ranks_of(job, str(scan))) < 2 or time.monotonic() - begin < 2:
        require(job.poll() is None, "the job ended before it was disturbed")
        time.sleep(0.01)
    os.kill(max(ranks_of(job, str(scan))), signal.SIGKILL)
    _, errors = job.communicate(timeout=120)
    require(job.returncode != 0 and "signal 9" in errors, job.returncode, errors)
    require(not (runs.out / "results").exists(), "results of a killed run")
    require_same_results(runs, words, ((0, ()), (2, ())))


CASES = {"DeviationFigures": deviation_figures, "DeviationsOfOtherFiles": deviations_of_other_files,
         "Registrations": registrations, "RegistrationsOfOtherFiles": registrations_of_other_files,
         "RegistrationWithoutAProcess": registration_without_a_process}

if __name__ == "__main__":
    sys.exit(main(CASES))
