"""Inside LinuxCNC: the job of a display, from files of the current folder to files of it."""
import json
import sys

from operating import Operation, Stopped


def do_job(drive, limit_s):
    """Calls drive(operation, job, say) with what is in job.json. What it says is in driver.txt, at the end DONE or why not."""
    with open("job.json", encoding="ascii") as file, open("driver.txt", "w", buffering=1, encoding="utf-8") as log:
        try:
            drive(Operation(limit_s), json.load(file), lambda text: log.write(text + "\n"))
        except Stopped as why:
            log.write(f"FAILED {why}\n")
            sys.exit(1)
        log.write("DONE\n")


def numbers(name):
    with open(name, encoding="ascii") as file:
        return [[float(value) for value in line.split()] for line in file]


def write(name, rows):
    with open(name, "w", encoding="ascii") as out:
        out.writelines(" ".join(f"{value:.17g}" for value in row) + "\n" for row in rows)
