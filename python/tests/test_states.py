"""Errors that depend on temperatures, loads and the pose: values by pose, errors at a state, what is refused."""

import numpy
import pytest

import abbe

MACHINE = """
name = "mill"
chain = "w X' Y' b Z t"
[axis.X]
travel_mm = [-250, 250]
[axis.Y]
travel_mm = [-250, 250]
[axis.Z]
travel_mm = [-250, 250]
[state.ambient]
kind = "measured"
unit = "degC"
reference_degC = 20
[state.spindle]
kind = "measured"
unit = "degC"
reference_degC = 22
[state.slow]
kind = "lag"
of = "spindle"
time_constant_s = 600
[state.reach]
kind = "axis"
axis = "Z"
"""
ERRORS = """
[[motion]]
name = "EXX"
basis = "monomial"
order = 1
coefficients_um = [1, 2]
[[motion]]
name = "EXX"
state = "ambient"
basis = "monomial"
order = 1
coefficients_um = [0, 3]
[[motion]]
name = "EZZ"
state = "slow"
basis = "monomial"
order = 0
coefficients_um = [5]
[[location]]
name = "EC0Y"
state = "reach"
value_urad = 10
"""


@pytest.fixture(name="mill")
def mill_of_the_text():
    return abbe.Machine.parse(MACHINE)


@pytest.fixture(name="errors")
def errors_of_the_text(mill):
    return abbe.Errors.parse(ERRORS, mill)


def test_states_of_a_machine_are_described(mill, errors):
    ambient, spindle, slow, reach = mill.states
    assert (ambient.name, ambient.kind, ambient.unit, ambient.column) == ("ambient", "measured", "degC", "ambient_degC")
    assert (ambient.reference, ambient.factor_unit, ambient.axis) == (20, "K", None)
    assert (slow.kind, slow.first, slow.time_constant_s) == ("lag", "spindle", 600)
    assert (reach.kind, reach.axis, reach.factor_unit) == ("axis", "Z", "mm")
    assert "spindle" in repr(spindle)
    assert errors.states == ["ambient", "slow", "reach"]
    assert errors.names[2:4] == ["EXX*ambient[s^0]", "EXX*ambient[s^1]"]


def test_values_by_pose_give_what_errors_at_each_state_give(errors):
    random = numpy.random.default_rng(3)
    count = 1100  # more than a block
    positions = random.uniform(-200, 200, (count, 3))
    ambient = random.uniform(15, 30, count)
    model = abbe.PoseModel(errors)
    given = {"ambient_degC": ambient, "slow_degC": 30}
    together = model.deviations(positions, states=given)
    for k in (0, 1, 511, 512, 1099):
        alone = abbe.PoseModel(errors.at_state({"ambient_degC": ambient[k], "slow_degC": 30}))
        numpy.testing.assert_allclose(together[k], alone.deviations(positions[k]), rtol=1e-12, atol=1e-15)
    poses = model.poses(positions, states=given)
    assert poses.covered.all() and model.covered(positions, states=given).all()
    numpy.testing.assert_array_equal(poses.points_mm, model.points(positions, states=given))
    # A table moved too far in X takes the tool the other way: monomials of X over its travel, -250 to 250 mm.
    warm = together - model.deviations(positions, states={"ambient_degC": 20, "slow_degC": 30})
    numpy.testing.assert_allclose(warm[:, 0], -1e-3 * (ambient - 20) * 3 * positions[:, 0] / 250, atol=1e-9)
    spindle = together - model.deviations(positions, states={"ambient_degC": ambient, "slow_degC": 22})
    numpy.testing.assert_allclose(spindle[:, 2], 8 * 5e-3, atol=1e-9)


def test_derivatives_are_those_of_finite_differences(errors):
    given = {"ambient_degC": [24.5], "slow_degC": [31]}
    pose = numpy.array([[100.0, -50.0, -80.0]])
    model = abbe.PoseModel(errors)
    jacobian = model.jacobian(pose, states=given)[0]
    values = errors.values_mm_rad
    for p in range(len(values)):
        step = 1e-4 if not errors.is_angle[p] else 1e-7
        sides = []
        for sign in (-1, 1):
            moved = errors.copy()
            changed = values.copy()
            changed[p] += sign * step
            moved.values_mm_rad = changed
            sides.append(abbe.PoseModel(moved).deviations(pose, states=given)[0])
        numpy.testing.assert_allclose(jacobian[:, p], (sides[1] - sides[0]) / (2 * step), rtol=1e-5, atol=1e-6)
    by_commands = model.jacobian_by_positions(pose, states=given)
    assert by_commands.shape == (1, 6, 3) and numpy.isfinite(by_commands).all()


def test_commands_are_corrected_with_states(errors):
    positions = numpy.array([[100.0, 50.0, -80.0], [-100.0, 20.0, -10.0]])
    given = {"ambient_degC": [25, 15], "slow_degC": 40}
    result = abbe.correct_commands(errors, positions, states=given)
    assert result.reached.all()
    actual = abbe.PoseModel(errors).points(result.positions_mm_rad, states=given)
    nominal = abbe.nominal_poses(errors.machine, positions).points_mm
    numpy.testing.assert_allclose(actual, nominal, atol=1e-9)


def test_covariance_goes_with_the_state(errors):
    size = len(errors)
    errors.covariance = numpy.diag(numpy.arange(1, size + 1) * 1e-8)
    there = errors.at_state({"ambient_degC": 26, "slow_degC": 22})
    # The standard uncertainty of EXX*ambient[s^1] times 6 K.
    assert there.names[3] == "EXX[s^1]" and there.states == ["reach"]
    assert there.covariance[3, 3] == pytest.approx(4e-8 * 36)
    assert there.covariance[1, 1] == pytest.approx(2e-8)


def test_what_is_missing_or_wrong_is_named(mill, errors):
    pose = numpy.zeros((2, 3))
    model = abbe.PoseModel(errors)
    with pytest.raises(abbe.InputError, match="ambient_degC"):
        model.poses(pose)
    with pytest.raises(abbe.InputError, match="slow_degC"):
        model.points(pose, states={"ambient_degC": 20})
    for wrong in ({"ambient_K": 20}, {"ambient": 20}, {"reach": 1}, {3: 1}):
        with pytest.raises(abbe.InputError, match="states"):
            model.poses(pose, states=wrong)
    for wrong in ([1, 2, 3], [numpy.nan, 1], "warm", [[1, 2]]):
        with pytest.raises(abbe.InputError, match="ambient_degC"):
            model.poses(pose, states={"ambient_degC": wrong, "slow_degC": 22})
    with pytest.raises(abbe.InputError, match="ambient"):
        errors.at_state({"slow_degC": 22})
    with pytest.raises(abbe.InputError, match="ambient"):
        abbe.CompensatedInverse(errors)
    with pytest.raises(abbe.InputError, match="ambient"):
        abbe.volumetric_figures(errors)
    with pytest.raises(abbe.InputError, match="depends? on"):
        errors.evaluate("X", [0.0])
    plain = abbe.Errors(mill)
    assert plain.states == [] and abbe.PoseModel(plain).poses(pose).covered.all()
