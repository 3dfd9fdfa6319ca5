"""The hidden machine, poses: where a point of the tool really stands, at a command and a time. Lengths mm, angles rad.

The chain is w X' Y' b Z t. Rigid bodies one after the other: from the bed over Y and X to the workpiece, from the bed
over the column and Z to the tool. Nothing here is taken from the library.
"""
import numpy as np
from days import TRAVEL

GAUGE = np.array([0.0, 0.0, 610.0])  # of the spindle, all axes at zero
TOOL = np.array([0.0, 0.0, -120.0])  # functional point from the gauge point
WORKPIECE = np.array([380.0, 220.0, 0.0])
CELLS = {"column": 31, "bed": 33, "X": 41, "Y": 29, "Z": 31}  # ends of cells, in the order of deformation()
LENGTH = {"column": 1.5, "bed": 1.6, "X": 1.0, "Y": 0.7, "Z": 0.75}  # m
HEAD_AT, COLUMN_AT, TABLE_AT = 1.05, 1.25, 0.75  # m: guide of Z on the column, column and table on the bed
OVERHANG, BED_TOP, SCREW_TOP = 450.0, -300.0, 1.45  # mm: front of the column from the spindle; top of the bed; m


def rotation(angles):
    """Rz Ry Rx of rows of angles."""
    (sa, sb, sc), (ca, cb, cc) = np.sin(angles).T, np.cos(angles).T
    return np.stack([np.stack([cc * cb, cc * sb * sa - sc * ca, cc * sb * ca + sc * sa], -1),
                     np.stack([sc * cb, sc * sb * sa + cc * ca, sc * sb * ca - cc * sa], -1),
                     np.stack([-sb, cb * sa, cb * ca], -1)], -2)


def moved(points, shift, angles, about):
    """Points of a body that is turned about `about` and shifted."""
    return np.einsum("nij,nj->ni", rotation(angles), points - about) + about + shift


def moved_back(points, shift, angles, about):
    return np.einsum("nji,nj->ni", rotation(angles), points - about - shift) + about


class Geometry:
    """Error motions at 20 degC: waves of no polynomial form, and the pitch of the screws."""

    def __init__(self, seed=5):
        generator = np.random.default_rng(seed)
        self.waves = {}
        for axis, (low, high) in zip("XYZ", TRAVEL):
            for component in range(6):
                size = 11e-3 if component < 3 else 22e-6
                waves = [(size * generator.normal() / k**1.3, generator.uniform(0, 2 * np.pi), np.pi * k / (high - low))
                         for k in (0.6, 1.1, 1.9, 3.2)]
                self.waves[axis, component] = waves
        self.pitch = {axis: (0.5e-3, generator.uniform(0, 2 * np.pi), 2 * np.pi / 12) for axis in "XYZ"}
        self.squareness = 30e-6 * generator.normal(size=3)  # EC0Y, EA0Z, EB0Z

    def motion(self, axis, commands):
        """Shifts and angles of the carriage, zero where the command is zero."""
        def value(waves):
            return sum(a * (np.sin(f * commands + p) - np.sin(p)) for a, p, f in waves)

        six = np.stack([value(self.waves[axis, c]) for c in range(6)], -1)
        six[:, "XYZ".index(axis)] += value([self.pitch[axis]])
        return six[:, :3], six[:, 3:]


class HiddenPoses:
    def __init__(self, times, deformations, geometry):
        self.times, self.deformations, self.geometry = times, deformations, geometry

    def parts(self, hours):
        """Deformations at times, linear between the minutes: name -> rows."""
        index = np.clip(np.searchsorted(self.times, hours, side="right") - 1, 0, self.times.size - 2)
        share = ((hours - self.times[index]) / (self.times[index + 1] - self.times[index]))[:, None]
        rows = (1 - share) * self.deformations[index] + share * self.deformations[index + 1]
        names = [f"{part} {what}" for part in ("column", "bed") for what in ("growth", "slope", "deflection")]
        names += list("XYZ")
        found, at = {}, 0
        for name in names:
            count = CELLS[name.split()[0]]
            found[name] = rows[:, at:at + count]
            at += count
        found["spindle"], found["head"] = rows[:, at], rows[:, at + 1]
        return found

    def point_in_workpiece(self, hours, commands, offsets):
        """Points of the tool (from the gauge point) in the workpiece frame; rows of X Y Z in mm."""
        x, y, z = commands.T
        parts, zero = self.parts(hours), np.zeros(len(hours))

        def at(name, place):
            values, length = parts[name], LENGTH[name.split()[0]]
            f = np.clip(place / length * (values.shape[1] - 1), 0, values.shape[1] - 1 - 1e-9)
            k, rows = f.astype(int), np.arange(len(f))
            return values[rows, k] * (1 - f + k) + values[rows, k + 1] * (f - k)

        # From the tool to the bed: spindle and head, Z with its errors, column, bed under the column.
        points = GAUGE + offsets
        points = points + 1e3 * np.stack([zero, -parts["head"], -parts["spindle"]], -1)
        shift, angles = self.geometry.motion("Z", z)
        points = moved(points, shift, angles, np.zeros(3)) + np.stack([zero, zero, z], -1)
        points = moved(points, 0.0, np.stack([np.full_like(z, self.geometry.squareness[1]),
                                              np.full_like(z, self.geometry.squareness[2]), zero], -1), np.zeros(3))
        guide = HEAD_AT + z / 1000
        slope, along_y = at("column slope", guide), at("column deflection", guide)
        along_z = at("column growth", np.full_like(z, SCREW_TOP)) - at("Z", 0.10 - z / 1000)
        about = np.stack([zero, np.full_like(z, OVERHANG), BED_TOP + 1e3 * guide], -1)
        # A slope towards the back turns the upper end back: a negative turn about X.
        points = moved(points, 1e3 * np.stack([zero, along_y, along_z], -1), np.stack([-slope, zero, zero], -1), about)
        points = self.on_bed(points, at, zero + COLUMN_AT)
        # And back to the workpiece: bed under the saddle, Y, X.
        saddle = TABLE_AT - y / 1000
        points = self.on_bed(points, at, saddle, back=True)
        shift, angles = self.geometry.motion("Y", y)
        points = points - 1e3 * np.stack([zero, at("Y", 0.12 + (440 - y) / 1000), zero], -1)
        square = np.stack([zero, zero, np.full_like(y, self.geometry.squareness[0])], -1)
        points = moved_back(points, 0.0, square, np.zeros(3))
        points = moved_back(points + np.stack([zero, y, zero], -1), shift, angles, np.zeros(3))
        shift, angles = self.geometry.motion("X", x)
        points = points - 1e3 * np.stack([at("X", 0.12 + (760 - x) / 1000), zero, zero], -1)
        points = moved_back(points + np.stack([x, zero, zero], -1), shift, angles, np.zeros(3))
        return points - WORKPIECE

    @staticmethod
    def on_bed(points, at, place, back=False):
        """The bed there: raised and turned about X. It begins 750 mm in front of the middle of the table."""
        zero = np.zeros(len(points))
        shift = 1e3 * np.stack([zero, at("bed growth", place), at("bed deflection", place)], -1)
        angles = np.stack([at("bed slope", place), zero, zero], -1)
        about = np.stack([zero, 1e3 * (place - TABLE_AT), zero + BED_TOP], -1)
        return (moved_back if back else moved)(points, shift, angles, about)


def nominal(commands, offsets):
    x, y, z = commands.T
    return GAUGE + offsets + np.stack([x, y, z], -1) - WORKPIECE
