"""LinuxCNC 2.9 without a screen: its configuration, and one run of it until its display ends.

The display is a program of ours that operates the control (`operating.py` serves it). One LinuxCNC runs on a machine at
a time, because a second one ends the first; it refuses to run as root, and then runs as `nobody`.
"""
import contextlib
import dataclasses
import fcntl
import os
import pathlib
import pwd
import re
import shutil
import signal
import subprocess
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
USER = "nobody"
LOCK = pathlib.Path("/var/tmp/linuxcnc-ci.lock")
PROGRAMS_OF_LINUXCNC = {"milltask", "linuxcncsvr", "rtapi_app"}

# Simulated drives: full speed within a servo cycle, so that the path is that of the program and not of the drives.
VELOCITY = 1000  # mm/s, deg/s
ACCELERATION = 2000000  # mm/s^2, deg/s^2

LONGEST_END_S = 20  # LinuxCNC tidies up in two


class NotHere(Exception):
    """LinuxCNC cannot run on this machine, and why."""


@dataclasses.dataclass
class Joint:
    """An axis and its joint; limits in mm or degrees, None: none."""
    letter: str
    minimum: float | None = None
    maximum: float | None = None
    home: float = 0.0
    world: tuple[float, float] | None = None  # limits of the axis, where they are not those of the joint
    settings: list[str] = dataclasses.field(default_factory=list)  # further lines of its [JOINT_n]

    def rotary(self):
        return self.letter in "ABC"


def check_installed():
    """NotHere where LinuxCNC, or a user that it accepts, is missing."""
    needed = ["linuxcnc", "halrun"]
    if os.geteuid() == 0:
        needed.append("runuser")
        try:
            pwd.getpwnam(USER)
        except KeyError as missing:
            raise NotHere("there is no user " + USER) from missing
    for program in needed:
        if shutil.which(program) is None:
            raise NotHere(f"{program} is not installed (Debian: linuxcnc-uspace)")


def as_user(*words):
    """The command as a user that LinuxCNC accepts."""
    return ["runuser", "-u", USER, "--", *words] if os.geteuid() == 0 else list(words)


def cleanly(folder, *words):
    """The command with nothing of who runs it: LinuxCNC keeps files in HOME, and its Python is that of the system."""
    return as_user("env", "-i", f"HOME={folder}", "PATH=/usr/bin:/bin:/usr/sbin:/sbin", "LC_ALL=C.UTF-8", *words)


@contextlib.contextmanager
def only_one(waiting=lambda: None):
    """Waits until no other run of ours goes on; `waiting` is called if there is one.

    NotHere if a LinuxCNC runs that is not ours: starting another would end it.
    """
    # Everybody's file, whoever came first; a system may forbid to create it a second time.
    if not LOCK.exists():
        mask = os.umask(0)
        with contextlib.suppress(FileExistsError):
            os.close(os.open(LOCK, os.O_CREAT | os.O_EXCL | os.O_RDONLY, 0o666))
        os.umask(mask)
    with open(LOCK, encoding="ascii") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            waiting()
            fcntl.flock(lock, fcntl.LOCK_EX)
        running = running_linuxcnc(ending_s=5)
        if running:
            raise NotHere(f"LinuxCNC is running (process {running[0]}), and a second one would end it")
        yield


def running_linuxcnc(ending_s=0):
    """Process numbers of a LinuxCNC that runs, and does not end in so many seconds."""
    end_of_waiting = time.monotonic() + ending_s
    while (found := linuxcnc_processes()) and time.monotonic() < end_of_waiting:
        time.sleep(0.1)
    return found


def linuxcnc_processes():
    found = []
    for process in pathlib.Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):
            name, state = (process / "stat").read_text(encoding="utf-8", errors="replace").split("(")[1].split(") ")[:2]
            if name in PROGRAMS_OF_LINUXCNC and not state.startswith("Z"):  # Z: has ended
                found.append(int(process.name))
    return sorted(found)


