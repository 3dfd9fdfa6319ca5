"""Poses, derivatives, inverse and corrections on arrays."""

import bad_arrays
import numpy
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

import abbe

MILL = abbe.Machine.from_chain("w C' A' b X Y Z t")
MILL.axis("A").point_mm = (0, 0, -200)
MILL.axis("C").point_mm = (0, 0, -200)
ERRORS = abbe.Errors.random(MILL, seed=2, mean_volumetric_um=50)
MODEL = abbe.PoseModel(ERRORS)


def commands(count, seed=0):
    low, high = numpy.array([[-3, 3], [-1.5, 1.5], [-200, 200], [-200, 200], [-200, 200]]).T
    return numpy.random.default_rng(seed).uniform(low, high, (count, 5))


def test_one_pose_is_as_many():
    q = commands(1500)
    all_poses, deviations = MODEL.poses(q), MODEL.deviations(q)
    for k in (0, 511, 512, 1499):
        one = MODEL.poses(q[k])
        numpy.testing.assert_array_equal(one.points_mm, all_poses.points_mm[k])
        numpy.testing.assert_array_equal(one.rotations, all_poses.rotations[k])
        assert one.covered is True and all_poses.covered[k]
        numpy.testing.assert_array_equal(MODEL.deviations(q[k]), deviations[k])
    numpy.testing.assert_array_equal(MODEL.points(q), all_poses.points_mm)


def test_deviations_are_actual_minus_nominal():
    q = commands(50)
    nominal, actual = MODEL.nominal_poses(q), MODEL.poses(q)
    numpy.testing.assert_allclose(MODEL.deviations(q)[:, :3], actual.points_mm - nominal.points_mm, atol=1e-12)
    turn = actual.rotations @ nominal.rotations.transpose(0, 2, 1)
    skew = numpy.stack([turn[:, 2, 1] - turn[:, 1, 2], turn[:, 0, 2] - turn[:, 2, 0], turn[:, 1, 0] - turn[:, 0, 1]], axis=1) / 2
    numpy.testing.assert_allclose(MODEL.deviations(q)[:, 3:], skew, atol=1e-10)
    numpy.testing.assert_array_equal(abbe.nominal_poses(MILL, q).points_mm, nominal.points_mm)
    assert nominal.covered is None


def test_derivatives_agree_with_differences():
    q = commands(4)
    jacobian = MODEL.jacobian(q)
    assert jacobian.shape == (4, 6, len(ERRORS)) and MODEL.jacobian(q[0]).shape == (6, len(ERRORS))
    for p in (0, 7, len(ERRORS) - 8, len(ERRORS) - 1):
        step = 1e-4 if not ERRORS.is_angle[p] else 1e-7
        changed = []
        for sign in (1, -1):
            other = ERRORS.copy()
            values = other.values_mm_rad.copy()
            values[p] += sign * step
            other.values_mm_rad = values
            changed.append(abbe.PoseModel(other).deviations(q))
        numpy.testing.assert_allclose(jacobian[:, :3, p], (changed[0] - changed[1])[:, :3] / (2 * step), rtol=1e-5, atol=1e-5)
    by_commands = MODEL.jacobian_by_positions(q)
    for i, step in enumerate([1e-6, 1e-6, 1e-3, 1e-3, 1e-3]):
        shift = step * numpy.eye(5)[i]
        numpy.testing.assert_allclose(by_commands[:, :3, i], (MODEL.points(q + shift) - MODEL.points(q - shift)) / (2 * step),
                                      rtol=1e-5, atol=1e-6)


@pytest.mark.parametrize("positions", bad_arrays.GOOD_POSITIONS)
def test_other_forms_of_arrays(positions):
    numpy.testing.assert_array_equal(MODEL.points(positions), MODEL.points(numpy.ones((2, 5))))


@pytest.mark.parametrize("positions", bad_arrays.BAD_POSITIONS)
@pytest.mark.parametrize("call", [MODEL.poses, MODEL.deviations, MODEL.jacobian, abbe.CompensatedInverse(ERRORS).correct])
def test_bad_arrays_are_refused(call, positions):
    with pytest.raises((abbe.InputError, TypeError)):
        call(positions)
    with pytest.raises(TypeError):
        call(None)


