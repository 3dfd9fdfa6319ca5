#!/usr/bin/python3
"""How far the tool of the hidden machine was from where it should be at the unseen hours, at the joints of LinuxCNC.

Usage: judge.py FOLDER PAGE.html

Exit code 1 if the goals are missed: the error (root mean square of the displacement of the functional point after the
best fit of the workpiece datum, one for all hours) has to be LEAST times smaller with geometric and thermal
compensation than with geometric compensation alone, and at most RATIO times its predicted standard uncertainty.
"""
import csv
import pathlib
import sys

import numpy as np
from days import TRAVEL, UNSEEN, Days
from hidden_mill import SENSORS
from hidden_pose import TOOL, Geometry, HiddenPoses, nominal
from identified import Identified, lag, rigid_motions
from in_linuxcnc import EVERY_H, FACTOR, LAGS, SAME_PLACE
from thermal_page import write_page

LEAST, RATIO = 10, 1.5
REFERENCE = 20.0
TIME_CONSTANTS = dict(zip(LAGS, (("nut_x", 2400), ("nut_y", 2400), ("head", 5400), ("ambient", 7200))))


def read_temperatures(path):
    with open(path, encoding="ascii") as file:
        names, *rows = list(csv.reader(file))
    values = np.array(rows, float)
    return values[:, 0] / 60, {name.removesuffix("_degC"): values[:, k] for k, name in enumerate(names) if k > 0}


def without_datum(displacements, points):
    """Displacements after the best fit of the workpiece datum, and the projection that does it."""
    motions = np.linalg.qr(rigid_motions(points))[0]
    flat = displacements.ravel()
    return (flat - motions @ (motions.T @ flat)).reshape(-1, 3), motions


class Course:
    """Poses of one kind, the same for all three cases; errors in um."""

    def __init__(self, machine, hours, commands, joints):
        offsets = np.broadcast_to(TOOL, commands.shape)
        self.hours, self.commands = hours, commands
        self.points = nominal(commands, offsets)
        self.displacements = {case: machine.point_in_workpiece(hours, at, offsets) - self.points
                              for case, at in joints.items()}

    def errors(self):
        """After the best fit of the datum, one for all hours of a case."""
        return {case: 1e3 * without_datum(displacement, self.points)[0]
                for case, displacement in self.displacements.items()}


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


def factors_at(hours, record_hours, temperatures):
    """Value less reference of every state at times, by the equations and not by LinuxCNC."""
    states = dict(temperatures)
    for name, (of, time_constant) in TIME_CONSTANTS.items():
        states[name] = lag(temperatures[of], 60.0, time_constant)
    return {name: np.interp(hours, record_hours, values) - REFERENCE for name, values in states.items()}


def predicted_variances(identified, course, factors):
    """Of the coordinates of what remains, um^2, two parts: identified parameters; what no parameter explains."""
    by_parameters = identified.by_parameters(course.commands, TOOL, factors, TRAVEL)
    flat = by_parameters.reshape(-1, by_parameters.shape[2])
    motions = np.linalg.qr(rigid_motions(course.points))[0]
    flat = flat - motions @ (motions.T @ flat)
    parameters = np.einsum("ij,jk,ik->i", flat, identified.covariance, flat).reshape(-1, 3)
    pose = identified.pose_variance * (1 - (motions**2).sum(axis=1)).reshape(-1, 3)
    return 1e6 * parameters, 1e6 * pose


def poses_of(readings):
    with open(readings, encoding="ascii") as file:
        return len({tuple(line.split(",")[:3]) for line in file}) - 1


def rms(errors):
    return float(np.sqrt((errors**2).sum(axis=1).mean()))


def check_linuxcnc(identified, commands, joints, day, factors):
    """Largest difference from what is worked out here: lags (K), corrections at the states that were used (um)."""
    lags = max(np.abs(day[:, 10 + k] - REFERENCE - factors[name]).max() for k, name in enumerate(LAGS))
    used = {name: day[:, 10 + k] - REFERENCE for k, name in enumerate((*LAGS, *SENSORS))}
    expected = identified.by_parameters(commands, TOOL, used, TRAVEL) @ identified.values
    difference = 1e3 * np.abs(commands - joints - expected)
    return lags, difference.max()