@contextlib.contextmanager
def run_folder(place=None):
    """A new folder that the user of LinuxCNC may use, removed at the end: below `place` or the temporary folder."""
    for parent in ([os.path.abspath(place)] if place else []) + [tempfile.gettempdir(), "/tmp"]:
        # A socket of LinuxCNC stands in it, whose name may have 107 characters.
        if len(parent) > 75:
            continue
        os.makedirs(parent, exist_ok=True)
        folder = pathlib.Path(tempfile.mkdtemp(prefix="linuxcnc-", dir=parent))
        try:
            os.chmod(folder, 0o755)
            if subprocess.run(as_user("test", "-r", str(folder / ".")), check=False).returncode == 0:
                yield folder
                return
        finally:
            shutil.rmtree(folder, ignore_errors=True)
    raise NotHere("no folder that " + USER + " may read")


def check_that_it_runs(folder):
    """NotHere where LinuxCNC's own modules cannot be loaded either, such as in a container without shared memory."""
    (folder / "probe.hal").write_text("loadrt trivkins\nloadrt threads name1=probe period1=1000000\n")
    os.chmod(folder, 0o777)
    try:
        probe = subprocess.run(cleanly(folder, "halrun", "probe.hal"), cwd=folder, check=False, timeout=30, text=True,
                               stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    except subprocess.TimeoutExpired as late:
        raise NotHere("halrun does not end here") from late
    if probe.returncode != 0:
        raise NotHere("LinuxCNC's own modules do not run here:\n" + probe.stdout)


def ini_text(display, kinematics, joints, period_us=1000, velocity=VELOCITY):
    """Configuration: metric, without homing switches; an axis and a joint for each of `joints`."""
    letters = "".join(joint.letter for joint in joints)
    text = f"""[EMC]
VERSION = 1.1
DEBUG = 0
[DISPLAY]
DISPLAY = ./{display}
[RS274NGC]
PARAMETER_FILE = run.var
SUBROUTINE_PATH = .
[EMCMOT]
EMCMOT = motmod
COMM_TIMEOUT = 20
SERVO_PERIOD = {1000 * period_us}
[TASK]
TASK = milltask
CYCLE_TIME = 0.001
[HAL]
HALFILE = run.hal
[TRAJ]
COORDINATES = {" ".join(letters)}
LINEAR_UNITS = mm
ANGULAR_UNITS = degree
DEFAULT_LINEAR_VELOCITY = {velocity / 2}
MAX_LINEAR_VELOCITY = {velocity}
MAX_LINEAR_ACCELERATION = {ACCELERATION}
NO_FORCE_HOMING = 1
[EMCIO]
EMCIO = io
CYCLE_TIME = 0.01
TOOL_TABLE = run.tbl
[KINS]
KINEMATICS = {kinematics}
JOINTS = {len(joints)}
"""
    drive = [f"MAX_VELOCITY = {velocity}", f"MAX_ACCELERATION = {ACCELERATION}"]
    for number, joint in enumerate(joints):
        limits = (joint.minimum, joint.maximum)
        text += "\n".join([f"[AXIS_{joint.letter}]", *drive, *limit_lines(*(joint.world or limits))]) + "\n"
        lines = [f"TYPE = {'ANGULAR' if joint.rotary() else 'LINEAR'}", f"HOME = {joint.home:.9f}",
                 f"HOME_OFFSET = {joint.home:.9f}", "HOME_SEQUENCE = 0", "FERROR = 3000", "MIN_FERROR = 3000"]
        text += "\n".join([f"[JOINT_{number}]", *drive, *limit_lines(*limits), *lines, *joint.settings]) + "\n"
    return text


def limit_lines(minimum, maximum):
    named = (("MIN_LIMIT", minimum), ("MAX_LIMIT", maximum))
    return [f"{name} = {value:.9f}" for name, value in named if value is not None]


def hal_text(joint_count, recorded, lines=(), period_us=1000, wired=()):
    """Wiring: drives that are where they shall be, tools that are changed at once, and `lines`.

    @param recorded  for each recorder (operating.Recorder, by number) the float output pins that it records
    @param wired     further pairs of an output pin and an input pin
    """
    sinks = {f"joint.{j}.motor-pos-cmd": [f"joint.{j}.motor-pos-fb"] for j in range(joint_count)}
    sinks |= {"iocontrol.0.user-enable-out": ["iocontrol.0.emc-enable-in"],
              "iocontrol.0.tool-prepare": ["iocontrol.0.tool-prepared"],
              "iocontrol.0.tool-change": ["iocontrol.0.tool-changed"],
              "spindle.0.speed-out-rps": ["spindle.0.speed-in"]}
    for number, pins in enumerate(recorded):
        for k, pin in enumerate(pins):
            sinks.setdefault(pin, []).append(f"sampler.{number}.pin.{k}")
    for source, sink in wired:
        sinks.setdefault(source, []).append(sink)
    depths = ",".join("16384" for _ in recorded)
    kinds = ",".join("f" * len(pins) for pins in recorded)
    text = ["loadrt [KINS]KINEMATICS",
            "loadrt [EMCMOT]EMCMOT servo_period_nsec=[EMCMOT]SERVO_PERIOD num_joints=[KINS]JOINTS",
            f"loadrt sampler depth={depths} cfg={kinds}",
            "loadrt integ",  # counts servo cycles
            "addf motion-command-handler servo-thread",
            "addf motion-controller servo-thread",
            "addf integ.0 servo-thread",
            f"setp integ.0.in {1e6 / period_us}"]
    for number in range(len(recorded)):
        text += [f"addf sampler.{number} servo-thread", f"setp sampler.{number}.enable 0"]
    text += lines
    text += [f"net s{k} {pin} => {' '.join(ends)}" for k, (pin, ends) in enumerate(sinks.items())]
    return "\n".join(text) + "\n"


def write_configuration(folder, display, ini, hal, tool_table="", parameters=""):
    """The files of a run, and the display (a file) with what it is built on."""
    (folder / "run.ini").write_text(ini)
    (folder / "run.hal").write_text(hal)
    (folder / "run.tbl").write_text(tool_table)
    (folder / "run.var").write_text(parameters)
    shutil.copy(HERE / "operating.py", folder)
    shutil.copy(display, folder)
    os.chmod(folder / pathlib.Path(display).name, 0o755)
    if os.geteuid() == 0:
        subprocess.run(["chown", "-R", USER, str(folder)], check=True)


def processes_of(folder):
    """Processes of the run in `folder`, which is the HOME of these and of no others: number and command line."""
    home = f"HOME={folder}".encode()
    for process in pathlib.Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):
            if home in (process / "environ").read_bytes().split(b"\0"):
                yield int(process.name), (process / "cmdline").read_bytes().split(b"\0")


