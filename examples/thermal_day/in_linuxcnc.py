#!/usr/bin/python3
"""The unseen day in a real LinuxCNC: the poses without compensation and with the geometric one, then the whole day with
geometric and thermal compensation on an accelerated clock.

Usage: in_linuxcnc.py MODULE.so FOLDER. FOLDER holds geometric.abbec, thermal.abbec and unseen.csv; the rows of
reached-geometric.txt and reached-thermal.txt (drive_day.py) are written there. Exit code 77: skipped, and said why.
"""
import os
import pathlib
import shutil
import sys

import numpy as np
from campaign import random_commands
from day_figures import read_lags
from days import TRAVEL, UNSEEN

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "tests" / "linuxcnc"))
import module_run  # noqa: E402
from module_run import headless  # noqa: E402

DISPLAY = "drive_day.py"
FACTOR = 600  # a minute of the day takes 0.1 s; time constants and rates are scaled with it
EVERY_H = 1 / 12  # two poses: one anywhere in the travel, and one that is the same all day
SAME_PLACE = (380.0, 220.0, -230.0)
SPARE_MM = 1.0


def poses():
    """Rows: hour, X, Y, Z."""
    hours = np.arange(UNSEEN[0], UNSEEN[1] - EVERY_H / 2, EVERY_H) + EVERY_H / 4
    anywhere = random_commands(hours.size, np.random.default_rng(97))
    rows = [np.column_stack([hours, anywhere]),
            np.column_stack([hours + EVERY_H / 2, np.tile(SAME_PLACE, (hours.size, 1))])]
    together = np.vstack(rows)
    return together[np.argsort(together[:, 0])]


def run(folder, module, model, job, lines=(), settings=()):
    joints = [headless.Joint(letter, low - SPARE_MM, high + SPARE_MM, home=min(max(0.0, low), high),
                             world=module_run.WORLD) for letter, (low, high) in zip("XYZ", TRAVEL)]
    np.savetxt(folder / "poses.txt", poses(), fmt="%.9f")
    (folder / "tools.tbl").write_text("T1 P1 Z120 D6 ;the machine's tool\n")
    (folder / "driver.txt").unlink(missing_ok=True)
    module_run.configure(folder, HERE / DISPLAY, f"{module} model={folder}/{model}", joints, {"module": module, **job},
                         [["joint.0.motor-pos-cmd"]], settings=settings, lines=lines)
    print(module_run.run_to_its_end(folder, DISPLAY, 450).replace("DONE\n", ""), end="")
    return (folder / "reached.txt").read_text()


def thermal_run(folder, module, record, lags):
    """The temperatures come from a program beside the control, and all rates are those of a machine times FACTOR."""
    with open(record, encoding="ascii") as file:
        names = [name.removesuffix("_degC") for name in file.readline().strip().split(",")[1:]]
        first_min = float(file.readline().split(",")[0])
    lines = [f"loadusr -W {folder}/thermometers {folder}/unseen.csv {FACTOR}",
             *(f"net degC-{name} thermometers.{name} => {module}.state-{name}" for name in names)]
    settings = [f"states-hold-seconds {10 / FACTOR}", f"states-ramp-per-second {0.01 * FACTOR}",
                f"states-rate-um-per-second {10 * FACTOR}"]
    job = {"factor": FACTOR, "first_h": first_min / 60, "last_h": UNSEEN[1], "lags": lags, "channels": names}
    return run(folder, module, "thermal.abbec", job, lines, settings)


def main():
    module_file, results = sys.argv[1], pathlib.Path(sys.argv[2])
    with module_run.place_to_run(module_file, str(results)) as (folder, module):
        for name in ("geometric.abbec", "thermal.abbec", "unseen.csv"):
            shutil.copy(results / name, folder)
        shutil.copy(HERE / "thermometers", folder)
        os.chmod(folder / "thermometers", 0o755)
        (results / "reached-geometric.txt").write_text(run(folder, module, "geometric.abbec", {}))
        lags = list(read_lags(results / "day-mill.machine.toml"))
        (results / "reached-thermal.txt").write_text(thermal_run(folder, module, results / "unseen.csv", lags))


if __name__ == "__main__":
    main()
