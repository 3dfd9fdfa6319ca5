#!/usr/bin/python3
"""How far the tool of the hidden machine was from where it should be at the unseen hours, at the joints of LinuxCNC.

Usage: judge.py FOLDER PAGE.html

Exit code 1 if the goals are missed: the error (root mean square of the displacement of the functional point after the
best fit of the workpiece datum, one for all hours) has to be LEAST times smaller with geometric and thermal
compensation than with geometric compensation alone, and at most RATIO times its predicted standard uncertainty.
"""
import pathlib
import sys

import numpy as np
from day_figures import (LEAST, RATIO, REFERENCE, Course, factors_at, figures_of, read_lags, read_temperatures,
                         read_truth)
from days import TRAVEL, UNSEEN, Days
from hidden_mill import SENSORS
from hidden_pose import TOOL
from identified import Identified
from in_linuxcnc import EVERY_H, FACTOR, SAME_PLACE
from thermal_page import write_page

LARGEST_LAG_K, LARGEST_CORRECTION_UM = 0.5, 0.2  # differences of LinuxCNC from the equations


def read_runs(results):
    """The poses of all three cases: hours (of the thermal run), commands, joints by case, rows of the thermal run."""
    fast, day = np.loadtxt(results / "reached-geometric.txt"), np.loadtxt(results / "reached-thermal.txt")
    plain, geometric = fast[fast[:, 1] == 0], fast[fast[:, 1] == 1]
    count = len(day)
    for rows in (plain, geometric):
        if np.abs(rows[:count, 2:5] - day[:, 2:5]).max() > 1e-6:
            sys.exit("judge: the runs in LinuxCNC have different poses")
    if count < 0.95 * len(plain):
        sys.exit(f"judge: only {count} of {len(plain)} poses were reached before the day was over")
    if day[:, 9].min() < 1 or day[:, 1].min() < 1:
        sys.exit("judge: a thermometer had a flag, or the compensation was not on")
    joints = {"before": plain[:count, 5:8], "geometric": geometric[:count, 5:8], "thermal": day[:, 5:8]}
    return day[:, 0], day[:, 2:5], joints, day


def poses_of(readings):
    with open(readings, encoding="ascii") as file:
        return len({tuple(line.split(",")[:3]) for line in file}) - 1


def check_linuxcnc(identified, commands, joints, day, factors, names):
    """Largest difference from what is worked out here: lags (K), corrections at the states that were used (um)."""
    lags = max(np.abs(day[:, 10 + k] - REFERENCE - factors[name]).max() for k, name in enumerate(names))
    used = {name: day[:, 10 + k] - REFERENCE for k, name in enumerate((*names, *SENSORS))}
    expected = identified.by_parameters(commands, TOOL, used, TRAVEL) @ identified.values
    difference = 1e3 * np.abs(commands - joints - expected)
    return lags, difference.max()


def print_figures(figures):
    print(f"{figures['poses']} poses all over the travel, hours {UNSEEN[0]} to {UNSEEN[1]}, which are unseen")
    print("displacement of the functional point, root mean square (largest):")
    for case, words in (("before", "before"), ("geometric", "geometric compensation"),
                        ("thermal", "geometric and thermal compensation")):
        print(f"  {words:36s} {figures[case]:6.2f} um ({figures['largest'][case]:.1f} um)")
    print(f"  predicted standard uncertainty       {figures['predicted']:6.2f} um: {figures['parameters']:.2f} um of "
          f"the parameters, {figures['pose']:.2f} um of what no parameter explains (pose noise)")
    print(f"{figures['reduction']:.1f} times better than geometric compensation alone (goal {LEAST}); "
          f"{figures['ratio']:.2f} times the predicted uncertainty (goal at most {RATIO}); "
          f"{100 * figures['covered']:.0f} % of the poses within two of them")


def main():
    results, page = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    machine, seed = read_truth(results / "truth.npz")
    hours, commands, joints, day = read_runs(results)
    record_hours, temperatures = read_temperatures(results / "unseen.csv")
    identified, lags = Identified(results / "thermal"), read_lags(results / "day-mill.machine.toml")
    factors = factors_at(hours, record_hours, temperatures, lags)
    lag_off, correction_off = check_linuxcnc(identified, commands, joints["thermal"], day, factors, list(lags))

    anywhere = np.abs(commands - SAME_PLACE).max(axis=1) > 1e-6
    course = Course(machine, hours[anywhere], commands[anywhere], {k: v[anywhere] for k, v in joints.items()})
    same = Course(machine, hours[~anywhere], commands[~anywhere], {k: v[~anywhere] for k, v in joints.items()})
    figures, errors, predicted = figures_of(course, identified, {k: v[anywhere] for k, v in factors.items()})
    print(f"LinuxCNC against the equations: lags within {lag_off:.3f} K, corrections within {correction_off:.2f} um")
    print_figures(figures)
    write_page(page, {"figures": figures, "goals": (LEAST, RATIO), "days": Days(seed), "unseen": UNSEEN,
                      "sensors": SENSORS, "record": (record_hours, temperatures),
                      "trained_poses": poses_of(results / "readings.csv"),
                      "course": (course.hours, errors, predicted), "same": (same.hours, same.displacements),
                      "factor": FACTOR, "every_min": 60 * EVERY_H, "lag_off": lag_off,
                      "correction_off": correction_off})
    if lag_off > LARGEST_LAG_K or correction_off > LARGEST_CORRECTION_UM:
        sys.exit("judge: what LinuxCNC did is not what the identified errors say")
    if not figures["reached"]:
        sys.exit("judge: the goals are missed")


if __name__ == "__main__":
    main()
