"""Packages that compute poses of robots, each in the way its documentation shows: they are optional."""

from __future__ import annotations

import importlib.machinery
import importlib.util
import pathlib
import sys
from collections.abc import Callable
from importlib.metadata import version
from typing import Any

import numpy
from arm import TARGET_MM, Arm, links, turn

Points = Callable[[numpy.ndarray], numpy.ndarray]


def pybotics_robot(arm: Arm) -> Any:
    from pybotics.robot import Robot

    robot = Robot.from_parameters(arm.table)
    robot.tool.position = numpy.array(TARGET_MM)
    return robot


def by_pybotics(arm: Arm) -> Points:
    robot = pybotics_robot(arm)
    return lambda q: numpy.array([robot.fk(pose)[:3, 3] for pose in q])


def by_roboticstoolbox(arm: Arm) -> Points:
    """Its robots by Denavit and Hartenberg."""
    from roboticstoolbox import DHRobot, RevoluteMDH
    from spatialmath import SE3

    robot = DHRobot([RevoluteMDH(alpha=alpha, a=a, offset=theta, d=d) for alpha, a, theta, d in arm.table], tool=SE3(*TARGET_MM))
    return lambda q: numpy.array(robot.fkine(q).t)


def by_elementary_transforms(arm: Arm) -> Points:
    """Its elementary transforms: compiled code goes over the whole array."""
    from roboticstoolbox import ET, ETS
    from spatialmath import SE3

    ets = ETS()
    for alpha, a, theta, d in arm.table:
        ets = ets * ET.Rx(alpha) * ET.tx(a) * ET.Rz(theta) * ET.Rz() * ET.tz(d)
    tool = SE3(*TARGET_MM)
    return lambda q: ets.eval(q, tool=tool.A)[..., :3, 3]


def by_pykdl(arm: Arm) -> Points:
    import PyKDL

    chain = PyKDL.Chain()
    for index, (alpha, a, theta, d) in enumerate(arm.table):
        chain.addSegment(PyKDL.Segment(PyKDL.Joint(getattr(PyKDL.Joint, "None", PyKDL.Joint.Fixed)),
                                       PyKDL.Frame.DH_Craig1989(a, alpha, 0, theta)))
        tip = PyKDL.Vector(*TARGET_MM) if index == 5 else PyKDL.Vector(0, 0, 0)
        chain.addSegment(PyKDL.Segment(PyKDL.Joint(PyKDL.Joint.RotZ), PyKDL.Frame(PyKDL.Vector(0, 0, d) + tip)))
    solver, joints, frame = PyKDL.ChainFkSolverPos_recursive(chain), PyKDL.JntArray(6), PyKDL.Frame()

    def points(q: numpy.ndarray, chain: Any = chain) -> numpy.ndarray:  # the solver does not keep its chain
        found = numpy.empty((len(q), 3))
        for k, pose in enumerate(q):
            for i in range(6):
                joints[i] = pose[i]
            assert solver.JntToCart(joints, frame) == 0
            found[k] = frame.p[0], frame.p[1], frame.p[2]
        return found

    return points


def pinocchio_model(arm: Arm) -> Any:
    """mm in place of m: only lengths are used."""
    import pinocchio

    model = pinocchio.Model()
    parent = 0
    for index, link in enumerate(links(arm)[:6]):
        parent = model.addJoint(parent, pinocchio.JointModelRZ(), pinocchio.SE3(link), f"A{index + 1}")
    tip = pinocchio.SE3(links(arm)[6]) * pinocchio.SE3(numpy.eye(3), numpy.array(TARGET_MM))
    model.addFrame(pinocchio.Frame("target", parent, 0, tip, pinocchio.FrameType.OP_FRAME))
    model.addFrame(pinocchio.Frame("base", 0, 0, pinocchio.SE3.Identity(), pinocchio.FrameType.OP_FRAME))
    return model


