"""Arrays in and out: results written over earlier ones, numbers that are not finite among many."""

import numpy
import pytest

import abbe

pytestmark = pytest.mark.bad_input  # also run under the address sanitizer (CMakeLists.txt)

MILL = abbe.Machine.from_chain("w C' X' Y' b Z t")
MODEL = abbe.PoseModel(abbe.Errors.random(MILL, seed=4, mean_volumetric_um=40))


def commands(count, seed=0):
    return numpy.random.default_rng(seed).uniform(-3, 3, (count, 4))


@pytest.mark.parametrize("count", [0, 1, 5, 6, 512, 513, 20_000, 400_000])
def test_results_are_written_over(count):
    first, second = commands(count), commands(count, seed=1)
    for calls in (MODEL.poses, MODEL.nominal_poses):
        kept, expected = calls(first), calls(second)
        points, rotations = kept.points_mm, kept.rotations
        assert calls(second, out=kept) is kept and kept.points_mm is points and kept.rotations is rotations
        assert numpy.array_equal(points, expected.points_mm) and numpy.array_equal(rotations, expected.rotations)
    alone = MODEL.points(first)
    assert MODEL.points(second, out=alone) is alone and numpy.array_equal(alone, MODEL.points(second))
    own = numpy.empty((count, 3), order="F")
    assert MODEL.points(second, out=own) is own and numpy.array_equal(own, alone)


def test_coverage_is_written_over():
    limited = abbe.Errors(MILL)
    limited.add_motion("EXX", basis="table-linear", nodes_mm=[-1, 1], coefficients_um=[1, 2])
    model = abbe.PoseModel(limited)
    inside, outside = numpy.zeros((3, 4)), numpy.full((3, 4), 2.0)
    poses = model.poses(inside)
    covered = poses.covered
    assert covered.dtype == bool and covered.all()
    model.poses(outside, out=poses)
    assert not covered.any()


def read_only(array):
    array.flags.writeable = False
    return array


@pytest.mark.parametrize("out", [
    numpy.empty((4, 3), order="F"), numpy.empty((5, 3)), numpy.empty((5, 3), dtype="f4", order="F"), numpy.empty(15),
    numpy.empty((5, 3), dtype=">f8", order="F"), read_only(numpy.empty((5, 3), order="F")), [[0, 0, 0]] * 5,
    numpy.empty((10, 3), order="F")[::2], "text", 3,
])
def test_points_are_not_written_into_anything_else(out):
    with pytest.raises(abbe.InputError, match="out: has another shape or order"):
        MODEL.points(commands(5), out=out)


def test_poses_are_not_written_into_others():
    with pytest.raises(abbe.InputError, match="out: has another shape or order"):
        MODEL.poses(commands(5), out=MODEL.poses(commands(6)))
    with pytest.raises(abbe.InputError, match="out: has another shape or order, or is read-only; expected a result of poses"):
        MODEL.poses(commands(5), out=MODEL.nominal_poses(commands(5)))  # which state no coverage
    with pytest.raises(abbe.InputError, match="out: has another shape or order"):
        MODEL.nominal_poses(commands(5), out=MODEL.poses(commands(5)))  # whose coverage would be that of other poses
    with pytest.raises(abbe.InputError, match="out: is given for a single pose"):
        MODEL.poses(commands(1)[0], out=MODEL.poses(commands(1)[0]))
    with pytest.raises(abbe.InputError, match="out: is given for a single pose"):
        MODEL.points(commands(1)[0], out=numpy.empty(3))
    frozen = MODEL.poses(commands(5))
    read_only(frozen.points_mm)
    with pytest.raises(abbe.InputError, match="out"):
        MODEL.poses(commands(5), out=frozen)
    with pytest.raises(TypeError):
        MODEL.poses(commands(5), out=numpy.empty((5, 3)))


@pytest.mark.parametrize("count", [5, 20_000])
@pytest.mark.parametrize("place", ["first", "last", "same"])
def test_commands_are_not_written_over(count, place):
    memory = numpy.zeros(11 * count)
    q, before = memory[3 * count:7 * count].reshape((count, 4), order="F"), commands(count)
    q[:] = before
    # The last number of `out` is the first command, or the first is the last command, or both begin together.
    start = {"first": 1, "last": 7 * count - 1, "same": 3 * count}[place]
    with pytest.raises(abbe.InputError, match="out: shares memory with positions_mm_rad"):
        MODEL.points(q, out=memory[start:start + 3 * count].reshape((count, 3), order="F"))
    assert numpy.array_equal(q, before)
    beside = memory[7 * count:10 * count].reshape((count, 3), order="F")
    assert numpy.array_equal(MODEL.points(q, out=beside), MODEL.points(before))


@pytest.mark.parametrize("order", ["C", "F"])
@pytest.mark.parametrize("bad", [numpy.nan, numpy.inf, -numpy.inf])
@pytest.mark.parametrize("pose", [0, 511, 512, 30_001, 99_999])
def test_the_first_of_many_numbers_that_is_not_finite_is_named(order, bad, pose):
    q = numpy.asarray(commands(100_000), order=order)
    q[pose, 2] = bad
    q[99_999, 3] = numpy.nan
    with pytest.raises(abbe.InputError) as raised:
        MODEL.poses(q)
    assert raised.value.field == "positions_mm_rad" and f"pose {pose}, axis Y: {bad:g}".replace("inf", "inf") in str(raised.value)


def test_large_finite_numbers_are_finite():
    q = commands(2000)
    q[1500] = [1e300, -1e300, 1e-320, 5e-324]
    assert len(MODEL.points(q)) == 2000
