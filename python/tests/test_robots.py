"""Robots from tables and URDF, against matrices multiplied here."""

import numpy
import pytest

import abbe

PUMA = [(0, 0, 0, 0), (0, -90, 0, 0), (431.8, 0, 149.09, 0), (-20.32, -90, 433.07, 0), (0, 90, 0, 0), (0, -90, 0, 0)]
RANDOM = numpy.random.default_rng(4)


def product(joints, commands, modified):
    """The last frame of a Denavit-Hartenberg table."""
    frame = numpy.eye(4)
    for joint, command in zip(joints, commands):
        a, alpha = joint.a_mm, numpy.radians(joint.alpha_deg)
        theta = numpy.radians(joint.theta_deg) + (0 if joint.prismatic else command)
        d = joint.d_mm + (command if joint.prismatic else 0)
        ca, sa, ct, st = numpy.cos(alpha), numpy.sin(alpha), numpy.cos(theta), numpy.sin(theta)
        about_x = numpy.array([[1, 0, 0, a], [0, ca, -sa, 0], [0, sa, ca, 0], [0, 0, 0, 1]])
        about_z = numpy.array([[ct, -st, 0, 0], [st, ct, 0, 0], [0, 0, 1, d], [0, 0, 0, 1]])
        frame = frame @ (about_x @ about_z if modified else about_z @ about_x)
    return frame


def random_joints(count):
    return [abbe.Joint(*RANDOM.uniform(-300, 300, 1), *RANDOM.uniform(-180, 180, 1), *RANDOM.uniform(-300, 300, 1),
                       *RANDOM.uniform(-180, 180, 1), prismatic=bool(RANDOM.integers(5) == 0)) for _ in range(count)]


def check(robot, joints, modified):
    for _ in range(5):
        commands = RANDOM.uniform(-3, 3, len(joints))
        pose = abbe.nominal_poses(robot.machine, commands)
        expected = product(joints, commands, modified)
        numpy.testing.assert_allclose(pose.points_mm, expected[:3, 3], atol=1e-9)
        numpy.testing.assert_allclose(pose.rotations @ robot.zero_rotation, expected[:3, :3], atol=1e-12)


@pytest.mark.parametrize("modified", [False, True])
@pytest.mark.parametrize("count", [1, 2, 6, 7])
def test_tables_give_the_product_of_their_matrices(count, modified):
    for _ in range(4):
        joints = random_joints(count)
        check(abbe.robot_from_dh(joints, modified=modified), joints, modified)


def test_a_published_arm():
    joints = [abbe.Joint(*row) for row in PUMA]
    robot = abbe.robot_from_dh(joints, modified=True, name="arm")
    check(robot, joints, True)
    assert robot.machine.chain == "w b A1 A2 A3 A4 A5 A6 t"


def test_urdf_there_and_back():
    for count in (1, 3, 6):
        joints = random_joints(count)
        robot = abbe.robot_from_dh(joints)
        back = abbe.robot_from_urdf(abbe.urdf_text(robot))
        check(back, joints, False)
        assert back.joint_names == robot.joint_names


def test_couplings_move_other_joints():
    robot = abbe.robot_from_dh([abbe.Joint(a_mm=300, alpha_deg=30 * k) for k in range(4)])
    commands = [0.3, -0.4, 0.5, 0.2]
    names = robot.machine.axis_names
    apart = abbe.nominal_poses(robot.machine, [0.3, -0.4, 0.5 + 0.4 * 1.0, 0.2]).points_mm
    robot.machine.couplings = [(names[2], names[1], -1.0)]
    assert robot.machine.couplings == [(names[2], names[1], -1.0)]
    numpy.testing.assert_allclose(abbe.nominal_poses(robot.machine, commands).points_mm, apart, atol=1e-9)
    again = abbe.Machine.parse(robot.machine.text())
    assert again.couplings == robot.machine.couplings
    with pytest.raises(abbe.InputError, match="is coupled to"):
        abbe.urdf_text(robot)
    with pytest.raises(KeyError):
        robot.machine.couplings = [("Q", names[1], 1.0)]


def test_urdf_with_angles_fixed_joints_and_branches(tmp_path):
    text = """<robot name="r"><link name="base"/><link name="a"/><link name="b"/><link name="tool"/><link name="camera"/>
    <joint name="turn" type="revolute"><parent link="base"/><child link="a"/><origin xyz="0 0 0.5" rpy="0 0 1.5707963267948966"/>
      <axis xyz="0 0 1"/><limit lower="-2" upper="2"/></joint>
    <joint name="slide" type="prismatic"><parent link="a"/><child link="b"/><origin xyz="0.1 0 0"/><axis xyz="1 0 0"/>
      <limit lower="0" upper="0.4"/></joint>
    <joint name="flange" type="fixed"><parent link="b"/><child link="tool"/><origin xyz="0.05 0 0" rpy="0 0.3 0"/></joint>
    <joint name="eye" type="fixed"><parent link="a"/><child link="camera"/></joint></robot>"""
    file = tmp_path / "r.urdf"
    file.write_text(text)
    with pytest.raises(abbe.InputError, match="ends in tool, camera"):
        abbe.robot_from_urdf(file)
    robot = abbe.robot_from_urdf(file, tip="tool")
    pose = abbe.nominal_poses(robot.machine, [numpy.pi / 2, 20])
    numpy.testing.assert_allclose(pose.points_mm, [-170, 0, 500], atol=1e-9)
    assert robot.machine.axis("Z2").travel_mm == (0, 400)


@pytest.mark.parametrize("text", [
    "<robot", "<other/>", "<robot name='r'/>", "<!DOCTYPE x><robot/>",
    "<robot><joint name='j' type='floating'><parent link='a'/><child link='b'/></joint></robot>",
    "<robot><joint name='j' type='revolute'><parent link='a'/><child link='b'/></joint></robot>",
    "<robot><joint name='j' type='continuous'><parent link='a'/><child link='b'/><axis xyz='0 0 0'/></joint></robot>",
    "<robot><joint name='j' type='continuous'><parent link='a'/><child link='b'/><axis xyz='0 nan 0'/></joint></robot>",
    "<robot><joint name='j' type='continuous'><parent link='b'/><child link='b'/></joint></robot>",
    "<robot><joint name='j' type='continuous'><child link='b'/></joint></robot>",
])
def test_bad_urdf_is_refused(text):
    with pytest.raises(abbe.InputError):
        abbe.robot_from_urdf(text)


def test_bad_tables_are_refused():
    with pytest.raises(abbe.InputError):
        abbe.robot_from_dh([])
    with pytest.raises(abbe.InputError):
        abbe.robot_from_dh([abbe.Joint(a_mm=float("nan"))])
