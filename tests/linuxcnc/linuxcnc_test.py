#!/usr/bin/env python3
"""The kinematics module in a real LinuxCNC without a screen. Usage: linuxcnc_test.py CASE MODULE.so FOLDER

CASE is the program linuxcnc_case, MODULE.so the module built under its test name. Everything is done in a new folder
below FOLDER (or the temporary one, where others may not look into FOLDER), because LinuxCNC refuses to run as root and
runs as `nobody`. Exit code 77: skipped, and said why.
"""
import fcntl
import os
import pathlib
import pwd
import shutil
import signal
import subprocess
import sys
import tempfile
import time

SKIPPED = 77
USER = "nobody"
MODULES = pathlib.Path("/usr/lib/linuxcnc/modules")
LONGEST_S = 100


def skip(why):
    print("skipped:", why)
    sys.exit(SKIPPED)


def as_user(*words):
    return ["runuser", "-u", USER, "--", *words]


def run_folder(place):
    """A new folder that the user of LinuxCNC may use."""
    for parent in (os.path.abspath(place), tempfile.gettempdir()):
        # A socket of LinuxCNC stands in it, whose name may have 107 characters.
        if len(parent) > 75:
            continue
        os.makedirs(parent, exist_ok=True)
        folder = pathlib.Path(tempfile.mkdtemp(prefix="linuxcnc-", dir=parent))
        os.chmod(folder, 0o755)
        if subprocess.run(as_user("test", "-r", str(folder / ".")), check=False).returncode == 0:
            return folder
        shutil.rmtree(folder)
    skip("no folder that " + USER + " may read")


def ini_text(module, model):
    text = f"""[EMC]
VERSION = 1.1
DEBUG = 0
[DISPLAY]
DISPLAY = ./drive.py
[RS274NGC]
PARAMETER_FILE = test.var
SUBROUTINE_PATH = .
[EMCMOT]
EMCMOT = motmod
COMM_TIMEOUT = 20
SERVO_PERIOD = 1000000
[TASK]
TASK = milltask
CYCLE_TIME = 0.001
[HAL]
HALFILE = test.hal
[TRAJ]
COORDINATES = X Y Z A C
LINEAR_UNITS = mm
ANGULAR_UNITS = degree
DEFAULT_LINEAR_VELOCITY = 500
MAX_LINEAR_VELOCITY = 20000
MAX_LINEAR_ACCELERATION = 2000000
NO_FORCE_HOMING = 1
[EMCIO]
EMCIO = io
CYCLE_TIME = 0.01
TOOL_TABLE = test.tbl
[KINS]
KINEMATICS = {module} model={model}
JOINTS = 5
"""
    for joint, axis in enumerate("XYZAC"):
        kind = "ANGULAR" if axis in "AC" else "LINEAR"
        limit = 99999 if axis in "AC" else 3000
        rates = "MAX_VELOCITY = 20000\nMAX_ACCELERATION = 2000000"
        text += f"[AXIS_{axis}]\nMIN_LIMIT = -{limit}\nMAX_LIMIT = {limit}\n{rates}\n"
        text += f"[JOINT_{joint}]\nTYPE = {kind}\nHOME = 0\nHOME_SEQUENCE = 0\n{rates}\n"
        text += f"MIN_LIMIT = -{limit}\nMAX_LIMIT = {limit}\nFERROR = 3000\nMIN_FERROR = 3000\n"
    return text


def hal_text(module):
    lines = [
        "loadrt [KINS]KINEMATICS",
        "loadrt [EMCMOT]EMCMOT servo_period_nsec=[EMCMOT]SERVO_PERIOD num_joints=[KINS]JOINTS",
        "loadrt sampler depth=16384,16384 cfg=ffffff,ffffffffff",
        "loadrt integ",
        "addf motion-command-handler servo-thread",
        "addf motion-controller servo-thread",
        "addf integ.0 servo-thread",
        "addf sampler.0 servo-thread",
        "addf sampler.1 servo-thread",
        "setp integ.0.in 1",
        "setp sampler.0.enable 0",
        "setp sampler.1.enable 0",
        f"setp {module}.ramp-seconds 0.4",
    ]
    for j in range(5):
        lines.append(f"net j{j} joint.{j}.motor-pos-cmd => joint.{j}.motor-pos-fb sampler.0.pin.{j} sampler.1.pin.{j}")
    lines.append(f"net part {module}.enabled => sampler.0.pin.5")
    for k, axis in enumerate("xyzac"):
        lines.append(f"net w{axis} axis.{axis}.pos-cmd => sampler.1.pin.{k + 5}")
    for axis in "xyz":
        lines.append(f"net tool-{axis} motion.tooloffset.{axis} => {module}.tooloffset-{axis}")
    lines += [
        "net estop iocontrol.0.user-enable-out => iocontrol.0.emc-enable-in",
        "net prepare iocontrol.0.tool-prepare => iocontrol.0.tool-prepared",
        "net change iocontrol.0.tool-change => iocontrol.0.tool-changed",
        "loadusr halsampler -c 0 ramp.txt",
        "loadusr halsampler -c 1 program.txt",
    ]
    return "\n".join(lines) + "\n"


