#!/usr/bin/env python3
"""A page of docs/ followed as it stands. Usage: page_test.py ABBE PAGE FOLDER COMMANDS FILES LINES [WRITTEN ...]

Saves each block of a file under the name given before it ("Save this as `NAME`"). Runs each line of a block of commands
in an empty folder; it must end with exit code 0 and must not complain. Every line of a block of text must be in what
the block of commands before it printed. The page must have at least COMMANDS commands, FILES files and LINES lines of
text, so that a page that is no longer understood does not pass as an empty one. Its commands must have written the
files WRITTEN.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys


def run_commands(body, folder, environment):
    printed = ""
    for line in body.splitlines():
        run = subprocess.run(["bash", "-c", line], cwd=folder, env=environment, capture_output=True, text=True)
        printed += run.stdout
        if run.returncode != 0 or run.stderr:
            sys.exit(f"{line}\nended with {run.returncode}: {run.stderr}")
    return printed


def main():
    abbe, page, folder = (pathlib.Path(argument).resolve() for argument in sys.argv[1:4])
    least = [int(argument) for argument in sys.argv[4:7]]
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    environment = dict(os.environ, PATH=f"{abbe.parent}:{os.environ['PATH']}")
    text = page.read_text(encoding="utf-8")
    printed, commands, files, shown, end = "", 0, 0, 0, 0
    for block in re.finditer(r"^```(\w+)\n(.*?)^```$", text, re.S | re.M):
        before, end = text[end:block.start()], block.end()
        kind, body = block.groups()
        if kind == "sh":
            printed = run_commands(body, folder, environment)
            commands += len(body.splitlines())
        elif kind == "text":
            for line in body.splitlines():
                if line not in printed:
                    sys.exit(f"'{line}' is not in what was printed:\n{printed}")
                shown += 1
        else:
            (name,) = re.findall(r"Save this as\s+`([^`]+)`", before)
            (folder / name).write_text(body, encoding="utf-8")
            files += 1
    if any(found < wanted for found, wanted in zip((commands, files, shown), least)):
        sys.exit(f"only {commands} commands, {files} files and {shown} lines of output were found, not {least}")
    for name in sys.argv[7:]:
        if not (folder / name).is_file() or not (folder / name).stat().st_size:
            sys.exit(f"{name} is missing or empty")


main()