def sign_of_running():
    """The file by which LinuxCNC knows that it runs, as its launcher names it. OSError if it does not."""
    launcher = pathlib.Path(shutil.which("linuxcnc") or "linuxcnc").read_text(encoding="utf-8", errors="replace")
    named = re.search(r"^LOCKFILE=(\S+)$", launcher, re.MULTILINE)
    if named is None:
        raise FileNotFoundError("no LOCKFILE in the launcher of LinuxCNC")
    return pathlib.Path(named[1])


def end_run(folder, display, process):
    """Ends the run in `folder`: its display, so that LinuxCNC tidies up, or all of it if that does not help."""
    for number, words in list(processes_of(folder)):
        if f"./{display}".encode() in words or b"/usr/bin/linuxcnc" in words:
            with contextlib.suppress(OSError):
                os.kill(number, signal.SIGTERM)
    try:
        process.wait(LONGEST_END_S)
    except subprocess.TimeoutExpired:
        for number, _ in list(processes_of(folder)):
            with contextlib.suppress(OSError):
                os.kill(number, signal.SIGKILL)
        process.wait()
        with contextlib.suppress(OSError):
            sign_of_running().unlink()


def run(folder, display, limit_s, each=lambda: None):
    """Runs LinuxCNC on what write_configuration() wrote until its display ends; `each` is called now and then.

    @return what it printed, and its exit code (None: no time left)
    """
    with open(folder / "printed.txt", "w+", encoding="utf-8", errors="replace") as printed:
        process = subprocess.Popen(cleanly(folder, "linuxcnc", "-r", "run.ini"), cwd=folder, stdout=printed,
                                   stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL, start_new_session=True)
        end = time.monotonic() + limit_s
        try:
            while process.poll() is None and time.monotonic() < end:
                time.sleep(0.05)
                each()
        finally:
            code = process.poll()
            if code is None:
                end_run(folder, display, process)
            # What a display that failed may leave behind keeps the next one from starting.
            subprocess.run(cleanly(folder, "halrun", "-U"), cwd=folder, check=False, timeout=30,
                           stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, stdin=subprocess.DEVNULL)
        printed.seek(0)
        return printed.read(), code
