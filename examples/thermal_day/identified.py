"""What an identification wrote: errors at a pose and a state, and how uncertain they are. Lengths mm, angles rad.

A second computation beside the library, from docs/conventions.md alone and to first order in the errors (which leaves
some nanometres): for error motions in Legendre polynomials and location errors of the chain w X' Y' b Z t.
"""
import csv
import json
import pathlib
import tomllib

import numpy as np
from hidden_pose import GAUGE

UNITS = {"um": 1e-3, "urad": 1e-6}


def unit_and_values(table, key):
    """`coefficients_um` or `coefficients_urad`: in mm or rad."""
    unit = next(unit for unit in UNITS if f"{key}_{unit}" in table)
    return UNITS[unit] * np.atleast_1d(np.array(table[f"{key}_{unit}"], float))


class Identified:
    def __init__(self, folder):
        folder = pathlib.Path(folder)
        with open(folder / "errors.toml", "rb") as file:
            document = tomllib.load(file)
        self.terms, self.values = [], []  # (name, state or None, order, from, to), and all parameters
        names = []
        for table in document.get("motion", []):
            name, state = table["name"], table.get("state")
            values = unit_and_values(table, "coefficients")
            if table["basis"] != "legendre":
                raise ValueError(f"{folder}: basis {table['basis']}")
            self.terms.append((name, state, values.size, table.get("from_mm"), table.get("to_mm")))
            self.values += list(values)
            names += [f"{name}{'*' + state if state else ''}[P{k}]" for k in range(values.size)]
        for table in document.get("location", []):
            self.terms.append((table["name"], table.get("state"), 0, None, None))
            self.values += list(unit_and_values(table, "value"))
            names.append(table["name"] + (f"*{table['state']}" if table.get("state") else ""))
        self.values = np.array(self.values)
        self.covariance = self.read_covariance(folder / document["covariance"], names)
        summary = json.loads((folder / "summary.json").read_text())
        self.pose_variance = 1e-6 * summary["reading_variances"]["pose_noise_um"] ** 2

    @staticmethod
    def read_covariance(path, names):
        with open(path, encoding="utf-8", newline="") as file:
            head, *rows = list(csv.reader(line for line in file if not line.startswith("#")))
        place = {row[0]: k for k, row in enumerate(rows)}
        missing = [name for name in names if name not in place]
        if missing:
            raise ValueError(f"{path}: no row for {missing[0]}")
        unit = np.array([UNITS[row[1]] for row in rows])
        matrix = np.array([[float(value) for value in row[2:]] for row in rows]) * np.outer(unit, unit)
        if [name for name in head[2:]] != [row[0] for row in rows]:
            raise ValueError(f"{path}: rows and columns differ")
        chosen = [place[name] for name in names]
        return matrix[np.ix_(chosen, chosen)]

    def by_parameters(self, commands, offset, factors, travel):
        """Derivative of a point of the tool in the workpiece by all parameters: (poses, 3, parameters).

        @param factors  value less reference of each state, rows as the poses: name -> array
        """
        tool = GAUGE + np.asarray(offset, float)
        arm = {"Z": np.broadcast_to(tool, commands.shape), "Y": tool + commands * [0, 1, 1], "X": tool + commands}
        columns = []
        for name, state, count, low, high in self.terms:
            factor = factors[state] if state else np.ones(len(commands))
            axis = name[-1]
            if count == 0:  # location: the direction of the axis is turned
                turn, along = np.zeros(3), np.zeros(3)
                turn["ABC".index(name[1])], along["XYZ".index(axis)] = 1, 1
                columns.append(np.outer(commands[:, "XYZ".index(axis)] * factor, np.cross(turn, along)))
                continue
            place = commands[:, "XYZ".index(axis)]
            low, high = (low, high) if low is not None else travel["XYZ".index(axis)]
            functions = np.polynomial.legendre.legvander((2 * place - low - high) / (high - low), count - 1)
            direction = np.zeros((len(commands), 3))
            if name[1] in "XYZ":
                direction[:, "XYZ".index(name[1])] = 1
            else:
                turn = np.zeros(3)
                turn["ABC".index(name[1])] = 1
                direction = np.cross(turn, arm[axis])
            # Axes that carry the workpiece: their error moves the tool the other way in it.
            direction = direction * (1 if axis == "Z" else -1) * factor[:, None]
            columns += [direction * functions[:, k:k + 1] for k in range(count)]
        return np.stack(columns, -1)


def rigid_motions(points):
    """Displacements of points by motions of the workpiece as a whole: (3 points, 6)."""
    columns = []
    for k in range(3):
        shift = np.zeros_like(points)
        shift[:, k] = 1
        columns += [shift.ravel(), np.cross(shift, points).ravel() / 1000]
    return np.stack(columns, -1)


def lag(values, seconds, time_constant):
    """tau dy/dt + y = u for values a fixed time apart, joined by straight lines; in equilibrium at the first one."""
    x = seconds / time_constant
    gone = -np.expm1(-x)
    followed = np.empty_like(values)
    followed[0] = values[0]
    for k in range(1, values.size):
        step = values[k] - values[k - 1]
        followed[k] = followed[k - 1] + gone * (values[k - 1] - followed[k - 1]) + step * (1 - gone / x)
    return followed
