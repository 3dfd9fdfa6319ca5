#!/usr/bin/env python3
"""The recipe of linuxcnc/README.md, followed in a real LinuxCNC. Exit code 77: skipped, and said why.

Usage: recipe_test.py ABBE MODULE.so SOURCE FOLDER. What is not installed for a test is replaced: the command, the name
of the module, the folder of the compensation, the screen.
"""
import json
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys

import module_run
from module_run import headless

DISPLAY = "recipe_drive.py"
INSTALLED = "/etc/linuxcnc/"


def steps(readme):
    """Commands of the section "Try it"."""
    section = readme.split("### Try it", 1)[1]
    block = re.search(r"```sh\n(.*?)```", section, re.DOTALL)[1]
    return [line.split(" # ")[0].strip() for line in block.splitlines()]


def one(lines, beginning):
    found = [line for line in lines if line.startswith(beginning)]
    if len(found) != 1:
        sys.exit(f"FAILED: the README has {len(found)} lines that begin with {beginning}")
    return found[0]


def replaced(path, changes):
    text = path.read_text()
    for old, new in changes:
        if old not in text:
            sys.exit(f"FAILED: {path.name} has no {old}")
        text = text.replace(old, new)
    return text


def main():
    abbe, module_file, source, place = sys.argv[1:5]
    source = pathlib.Path(source)
    lines = steps((source / "linuxcnc" / "README.md").read_text())
    one(lines, "make install install-linuxcnc")
    copied = shlex.split(one(lines, "cp -r"))[2]
    started = shlex.split(one(lines, "linuxcnc "))[1]
    with module_run.place_to_run(module_file, place) as (folder, module):
        freeze = shlex.split(one(lines, "abbe compensate freeze").replace(INSTALLED, f"{folder}/"))
        subprocess.run([abbe, *freeze[1:]], cwd=source, check=True, stdout=subprocess.DEVNULL)
        example = source / copied
        ini = example / pathlib.Path(started).name
        (folder / "job.json").write_text(json.dumps({"module": module}))
        module_run.copy_display_modules(folder)
        # Its cycles are counted, and its files have the names of every run here.
        counted = "loadrt integ\naddf integ.0 servo-thread\nsetp integ.0.in 1000\n"
        headless.write_configuration(
            folder, module_run.HERE / DISPLAY,
            replaced(ini, [("DISPLAY = axis", f"DISPLAY = ./{DISPLAY}"), ("= abbekins ", f"= {module} "),
                           (INSTALLED, f"{folder}/"), ("mill.hal", "run.hal"), ("mill.tbl", "run.tbl")]),
            replaced(example / "mill.hal", [("abbekins.", module + ".")]) + counted,
            tool_table=(example / "mill.tbl").read_text())
        os.chmod(folder / "mill.abbec", 0o644)
        module_run.run_to_its_end(folder, DISPLAY, 100)


main()