def by_pinocchio(arm: Arm) -> Points:
    import pinocchio

    model = pinocchio_model(arm)
    data, frame = model.createData(), model.getFrameId("target")

    def points(q: numpy.ndarray) -> numpy.ndarray:
        found = numpy.empty((len(q), 3))
        for k, pose in enumerate(q):
            pinocchio.forwardKinematics(model, data, pose)
            found[k] = pinocchio.updateFramePlacement(model, data, frame).translation
        return found

    return points


def figaroh_settings(parameters: list[str], count: int) -> dict[str, Any]:
    """Of calc_updated_fkm(), for positions of one target."""
    return {"calib_model": "full_params", "param_name": parameters, "start_frame": "base", "end_frame": "target",
            "NbMarkers": 1, "NbSample": count, "calibration_index": 3, "actJoint_idx": [1, 2, 3, 4, 5, 6],
            "measurability": [True, True, True, False, False, False]}


def by_figaroh(arm: Arm) -> Points:
    """Its model of positions of a target on an arm with errors, which are in the links here."""
    from figaroh.calibration.calibration_tools import calc_updated_fkm

    model = pinocchio_model(arm)
    data = model.createData()
    return lambda q: calc_updated_fkm(model, data, numpy.zeros(1), q, figaroh_settings(["d_px_A1"], len(q))).reshape(3, -1).T


def by_matrices(arm: Arm) -> Points:
    """NumPy as people write it: products of 4 x 4 matrices, pose after pose."""
    constant, target = links(arm), numpy.array([*TARGET_MM, 1.0])

    def points(q: numpy.ndarray) -> numpy.ndarray:
        found = numpy.empty((len(q), 3))
        for k, pose in enumerate(q):
            frame = numpy.eye(4)
            for link, angle in zip(constant, pose):
                frame = frame @ link @ turn(2, angle)
            found[k] = (frame @ constant[6] @ target)[:3]
        return found

    return points


#: Compiled code that is called directly: shown, but not what users of a package for robots or of NumPy write.
WITHOUT_TARGET = {"roboticstoolbox, ETS, compiled", "Pinocchio, called directly"}

#: Name, what has to be imported and its distribution, and how poses are computed.
POSES: dict[str, tuple[str, str, Callable[[Arm], Points]]] = {
    "pybotics": ("pybotics", "pybotics", by_pybotics),
    "roboticstoolbox, DHRobot": ("roboticstoolbox", "roboticstoolbox-python", by_roboticstoolbox),
    "roboticstoolbox, ETS, compiled": ("roboticstoolbox", "roboticstoolbox-python", by_elementary_transforms),
    "PyKDL": ("PyKDL", "", by_pykdl),
    "figaroh, calc_updated_fkm": ("figaroh", "figaroh", by_figaroh),
    "NumPy, matrices, pose after pose": ("numpy", "numpy", by_matrices),
    "Pinocchio, called directly": ("pinocchio", "pin", by_pinocchio),
}


def from_debian(module: str) -> None:
    """A compiled module of a Debian package, which a virtual environment does not see, if it is there for this Python."""
    for suffix in importlib.machinery.EXTENSION_SUFFIXES:
        path = pathlib.Path("/usr/lib/python3/dist-packages") / (module + suffix)
        spec = importlib.util.spec_from_file_location(module, path)
        if path.exists() and spec and spec.loader:
            sys.modules[module] = importlib.util.module_from_spec(spec)
            spec.loader.exec_module(sys.modules[module])


def missing(module: str) -> str | None:
    """Why a package cannot be used; None: it can."""
    try:
        if importlib.util.find_spec(module) is None:
            from_debian(module)
        __import__(module)
    except Exception as error:  # noqa: BLE001: whatever a package does when it is imported, the others are compared
        return f"{type(error).__name__}: {error}"
    return None


def version_of(module: str, distribution: str) -> str:
    if distribution:
        return version(distribution)
    return str(getattr(sys.modules[module], "__version__", ""))
