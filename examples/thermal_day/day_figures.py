"""Figures of a day: errors after the best fit of the workpiece datum, and how large they were predicted to be."""
import csv
import tomllib

import numpy as np
from days import TRAVEL
from hidden_pose import TOOL, Geometry, HiddenPoses, nominal
from identified import lag, rigid_motions

LEAST, RATIO = 10, 1.5  # the goals
REFERENCE = 20.0


def read_lags(path):
    """Lags of a machine file: name -> (the state that they follow, time constant in s)."""
    with open(path, "rb") as file:
        states = tomllib.load(file)["state"]
    return {name: (state["of"], state["time_constant_s"]) for name, state in states.items() if state["kind"] == "lag"}


def read_truth(path):
    with np.load(path) as stored:
        seed = int(stored["seed"])
        return HiddenPoses(stored["hours"], stored["deformations"], Geometry(seed)), seed


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


def factors_at(hours, record_hours, temperatures, lags):
    """Value less reference of every state at times, by the equations and not by LinuxCNC."""
    states = dict(temperatures)
    for name, (of, time_constant) in lags.items():
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


def rms(errors):
    return float(np.sqrt((errors**2).sum(axis=1).mean()))


def figures_of(course, identified, factors):
    """What is stated of poses all over the travel: figures, errors by case, predicted standard uncertainty at each."""
    errors = course.errors()
    parameters, pose = predicted_variances(identified, course, factors)
    predicted = np.sqrt((parameters + pose).sum(axis=1))  # of the length, k = 1
    figures = {case: rms(of) for case, of in errors.items()}
    figures |= {"predicted": float(np.sqrt((predicted**2).mean())),
                "parameters": float(np.sqrt(parameters.sum(axis=1).mean())),
                "pose": float(np.sqrt(pose.sum(axis=1).mean())),
                "covered": float((np.linalg.norm(errors["thermal"], axis=1) < 2 * predicted).mean()),
                "largest": {case: float(np.linalg.norm(of, axis=1).max()) for case, of in errors.items()},
                "reduction": figures["geometric"] / figures["thermal"], "poses": len(predicted)}
    figures["ratio"] = figures["thermal"] / figures["predicted"]
    figures["reached"] = figures["reduction"] >= LEAST and figures["ratio"] <= RATIO
    return figures, errors, predicted
