"""Robots as machines: Denavit-Hartenberg tables and URDF."""

from __future__ import annotations

import math
import os
import xml.etree.ElementTree as ElementTree
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Union

import numpy

from ._core import Machine
from ._errors import InputError

_METRE = 1e3  # mm


def _refuse(field: str, problem: str, expected: str, file: str | None = None) -> InputError:
    place = ": ".join(part for part in (file, field) if part)
    return InputError(f"{place}: {problem}; expected {expected}", file=file, field=field, problem=problem, expected=expected)


@dataclass
class Joint:
    """One row of a Denavit-Hartenberg table.

    Revolute joints turn by ``theta_deg`` plus the command, prismatic ones move by ``d_mm`` plus the command.
    """

    a_mm: float = 0.0
    alpha_deg: float = 0.0
    d_mm: float = 0.0
    theta_deg: float = 0.0
    prismatic: bool = False
    travel_deg: tuple[float, float] = (-180.0, 180.0)  #: of a revolute joint
    travel_mm: tuple[float, float] = (0.0, 1000.0)  #: of a prismatic joint


@dataclass
class Robot:
    """A robot as a machine.

    The tool frame of a machine is parallel to the base while all joints are at zero; the last frame of the robot is
    turned against it by ``zero_rotation``: rotation of the last frame = rotation of the pose @ zero_rotation.
    """

    machine: Machine
    zero_rotation: numpy.ndarray
    joint_names: list[str]  #: as in the URDF; of a table, the names of the axes


def _turn(axis: int, angle: float) -> numpy.ndarray:
    c, s = math.cos(angle), math.sin(angle)
    frame = numpy.eye(4)
    i, j = [(1, 2), (2, 0), (0, 1)][axis]
    frame[i, i] = frame[j, j] = c
    frame[i, j], frame[j, i] = -s, s
    return frame


def _shift(axis: int, length: float) -> numpy.ndarray:
    frame = numpy.eye(4)
    frame[axis, 3] = length
    return frame


@dataclass
class _Line:
    """Axis of a joint in the base frame with all joints at zero."""

    name: str
    prismatic: bool
    direction: numpy.ndarray
    point: numpy.ndarray
    travel: tuple[float, float] | None  # mm or degrees; None: endless


def _machine(lines: Sequence[_Line], end: numpy.ndarray, name: str) -> Robot:
    letters = ["Z" if line.prismatic else "A" for line in lines]
    names = [f"{letter}{index + 1}" for index, letter in enumerate(letters)]
    machine = Machine.from_chain(f"w b {' '.join(names)} t")
    machine.name = name
    for axis_name, line in zip(names, lines):
        axis = machine.axis(axis_name)
        axis.direction = tuple(line.direction / numpy.linalg.norm(line.direction))
        axis.point_mm = tuple(line.point)
        if line.prismatic:
            axis.travel_mm = line.travel or (-1e4, 1e4)
        elif line.travel is None:
            axis.endless = True
            axis.travel_deg = (-180.0, 180.0)
        else:
            axis.travel_deg = line.travel
    machine.tool_reference_mm = tuple(end[:3, 3])
    machine.tool_direction = tuple(-end[:3, 2])
    problems = machine.problems()
    if problems:
        raise _refuse("robot", problems[0], "joints that make a machine")
    return Robot(machine, end[:3, :3].copy(), [line.name for line in lines])


def robot_from_dh(joints: Sequence[Joint], *, modified: bool = False, name: str = "robot") -> Robot:
    """A robot from a Denavit-Hartenberg table, one :class:`Joint` per axis.

    Standard (Denavit and Hartenberg 1955): ``Rot_z(theta) Trans_z(d) Trans_x(a) Rot_x(alpha)``, joint i about z of frame
    i - 1. Modified (Craig 1986): ``Rot_x(alpha) Trans_x(a) Rot_z(theta) Trans_z(d)``, joint i about z of frame i, with
    ``a`` and ``alpha`` of the row being those before the joint. The axes are called A1, A2, ...; prismatic ones Z1, Z2, ...

    >>> import abbe, numpy
    >>> arm = abbe.robot_from_dh([abbe.Joint(a_mm=300), abbe.Joint(a_mm=200)])
    >>> pose = abbe.nominal_poses(arm.machine, [0, numpy.pi / 2])
    >>> pose.points_mm.round(6).tolist()
    [300.0, 200.0, 0.0]
    """
    if not joints:
        raise _refuse("joints", "there are none", "at least one")
    frame, lines = numpy.eye(4), []
    for index, joint in enumerate(joints):
        numbers = (joint.a_mm, joint.alpha_deg, joint.d_mm, joint.theta_deg)
        if not all(math.isfinite(number) for number in numbers):
            raise _refuse(f"joints[{index}]", f"has the numbers {numbers}", "finite numbers")
        link = _shift(0, joint.a_mm), _turn(0, math.radians(joint.alpha_deg))
        move = _turn(2, math.radians(joint.theta_deg)) @ _shift(2, joint.d_mm)
        if modified:
            frame = frame @ link[1] @ link[0]
        lines.append(_Line(f"{'Z' if joint.prismatic else 'A'}{index + 1}", joint.prismatic, frame[:3, 2].copy(), frame[:3, 3].copy(),
                           joint.travel_mm if joint.prismatic else joint.travel_deg))
        frame = frame @ move
        if not modified:
            frame = frame @ link[0] @ link[1]
    return _machine(lines, frame, name)