@settings(max_examples=60, deadline=None)
@given(arrays.arrays(dtype=st.sampled_from(["f8", "f4", "i4", "u1", "c16", "U3", "O", "?", "M8[s]"]),
                     shape=arrays.array_shapes(min_dims=0, max_dims=3, min_side=0, max_side=6)))
def test_any_array_is_taken_or_refused(array):
    try:
        points = MODEL.points(array)
    except (abbe.InputError, TypeError):
        return
    assert points.shape == array.shape[:-1] + (3,)
    # Beyond what the errors cover there may be no number, but never one that is said to be covered.
    assert numpy.isfinite(points[numpy.asarray(MODEL.covered(array), bool)]).all()


def test_no_poses():
    assert MODEL.poses(numpy.zeros((0, 5))).points_mm.shape == (0, 3)
    assert MODEL.jacobian(numpy.zeros((0, 5))).shape == (0, 6, len(ERRORS))
    assert abbe.CompensatedInverse(ERRORS).correct(numpy.zeros((0, 5))).positions_mm_rad.shape == (0, 5)


def test_the_inverse_gives_back_the_commands():
    q = commands(30)
    pose = abbe.nominal_poses(MILL, q)
    found = abbe.inverse(MILL, pose.points_mm, directions=pose.rotations[:, :, 2], start_mm_rad=q)
    assert found.solved.all()
    numpy.testing.assert_allclose(abbe.nominal_poses(MILL, found.positions_mm_rad).points_mm, pose.points_mm, atol=1e-9)
    far = abbe.inverse(MILL, [[1e5, 0, 0]], directions=[[0, 0, 1]])
    assert not far.solved[0] and numpy.isnan(far.positions_mm_rad).all() and far.problems[0]
    for wrong in ({"directions": [[0, 0, 1]] * 2}, {"directions": [[0, 0, 1]], "rotations": [numpy.eye(3)]}, {"start_mm_rad": [1, 2]}):
        with pytest.raises(abbe.InputError):
            abbe.inverse(MILL, [[0, 0, 0]], **wrong)
    with pytest.raises(KeyError):
        abbe.inverse(MILL, [[0, 0, 0]], hold_mm_rad={"Q": 1})


def test_corrected_commands_bring_the_tool_where_it_should_be():
    q = commands(600) * 0.9
    inverse = abbe.CompensatedInverse(ERRORS, target="direction", largest_turn_deg=5)
    corrected = inverse.correct(q)
    assert corrected.reached.all()
    numpy.testing.assert_allclose(MODEL.points(corrected.positions_mm_rad), abbe.nominal_poses(MILL, q).points_mm, atol=1e-7)
    one = inverse.correct(q[3])
    numpy.testing.assert_array_equal(one.positions_mm_rad, corrected.positions_mm_rad[3])
    assert one.reached is True and abbe.CORRECTION_STATUSES[one.status] == "reached"
    pose = abbe.nominal_poses(MILL, q)
    reached = inverse.reach(q, pose.points_mm, directions=pose.rotations[:, :, 2])
    numpy.testing.assert_allclose(reached.positions_mm_rad, corrected.positions_mm_rad, atol=1e-6)
    for wrong in ({"target": "nowhere"}, {"largest_turn_deg": 0}, {"largest_turn_deg": 90}, {"largest_shift_mm": -1}):
        with pytest.raises(abbe.InputError):
            abbe.CompensatedInverse(ERRORS, **wrong)


def test_positions_with_names_and_units():
    q = abbe.positions(MILL, C_deg=[0, 90], X_mm=5, Y_um=1000)
    numpy.testing.assert_allclose(q, [[0, 0, 5, 1, 0], [numpy.pi / 2, 0, 5, 1, 0]])
    assert abbe.grid(MILL, C_deg=range(0, 360, 90), X_mm=[0, 1, 2]).shape == (12, 5)
    for wrong in ({"C_mm": 1}, {"X": 1}, {"Q_mm": 1}, {"X_mm": 1, "X_um": 1}):
        with pytest.raises(abbe.InputError):
            abbe.positions(MILL, **wrong)
    with pytest.raises(ValueError):
        abbe.positions(MILL, X_mm=[1, 2], Y_mm=[1, 2, 3])
