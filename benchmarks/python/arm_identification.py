"""Calibration of a six-axis arm from positions of a target: the package beside pybotics and figaroh, same readings."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy
from arm import SEEN, TARGET_MM, Arm, commands, joint_frames, links, machine, poses_by_numpy
from report import Table
from rivals import figaroh_settings, missing, pinocchio_model, pybotics_robot, version_of
from timing import seconds, shortest

import abbe

NOISE_MM = 0.02
AGREE_MM = 2e-5  # of predicted positions: where the solvers end, and products of two errors that the parameters share otherwise
Fit = Callable[[numpy.ndarray, numpy.ndarray], Callable[[numpy.ndarray], numpy.ndarray]]


def readings(count: int) -> tuple[numpy.ndarray, numpy.ndarray]:
    """Commands, and positions with noise in the base of the arm."""
    q = commands(count, seed=21)
    return q, poses_by_numpy(Arm.with_errors(), q)[0] + numpy.random.default_rng(4).normal(0, NOISE_MM, (count, 3))


def seen_components() -> list[tuple[int, int]]:
    """(joint, component of its error in its frame) that stand for the parameters: a, d before it, alpha, theta."""
    found = []
    for joint in range(6):
        found.append((joint, 0))  # a: along x
        if joint > 0 and SEEN[joint - 1, 3]:
            found.append((joint, 1 if abs(numpy.sin(Arm.nominal().table[joint, 0])) > 0.5 else 2))  # d of the joint before
        found += [(joint, 3), (joint, 5)]
    return found


def in_the_base(joint: int, component: int) -> str:
    """The error motion of a machine that is this component: its frame is parallel to the base but for signs and order.

    The frame after theta is turned about its own z: x and y are those before theta.
    """
    theta = Arm.nominal().table[joint, 2]
    before = joint_frames(Arm.nominal())[joint][:3, :3] @ links(Arm(numpy.array([[0, 0, -theta, 0]] * 6)))[0][:3, :3]
    axis = int(numpy.argmax(abs(before[:, component % 3])))
    return f"E{'XYZABC'[axis + 3 * (component // 3)]}A{joint + 1}"


def by_abbe(q: numpy.ndarray, measured: numpy.ndarray) -> Callable[[numpy.ndarray], numpy.ndarray]:
    arm = machine()
    study = abbe.Study(arm, {
        "setup": [{
            "name": "tracker", "instrument": "tracker", "mounted_on": "bed", "noise": {"xyz_um": 1e3 * NOISE_MM},
            "station": [{"name": "S", "pose": {"position_mm": [0, 0, 0], "angles_deg": [0, 0, 0]}, "estimate_pose": False}],
            "reflector": [{"name": "R", "offset_mm": arm.tool_offset_mm.tolist()}],
        }],
        "identify": {"motion": [{"errors": sorted({in_the_base(*which) for which in seen_components()}),
                                 "basis": "monomial", "order": 0}],
                     "held_out_fraction": 0},
    })
    given = abbe.Readings(study.instruments["tracker"], q, measured, items="R")
    result = study.run({"tracker": given}, map=False)
    assert result.errors is not None, result.message
    return abbe.PoseModel(result.errors).points


def pybotics_fit(residuals: Callable[..., numpy.ndarray], q: numpy.ndarray, measured: numpy.ndarray,
                 **options: object) -> Callable[[numpy.ndarray], numpy.ndarray]:
    from pybotics.optimization import OptimizationHandler
    from scipy.optimize import least_squares

    handler = OptimizationHandler(robot=pybotics_robot(Arm.nominal()), kinematic_chain_mask=SEEN.ravel().tolist())
    found = least_squares(residuals, handler.generate_optimization_vector(), args=(handler, q, measured), **options)
    handler.apply_optimization_vector(found.x)
    robot = handler.robot
    return lambda poses: numpy.array([robot.fk(pose)[:3, 3] for pose in poses])


def by_pybotics(q: numpy.ndarray, measured: numpy.ndarray) -> Callable[[numpy.ndarray], numpy.ndarray]:
    """As its example of calibration shows: distances as residuals. It ends before the least sum of squares is reached."""
    from pybotics.optimization import optimize_accuracy

    return pybotics_fit(optimize_accuracy, q, measured)


def by_pybotics_vectors(q: numpy.ndarray, measured: numpy.ndarray) -> Callable[[numpy.ndarray], numpy.ndarray]:
    """The same robot with three residuals per position, and parameters scaled: this does reach it."""

    def residuals(vector: numpy.ndarray, handler: Any, poses: numpy.ndarray, positions: numpy.ndarray) -> numpy.ndarray:
        handler.apply_optimization_vector(vector)
        return (numpy.array([handler.robot.fk(pose)[:3, 3] for pose in poses]) - positions).ravel()

    return pybotics_fit(residuals, q, measured, x_scale="jac")


def by_figaroh(q: numpy.ndarray, measured: numpy.ndarray) -> Callable[[numpy.ndarray], numpy.ndarray]:
    """Its model of the measurement, and the solver that it calls."""
    from figaroh.calibration.calibration_tools import calc_updated_fkm
    from scipy.optimize import least_squares

    model: Any = pinocchio_model(Arm.nominal())
    data = model.createData()
    names = []
    for joint, component in seen_components():
        if component % 3 < 2 and abs(numpy.cos(Arm.nominal().table[joint, 2])) < 0.5:
            component += 1 if component % 3 == 0 else -1  # its frame is turned by theta
        names.append(f"{('d_px', 'd_py', 'd_pz', 'd_phix', 'd_phiy', 'd_phiz')[component]}_A{joint + 1}")

    expected = measured.T.ravel()
    found = least_squares(lambda x: calc_updated_fkm(model, data, x, q, figaroh_settings(names, len(q))) - expected,
                          numpy.zeros(len(names)), method="lm", max_nfev=1000)
    return lambda poses: calc_updated_fkm(model, data, found.x, poses, figaroh_settings(names, len(poses))).reshape(3, -1).T


OTHERS: dict[str, tuple[str, str, Fit]] = {
    "pybotics, vectors, scipy": ("pybotics", "pybotics", by_pybotics_vectors),
    "pybotics, distances, scipy": ("pybotics", "pybotics", by_pybotics),
    "figaroh, scipy": ("figaroh", "figaroh", by_figaroh),
}


def arm_identification(count: int, repetitions: int) -> Table:
    q, measured = readings(count)
    unseen = commands(200, seed=22)
    ours = by_abbe(q, measured)(unseen)
    true = poses_by_numpy(Arm.with_errors(), unseen)[0]
    rms = numpy.sqrt(((ours - true) ** 2).sum(axis=1).mean())
    assert rms < NOISE_MM, f"unseen poses are {rms} mm off"
    table = Table(f"Calibration of a six-axis arm, {len(seen_components())} parameters, {count} positions", "ms", "time / abbe")
    found = {"abbe, Study.run()": []}
    for repetition in range(repetitions):
        found["abbe, Study.run()"] += [seconds(lambda: by_abbe(q, measured)) for _ in range(5)]
        for name, (module, distribution, fit) in OTHERS.items():
            problem = missing(module) or missing("scipy")
            if problem:
                table.notes += [] if repetition else [f"{name}: not compared, {problem}"]
                continue
            made = []
            time = seconds(lambda fit=fit, made=made: made.append(fit(q, measured)))
            difference = abs(made[0](unseen) - ours).max()
            assert fit is by_pybotics or difference < AGREE_MM, f"{name} has another arm: {difference} mm"
            found.setdefault(f"{name} {version_of(module, distribution)}", []).append(time)
            table.notes += [] if repetition else [f"{name}: predicts unseen poses as abbe does to {difference:.1g} mm"]
    times = {name: shortest(several).per(1e-3) for name, several in found.items()}
    for name, time in times.items():
        table.add(name, time, times["abbe, Study.run()"], at_least=None if name.startswith("abbe") else 20)
    table.notes.append(f"noise {1e3 * NOISE_MM:g} um; unseen poses {1e3 * rms:.1f} um off (root mean square) by abbe; abbe also judges the "
                       "result and predicts its uncertainty")
    return table