def _numbers(element: ElementTree.Element | None, key: str, otherwise: str, file: str) -> numpy.ndarray:
    text = otherwise if element is None else element.get(key, otherwise)
    try:
        values = numpy.array([float(word) for word in text.split()])
    except ValueError:
        values = numpy.array([])
    if values.shape != (3,) or not numpy.isfinite(values).all():
        raise _refuse(key, f"is '{text}'", "three numbers", file)
    return values


def _origin(joint: ElementTree.Element, file: str) -> numpy.ndarray:
    origin = joint.find("origin")
    roll, pitch, yaw = _numbers(origin, "rpy", "0 0 0", file)
    frame: numpy.ndarray = _turn(2, yaw) @ _turn(1, pitch) @ _turn(0, roll)
    frame[:3, 3] = _METRE * _numbers(origin, "xyz", "0 0 0", file)
    return frame


def robot_from_urdf(urdf: Union[str, os.PathLike[str]], *, tip: str | None = None) -> Robot:
    """A robot from a URDF file, or from its text: the chain of joints from the root to a link.

    ``tip``: name of that link; it may be left out where the robot does not branch. Joints are revolute, continuous,
    prismatic or fixed. Lengths of URDF are in m. Raises :class:`abbe.InputError` for anything else.
    Source: http://wiki.ros.org/urdf/XML.
    """
    text = str(urdf)
    file = "URDF"
    if not text.lstrip().startswith("<"):
        file = text
        text = Path(urdf).read_text(encoding="utf-8")
    if "<!DOCTYPE" in text or "<!ENTITY" in text:
        raise _refuse("", "has a document type", "a URDF without one", file)
    try:
        root = ElementTree.fromstring(text)
    except ElementTree.ParseError as error:
        line, column = error.position
        raise InputError(f"{file}:{line}:{column + 1}: is no XML: {error}", file=file, line=line, column=column + 1,
                         problem=str(error)) from None
    if root.tag != "robot":
        raise _refuse(root.tag, "is the outermost element", "<robot>", file)
    above: dict[str, ElementTree.Element] = {}
    parents = set()
    for joint in root.findall("joint"):
        child, parent = joint.find("child"), joint.find("parent")
        if child is None or parent is None or not child.get("link") or not parent.get("link"):
            raise _refuse(f"joint '{joint.get('name')}'", "has no parent or no child", "<parent link=...> and <child link=...>", file)
        if str(child.get("link")) in above:
            raise _refuse(f"link '{child.get('link')}'", "has two parents", "a tree", file)
        above[str(child.get("link"))] = joint
        parents.add(str(parent.get("link")))
    if tip is None:
        tips = [link for link in above if link not in parents]
        if len(tips) != 1:
            raise _refuse("tip", f"is not given, and the robot ends in {', '.join(tips) or 'nothing'}", "the name of a link", file)
        tip = tips[0]
    chain: list[ElementTree.Element] = []
    link = tip
    while link in above:
        chain.insert(0, above[link])
        if len(chain) > len(above):
            raise _refuse("joint", "the links form a ring", "a tree", file)
        link = str(above[link].find("parent").get("link"))  # type: ignore[union-attr]
    if not chain:
        raise _refuse("tip", f"there is no joint above link '{tip}'", "the name of a link that moves", file)
    frame, lines = numpy.eye(4), []
    for joint in chain:
        name, kind = str(joint.get("name")), joint.get("type")
        frame = frame @ _origin(joint, file)
        if kind == "fixed":
            continue
        if kind not in ("revolute", "continuous", "prismatic"):
            raise _refuse(f"joint '{name}'", f"is of the type '{kind}'", "revolute, continuous, prismatic or fixed", file)
        direction = frame[:3, :3] @ _numbers(joint.find("axis"), "xyz", "1 0 0", file)
        if not numpy.linalg.norm(direction) > 0:
            raise _refuse(f"joint '{name}'", "its axis has the length zero", "a direction", file)
        travel = None
        if kind != "continuous":
            limit = joint.find("limit")
            try:
                ends = [float(limit.get(key, "0")) for key in ("lower", "upper")] if limit is not None else [0.0, 0.0]
            except ValueError:
                raise _refuse(f"joint '{name}'", "its limits are no numbers", "lower and upper", file) from None
            if not ends[0] < ends[1]:
                raise _refuse(f"joint '{name}'", f"its limits are {ends[0]} and {ends[1]}", "lower below upper", file)
            scale = _METRE if kind == "prismatic" else 180 / math.pi
            travel = (ends[0] * scale, ends[1] * scale)
        lines.append(_Line(name, kind == "prismatic", direction, frame[:3, 3].copy(), travel))
    if not lines:
        raise _refuse("tip", "no joint above it moves", "a robot with joints", file)
    return _machine(lines, frame, root.get("name", "robot"))


