"""A six-axis arm with errors, as Denavit-Hartenberg parameters and as error motions of a machine, and its poses by NumPy."""

from __future__ import annotations

from dataclasses import dataclass

import numpy

import abbe

#: Modified (Craig 1986) parameters: a and alpha before the joint. Joints 2 and 3 are parallel.
NOMINAL = [
    abbe.Joint(d_mm=290), abbe.Joint(alpha_deg=-90, theta_deg=-90), abbe.Joint(a_mm=270),
    abbe.Joint(a_mm=70, alpha_deg=-90, d_mm=302), abbe.Joint(alpha_deg=90), abbe.Joint(alpha_deg=-90, theta_deg=180),
]
TARGET_MM = (40.0, -25.0, 132.0)  #: what is measured, in the last frame
#: Columns alpha, a, theta, d that can be told from positions of the target: not d2, which d3 stands for, and not d6, which
#: is that of the tool.
SEEN = numpy.ones((6, 4), bool)
SEEN[1, 3] = SEEN[5, 3] = False


@dataclass
class Arm:
    """alpha and theta in rad, a and d in mm: [6, 4] in the order alpha, a, theta, d."""

    table: numpy.ndarray

    @classmethod
    def nominal(cls) -> Arm:
        return cls(numpy.array([[numpy.radians(j.alpha_deg), j.a_mm, numpy.radians(j.theta_deg), j.d_mm] for j in NOMINAL]))

    @classmethod
    def with_errors(cls, seed: int = 3) -> Arm:
        """Angles off by 100 urad, lengths by 0.1 mm (standard deviations)."""
        random = numpy.random.default_rng(seed)
        errors = random.normal(0, [1e-4, 0.1, 1e-4, 0.1], (6, 4))
        return cls(cls.nominal().table + numpy.where(SEEN, errors, 0))


def turn(axis: int, angle: float) -> numpy.ndarray:
    frame = numpy.eye(4)
    i, j = [(1, 2), (2, 0), (0, 1)][axis]
    frame[[i, j], [i, j]] = numpy.cos(angle)
    frame[j, i], frame[i, j] = numpy.sin(angle), -numpy.sin(angle)
    return frame


def shift(axis: int, length: float) -> numpy.ndarray:
    frame = numpy.eye(4)
    frame[axis, 3] = length
    return frame


def links(arm: Arm) -> list[numpy.ndarray]:
    """From the frame that joint j - 1 turns to the one that joint j turns, with j at zero; and to the last frame."""
    found, before = [], 0.0
    for alpha, a, theta, d in arm.table:
        found.append(shift(2, before) @ turn(0, alpha) @ shift(0, a) @ turn(2, theta))
        before = d
    return [*found, shift(2, before)]


def joint_frames(arm: Arm) -> list[numpy.ndarray]:
    """Frames of the joints in the base, all at zero."""
    frames = [numpy.eye(4)]
    for link in links(arm)[:6]:
        frames.append(frames[-1] @ link)
    return frames[1:]


def machine() -> abbe.Machine:
    """The arm without errors. The point of every axis is where its frame is, so that errors act there."""
    made = abbe.robot_from_dh(NOMINAL, modified=True, name="six axes").machine
    for axis, frame in zip(made.axis_names, joint_frames(Arm.nominal())):
        made.axis(axis).point_mm = tuple(frame[:3, 3])
    last = joint_frames(Arm.nominal())[5] @ links(Arm.nominal())[6]
    made.tool_offset_mm = tuple(last[:3, :3] @ TARGET_MM)
    return made


def errors_of(arm: Arm) -> abbe.Errors:
    """The same arm as error motions of its axes, constant over their travel: exact, not of first order."""
    errors = abbe.Errors(machine())
    before = links(Arm.nominal())
    for index, (actual, frame) in enumerate(zip(links(arm)[:6], joint_frames(Arm.nominal()))):
        moved = frame @ numpy.linalg.inv(before[index]) @ actual @ numpy.linalg.inv(frame)
        rotation = moved[:3, :3]
        displacement = moved[:3, :3] @ frame[:3, 3] + moved[:3, 3] - frame[:3, 3]  # of the point of the axis
        angles = [numpy.arctan2(rotation[2, 1], rotation[2, 2]), numpy.arcsin(-rotation[2, 0]),
                  numpy.arctan2(rotation[1, 0], rotation[0, 0])]  # Rz Ry Rx: docs/conventions.md
        for letter, value in zip("XYZ", displacement):
            errors.add_motion(f"E{letter}A{index + 1}", basis="monomial", coefficients_um=[1e3 * value])
        for letter, value in zip("ABC", angles):
            errors.add_motion(f"E{letter}A{index + 1}", basis="monomial", coefficients_urad=[1e6 * value])
    return errors


def commands(count: int, seed: int = 11) -> numpy.ndarray:
    """[count, 6] rad, Fortran order."""
    return numpy.asfortranarray(numpy.random.default_rng(seed).uniform(-1.5, 1.5, (count, 6)))


def poses_by_numpy(arm: Arm, q: numpy.ndarray, block: int = 4096) -> tuple[numpy.ndarray, numpy.ndarray]:
    """Targets [n, 3] and rotations [n, 3, 3]: all joints one after the other, with blocks of poses that stay in the cache."""
    points, rotations = numpy.empty((len(q), 3)), numpy.empty((len(q), 3, 3))
    for first in range(0, len(q), block):
        part = q[first:first + block]
        cosines, sines = numpy.cos(part).T, numpy.sin(part).T
        x, y, z = (numpy.repeat(column[:, None], len(part), axis=1) for column in numpy.eye(3))
        p = numpy.zeros((3, len(part)))
        for (alpha, a, theta, d), c, s in zip(arm.table, cosines, sines):
            ca, sa = numpy.cos(alpha), numpy.sin(alpha)
            p += a * x
            y, z = ca * y + sa * z, ca * z - sa * y
            ct, st = numpy.cos(theta), numpy.sin(theta)
            c, s = ct * c - st * s, st * c + ct * s
            x, y = c * x + s * y, c * y - s * x
            p += d * z
        p += TARGET_MM[0] * x + TARGET_MM[1] * y + TARGET_MM[2] * z
        points[first:first + block] = p.T
        for column, axis in enumerate((x, y, z)):
            rotations[first:first + block, :, column] = axis.T
    return points, rotations