def linuxcnc(folder, module, model, limit_s):
    """Runs LinuxCNC until its display ends. Returns what it printed and its exit code (None: no time left)."""
    (folder / "test.ini").write_text(ini_text(module, folder / model))
    # Nothing of who runs the test: LinuxCNC keeps its files in HOME, and its Python modules are those of the system.
    clean = as_user("env", "-i", f"HOME={folder}", f"ABBEKINS={module}", "PATH=/usr/bin:/bin:/usr/sbin:/sbin", "LC_ALL=C")
    process = subprocess.Popen([*clean, "linuxcnc", "-r", "test.ini"], cwd=folder, text=True, stdout=subprocess.PIPE,
                               stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL, start_new_session=True)
    try:
        output, _ = process.communicate(timeout=limit_s)
        return output, process.returncode
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        output, _ = process.communicate()
        return output, None
    finally:
        # What a display that failed may leave behind keeps the next one from starting.
        subprocess.run([*clean, "halrun", "-U"], cwd=folder, check=False, timeout=30, stdout=subprocess.DEVNULL,
                       stderr=subprocess.DEVNULL, stdin=subprocess.DEVNULL)


def check_that_it_runs(folder):
    """Skips where LinuxCNC's own modules cannot be loaded either, such as in a container without shared memory."""
    (folder / "probe.hal").write_text("loadrt trivkins\nloadrt threads name1=probe period1=1000000\n")
    os.chmod(folder, 0o777)
    clean = as_user("env", "-i", f"HOME={folder}", "PATH=/usr/bin:/bin:/usr/sbin:/sbin", "LC_ALL=C")
    try:
        probe = subprocess.run([*clean, "halrun", "probe.hal"], cwd=folder, check=False, timeout=30, text=True,
                               stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    except subprocess.TimeoutExpired:
        skip("halrun does not end here")
    if probe.returncode != 0:
        skip("LinuxCNC's own modules do not run here:\n" + probe.stdout)


def test(case, folder, module):
    check_that_it_runs(folder)
    subprocess.run([case, "prepare", folder], check=True)
    shutil.copy(pathlib.Path(__file__).parent / "drive.py", folder / "drive.py")
    os.chmod(folder / "drive.py", 0o755)
    (folder / "test.hal").write_text(hal_text(module))
    (folder / "test.tbl").write_text("T1 P1 Z50.0 D6 ;end mill\n")
    (folder / "test.var").write_text("")
    subprocess.run(["chown", "-R", USER, str(folder)], check=True)

    output, code = linuxcnc(folder, module, "damaged.abbec", 40)
    if code == 0 or "its checksum is wrong" not in output or (folder / "driver.txt").exists():
        print(output)
        sys.exit("FAILED: LinuxCNC starts with a damaged file, or does not say why it does not")
    print("a damaged file: LinuxCNC does not start and says why")

    output, code = linuxcnc(folder, module, "mill.abbec", LONGEST_S)
    seen = (folder / "driver.txt").read_text() if (folder / "driver.txt").exists() else ""
    if "DONE" not in seen:
        print(output, seen, sep="\n")
        sys.exit(f"FAILED: LinuxCNC ended before its work was done (exit code {code})")
    if "outside map 1" not in seen or "inside map 1" not in seen:
        sys.exit("FAILED: the pin outside-map is wrong\n" + seen)
    judged = subprocess.run([case, "judge", folder], check=False)
    if judged.returncode != 0:
        print(seen)
        sys.exit(1)


def main():
    case, module_file, place = sys.argv[1:4]
    for program in ("linuxcnc", "halrun", "halsampler", "runuser"):
        if shutil.which(program) is None:
            skip(program + " is not installed")
    if not pathlib.Path(module_file).exists():
        skip("the module is not built: linuxcnc-uspace-dev is not installed")
    if os.geteuid() != 0:
        skip("only root may install a module for LinuxCNC and run it as another user")
    try:
        pwd.getpwnam(USER)
    except KeyError:
        skip("there is no user " + USER)
    module = pathlib.Path(module_file).stem
    installed = MODULES / (module + ".so")
    started = time.monotonic()
    # A second LinuxCNC on the machine would end the first.
    with open("/var/tmp/linuxcnc-ci.lock", "a", encoding="ascii") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        folder = run_folder(place)
        try:
            shutil.copy(module_file, installed)
            os.chmod(installed, 0o644)
            test(case, folder, module)
        finally:
            installed.unlink(missing_ok=True)
            shutil.rmtree(folder, ignore_errors=True)
    print(f"{time.monotonic() - started:.1f} s")


main()