def urdf_text(robot: Robot) -> str:
    """A URDF of a robot without shapes: links, joints with their limits, and the last frame as the link ``tool``.

    :func:`robot_from_urdf` gives back the same kinematics.
    """
    machine = robot.machine
    if machine.couplings:
        coupled, other, _ = machine.couplings[0]
        raise _refuse(coupled, f"is coupled to {other}, and joints of a URDF act independently", "axes without couplings")
    root = ElementTree.Element("robot", name=machine.name or "robot")
    ElementTree.SubElement(root, "link", name="base")
    before = numpy.zeros(3)
    parent = "base"
    for axis, name in zip(machine.axes, robot.joint_names):
        if axis.side != "tool":
            raise _refuse(axis.name, "carries the workpiece", "axes that carry the tool")
        rotary = axis.kind == "rotary"
        kind = ("continuous" if axis.endless else "revolute") if rotary else "prismatic"
        ElementTree.SubElement(root, "link", name=f"after_{name}")
        joint = ElementTree.SubElement(root, "joint", name=name, type=kind)
        ElementTree.SubElement(joint, "parent", link=parent)
        ElementTree.SubElement(joint, "child", link=f"after_{name}")
        _vector(joint, "origin", (axis.point_mm - before) / _METRE)
        _vector(joint, "axis", axis.direction)
        if kind != "continuous":
            lower, upper = (math.radians(end) for end in axis.travel_deg) if rotary else (end / _METRE for end in axis.travel_mm)
            ElementTree.SubElement(joint, "limit", lower=repr(lower), upper=repr(upper), effort="0", velocity="0")
        before, parent = axis.point_mm, f"after_{name}"
    ElementTree.SubElement(root, "link", name="tool")
    joint = ElementTree.SubElement(root, "joint", name="tool_frame", type="fixed")
    ElementTree.SubElement(joint, "parent", link=parent)
    ElementTree.SubElement(joint, "child", link="tool")
    _vector(joint, "origin", (machine.tool_reference_mm + machine.tool_offset_mm - before) / _METRE,
            rpy=_roll_pitch_yaw(robot.zero_rotation))
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode") + "\n"


def _vector(joint: ElementTree.Element, tag: str, xyz: numpy.ndarray, rpy: Sequence[float] = ()) -> None:
    attributes = {"xyz": " ".join(repr(float(number)) for number in xyz)}
    if len(rpy):
        attributes["rpy"] = " ".join(repr(float(number)) for number in rpy)
    ElementTree.SubElement(joint, tag, attributes)


def _roll_pitch_yaw(rotation: numpy.ndarray) -> tuple[float, float, float]:
    """Angles about the fixed axes x, y, z: rotation = Rz(yaw) Ry(pitch) Rx(roll)."""
    pitch = math.atan2(-rotation[2, 0], math.hypot(rotation[0, 0], rotation[1, 0]))
    if math.hypot(rotation[0, 0], rotation[1, 0]) < 1e-12:
        return math.atan2(-rotation[1, 2], rotation[1, 1]), pitch, 0.0
    return math.atan2(rotation[2, 1], rotation[2, 2]), pitch, math.atan2(rotation[1, 0], rotation[0, 0])
