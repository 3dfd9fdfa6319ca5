"""Runs of the kinematics module in a real LinuxCNC without a screen, each in a new folder.

The folder is below the given one (or the temporary one, where others may not look into it), because LinuxCNC refuses to
run as root and runs as `nobody`. Exit code 77: skipped, and said why.
"""
import contextlib
import json
import os
import pathlib
import shutil
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "linuxcnc"))
import headless  # noqa: E402

SKIPPED = 77
MODULES = pathlib.Path("/usr/lib/linuxcnc/modules")
WORLD = (-20000, 20000)  # mm, limits of X Y Z where they are not those of joints


def skip(why):
    print("skipped:", why)
    sys.exit(SKIPPED)


@contextlib.contextmanager
def module_installed(file):
    """The module in LinuxCNC's folder as long as this lasts; its name."""
    installed = MODULES / pathlib.Path(file).name
    try:
        shutil.copy(file, installed)
        os.chmod(installed, 0o644)
        yield installed.stem
    finally:
        installed.unlink(missing_ok=True)


@contextlib.contextmanager
def place_to_run(module_file, place):
    """A folder for LinuxCNC and the name of the module; skips the test where LinuxCNC cannot run."""
    if not pathlib.Path(module_file).exists():
        skip("the module is not built: linuxcnc-uspace-dev is not installed")
    if os.geteuid() != 0:
        skip("only root may install a module for LinuxCNC and run it as another user")
    started = time.monotonic()
    try:
        headless.check_installed()
        with headless.only_one(), headless.run_folder(place) as folder, module_installed(module_file) as module:
            headless.check_that_it_runs(folder)
            yield folder, module
    except headless.NotHere as why:
        skip(str(why))
    print(f"{time.monotonic() - started:.1f} s")


def copy_display_modules(folder):
    """What displays import besides linuxcnc/operating.py."""
    for name in ("at_rest.py", "display_job.py"):
        shutil.copy(HERE / name, folder)


def configure(folder, display, kinematics, joints, job, recorded, settings=(), lines=()):
    """The files of a run.

    @param display     its name in this folder, or where it stands
    @param kinematics  the module and its parameters
    @param recorded    for each recorder the pins that it records
    @param lines       further lines of the HAL file, once the module is loaded
    @param job         for the display: "module" and what it needs besides
    """
    module = kinematics.split()[0]
    lines = [*lines, *(f"setp {module}.{setting}" for setting in settings)]
    lines += [f"net tool-{axis} motion.tooloffset.{axis} => {module}.tooloffset-{axis}" for axis in "xyz"]
    (folder / "job.json").write_text(json.dumps(job))
    copy_display_modules(folder)
    headless.write_configuration(folder, HERE / display,
                                 headless.ini_text(pathlib.Path(display).name, kinematics, joints, velocity=20000),
                                 headless.hal_text(len(joints), recorded, lines),
                                 tool_table=(folder / "tools.tbl").read_text())


def run_to_its_end(folder, display, limit_s):
    """Runs LinuxCNC until the display has written DONE; what it wrote."""
    output, code = headless.run(folder, display, limit_s)
    log = folder / "driver.txt"
    seen = log.read_text() if log.exists() else ""
    if "DONE" not in seen:
        print(output, seen, sep="\n")
        sys.exit(f"FAILED: LinuxCNC ended before its work was done (exit code {code})")
    return seen
