"""Readings of position and orientation in arrays: what was not measured is NaN, and no orientation is made up."""

import numpy
import pytest

import abbe

#: Also run under the address sanitizer (CMakeLists.txt).
pytestmark = pytest.mark.bad_input


def cameras(machine):
    return abbe.instrument("pose-tracker", machine, mounted_on="bed", noise={"xyz_um": 4, "turn_arcsec": 5},
                           pose={"position_mm": [0, -900, 300], "angles_deg": [0, 0, 90]},
                           target=[{"name": "spindle", "offset_mm": [0, 0, 0], "angles_deg": [0, 0, 0]}])


@pytest.fixture
def five_axes(examples):
    return abbe.Machine.read(examples / "machines/trunnion-mill.machine.toml")


@pytest.fixture
def commands(five_axes):
    return abbe.grid(five_axes, X_mm=[-50, 0, 50], Y_mm=[0], Z_mm=[-20, 0])


def test_a_plan_needs_no_orientation(five_axes, commands):
    instrument = cameras(five_axes)
    assert instrument.inputs == ["qw", "qx", "qy", "qz"]
    nothing, missing = abbe.Readings(instrument, commands), numpy.full((len(commands), 4), numpy.nan)
    assert numpy.isnan(nothing.inputs_mm_rad).all() and nothing.measured_mm_rad is None
    given = abbe.Readings(instrument, commands, inputs_mm_rad=missing)
    partly = missing.copy()
    partly[0] = [1, 0, 0, 0]
    assert numpy.array_equal(abbe.Readings(instrument, commands, inputs_mm_rad=partly).inputs_mm_rad, partly, equal_nan=True)
    with pytest.raises(abbe.InputError, match="a plan"):
        nothing.csv()
    errors = abbe.Errors(five_axes)
    read = nothing.simulate(errors, seed=3)
    assert numpy.allclose(numpy.linalg.norm(read.inputs_mm_rad, axis=1), 1)
    assert numpy.array_equal(read.inputs_mm_rad, given.simulate(errors, seed=3).inputs_mm_rad)
    again = abbe.Readings(instrument, commands, read.measured_mm_rad, inputs_mm_rad=read.inputs_mm_rad)
    assert numpy.array_equal(again.inputs_mm_rad, read.inputs_mm_rad) and "qw,qx,qy,qz" in again.csv()
    assert len(abbe.Readings(instrument, commands[:0])) == 0


@pytest.mark.parametrize("row, words", [
    ([0, 0, 0, 0], "row 2: the quaternion has the length 0; "),
    ([numpy.nan] * 4, "row 2: the orientation is missing"),
    ([1, 0, numpy.nan, 0], "row 2: the orientation is missing"),
    ([1, 1, 0, 0], "row 2: the quaternion has the length 1.41421"),
    ([0.99, 0, 0, 0], "row 2: the quaternion has the length 0.99"),
    ([numpy.inf, 0, 0, 0], "row 2: the quaternion has the length inf"),
])
def test_an_orientation_that_was_not_measured_is_refused(row, words, five_axes, commands):
    instrument = cameras(five_axes)
    read = abbe.Readings(instrument, commands).simulate(abbe.Errors(five_axes))
    inputs = read.inputs_mm_rad.copy()
    inputs[2] = row
    with pytest.raises(abbe.InputError) as error:
        abbe.Readings(instrument, commands, read.measured_mm_rad, inputs_mm_rad=inputs)
    assert error.value.field == "inputs_mm_rad" and words.rstrip("; ") in str(error.value)


@pytest.mark.parametrize("row", [[0, 0, 0, 0], [1, numpy.nan, 0, 0], [2, 0, 0, 0]])
def test_a_plan_refuses_what_is_neither_an_orientation_nor_missing(row, five_axes, commands):
    inputs = numpy.full((len(commands), 4), numpy.nan)
    inputs[1] = row
    with pytest.raises(abbe.InputError, match="row 1: the quaternion has the length") as error:
        abbe.Readings(cameras(five_axes), commands, inputs_mm_rad=inputs)
    assert error.value.field == "inputs_mm_rad"


def test_readings_without_their_orientations_are_refused(five_axes, commands):
    with pytest.raises(abbe.InputError, match="inputs"):
        abbe.Readings(cameras(five_axes), commands, numpy.zeros((len(commands), 6)))
    for shape in ((len(commands), 3), (4,), (len(commands) - 1, 4)):
        with pytest.raises(abbe.InputError, match="inputs_mm_rad"):
            abbe.Readings(cameras(five_axes), commands, numpy.zeros((len(commands), 6)), inputs_mm_rad=numpy.ones(shape))
