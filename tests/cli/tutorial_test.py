#!/usr/bin/env python3
"""docs/tutorial.md, followed as it stands. Usage: tutorial_test.py ABBE TUTORIAL FOLDER

A block of a file is saved under the name given before it ("Save this as `NAME`"); blocks of commands are run in order in an
empty folder and must end with exit code 0; every line of a block of text must be in what the commands before it printed.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys


def main():
    abbe, tutorial, folder = (pathlib.Path(argument).resolve() for argument in sys.argv[1:4])
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    environment = dict(os.environ, PATH=f"{abbe.parent}:{os.environ['PATH']}")
    text = tutorial.read_text(encoding="utf-8")
    printed, commands, files, shown = "", 0, 0, 0
    end = 0
    for block in re.finditer(r"^```(\w+)\n(.*?)^```$", text, re.S | re.M):
        before, end = text[end:block.start()], block.end()
        kind, body = block.groups()
        if kind == "sh":
            for line in body.splitlines():
                run = subprocess.run(["bash", "-c", line], cwd=folder, env=environment, capture_output=True, text=True)
                printed = run.stdout if line == body.splitlines()[0] else printed + run.stdout
                if run.returncode != 0 or run.stderr:
                    sys.exit(f"{line}\nended with {run.returncode}: {run.stderr}")
                commands += 1
        elif kind == "text":
            for line in body.splitlines():
                if line not in printed:
                    sys.exit(f"'{line}' is not in what was printed:\n{printed}")
                shown += 1
        else:
            (name,) = re.findall(r"Save this as `([^`]+)`", before)
            (folder / name).write_text(body, encoding="utf-8")
            files += 1
    # A tutorial that is no longer understood must not pass as an empty one.
    if commands < 8 or files < 3 or shown < 5:
        sys.exit(f"only {commands} commands, {files} files and {shown} lines of output were found")
    for name in ("rehearsal/report.html", "part-compensated.ngc", "tables/X.comp", "cec.spf", "verify.html"):
        if not (folder / name).stat().st_size:
            sys.exit(f"{name} is empty")


main()