def main():
    results, page = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    with np.load(results / "truth.npz") as stored:
        seed = int(stored["seed"])
        machine = HiddenPoses(stored["hours"], stored["deformations"], Geometry(seed))
    hours, commands, joints, day = read_runs(results)
    record_hours, temperatures = read_temperatures(results / "unseen.csv")
    identified = Identified(results / "thermal")
    factors = factors_at(hours, record_hours, temperatures)
    lag_off, correction_off = check_linuxcnc(identified, commands, joints["thermal"], day, factors)

    anywhere = np.abs(commands - SAME_PLACE).max(axis=1) > 1e-6
    course = Course(machine, hours[anywhere], commands[anywhere], {k: v[anywhere] for k, v in joints.items()})
    same = Course(machine, hours[~anywhere], commands[~anywhere], {k: v[~anywhere] for k, v in joints.items()})
    errors = course.errors()
    parameters, pose = predicted_variances(identified, course, {k: v[anywhere] for k, v in factors.items()})
    predicted = np.sqrt((parameters + pose).sum(axis=1))  # of the length, k = 1, at each pose
    figures = {case: rms(of) for case, of in errors.items()}
    figures |= {"predicted": float(np.sqrt((predicted**2).mean())),
                "parameters": float(np.sqrt(parameters.sum(axis=1).mean())),
                "pose": float(np.sqrt(pose.sum(axis=1).mean())),
                "covered": float((np.linalg.norm(errors["thermal"], axis=1) < 2 * predicted).mean()),
                "largest": {case: float(np.linalg.norm(of, axis=1).max()) for case, of in errors.items()},
                "reduction": figures["geometric"] / figures["thermal"], "poses": int(anywhere.sum())}
    figures["ratio"] = figures["thermal"] / figures["predicted"]
    reached = figures["reduction"] >= LEAST and figures["ratio"] <= RATIO

    print(f"{figures['poses']} poses all over the travel, hours {UNSEEN[0]} to {UNSEEN[1]}, which are unseen")
    print(f"LinuxCNC against the equations: lags within {lag_off:.3f} K, corrections within {correction_off:.2f} um")
    print("displacement of the functional point, root mean square (largest):")
    for case, words in (("before", "before"), ("geometric", "geometric compensation"),
                        ("thermal", "geometric and thermal compensation")):
        print(f"  {words:36s} {figures[case]:6.2f} um ({figures['largest'][case]:.1f} um)")
    print(f"  predicted standard uncertainty       {figures['predicted']:6.2f} um: {figures['parameters']:.2f} um of "
          f"the parameters, {figures['pose']:.2f} um of what no parameter explains (pose noise)")
    print(f"{figures['reduction']:.1f} times better than geometric compensation alone (goal {LEAST}); "
          f"{figures['ratio']:.2f} times the predicted uncertainty (goal at most {RATIO}); "
          f"{100 * figures['covered']:.0f} % of the poses within two of them")
    write_page(page, {"figures": figures, "reached": reached, "goals": (LEAST, RATIO), "days": Days(seed),
                      "unseen": UNSEEN, "sensors": SENSORS, "record": (record_hours, temperatures),
                      "trained_poses": poses_of(results / "readings.csv"),
                      "course": (course.hours, errors, predicted), "same": (same.hours, same.displacements),
                      "factor": FACTOR, "every_min": 60 * EVERY_H, "lag_off": lag_off,
                      "correction_off": correction_off})
    if lag_off > 0.2 or correction_off > 0.1:
        sys.exit("judge: what LinuxCNC did is not what the identified errors say")
    if not reached:
        sys.exit("judge: the goals are missed")


if __name__ == "__main__":
    main()
