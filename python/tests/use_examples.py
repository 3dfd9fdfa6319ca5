"""Examples of the repository, and the command beside the package, for tests that compare both."""

import functools
import json
import os
import pathlib
import subprocess

import abbe

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
EXAMPLES = ROOT / "examples"
BUILD = pathlib.Path(abbe.__file__).absolute().parent.parent.parent
COMMAND = os.environ.get("ABBE_COMMAND", str(BUILD / "bin" / "abbe"))


def command(arguments, folder, exit_code=0, timeout=120):
    """What the command prints on standard output."""
    ran = subprocess.run([COMMAND, *map(str, arguments)], cwd=folder, capture_output=True, text=True, timeout=timeout)
    assert ran.returncode == exit_code, ran.stderr
    return ran.stdout


def command_json(arguments, folder, exit_code=0):
    return json.loads(command([*arguments, "--json", "--force"], folder, exit_code))


@functools.cache
def machine(name):
    return abbe.Machine.read(EXAMPLES / "machines" / f"{name}.machine.toml")


@functools.cache
def _errors(file, name):
    return abbe.Errors.read(EXAMPLES / file, machine(name))


def mill():
    return _errors("compensate/mill.errors.toml", "three-axis-mill").copy()


def trunnion():
    return _errors("compensate/trunnion.errors.toml", "trunnion-mill").copy()
