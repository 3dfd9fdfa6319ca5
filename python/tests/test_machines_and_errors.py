"""Machines and errors: files, values, and what is refused."""

import copy
import pickle

import numpy
import pytest

import abbe


def test_a_machine_of_a_chain_can_be_changed_and_written(tmp_path):
    mill = abbe.Machine.from_chain("w C' A' Y' b X Z t")
    mill.axis("A").point_mm = (0, 0, -50)
    mill.axis("A").travel_deg = (-100, 30)
    mill.tool_offset_mm = numpy.array([0, 0, -120])
    file = tmp_path / "mill.machine.toml"
    mill.write(file)
    again = abbe.Machine.read(file)
    assert again == mill and again.axis("A").travel_deg == pytest.approx((-100, 30))
    numpy.testing.assert_array_equal(again.axes[1].point_mm, [0, 0, -50])
    with pytest.raises(FileExistsError):
        mill.write(file)
    mill.write(file, overwrite=True)
    assert pickle.loads(pickle.dumps(mill)) == mill


def test_changes_of_a_copy_leave_the_machine_alone():
    mill = abbe.Machine.from_chain("w X' b Z t")
    other = mill.copy()
    other.axis("X").travel_mm = (0, 1)
    assert mill.axis("X").travel_mm == (-250, 250)
    assert copy.copy(other) == other


def test_the_place_of_a_mistake_is_named():
    with pytest.raises(abbe.InputError) as caught:
        abbe.Machine.parse("name = \"m\"\nchain = \"w X' b Z t\"\n[axis.X]\ntravel_kg = [0, 1]\n", "saw.toml")
    assert (caught.value.file, caught.value.line, caught.value.field) == ("saw.toml", 4, "axis.X.travel_kg")
    assert "travel_mm" in str(caught.value.expected) and isinstance(caught.value, ValueError)
    with pytest.raises(abbe.InputError, match="saw"):
        abbe.Machine.read("saw.machine.toml")
    with pytest.raises(abbe.InputError, match="chain"):
        abbe.Machine.from_chain("w c b t")


def test_other_mistakes():
    mill = abbe.Machine.from_chain("w C' b X Z t")
    with pytest.raises(KeyError):
        mill.axis("Q")
    with pytest.raises(AttributeError, match="travel_deg"):
        mill.axis("C").travel_mm
    with pytest.raises(TypeError):
        mill.axis("C").point_mm = (1, 2)
    for wrong in (numpy.zeros((3, 3)), numpy.diag([1, 1, 1, 2])):
        with pytest.raises(abbe.InputError):
            mill.bed_from_workpiece = wrong
    mill.axis("X").direction = (0, 0, 2)
    assert any("length 2" in problem for problem in mill.problems())
    with pytest.raises(abbe.InputError, match="length 2"):
        abbe.Errors(mill)


def test_errors_have_names_values_and_uncertainties(trunnion, tmp_path):
    assert len(trunnion.names) == len(trunnion) == len(trunnion.values_mm_rad) == len(trunnion.is_angle)
    file = tmp_path / "errors.toml"
    trunnion.write(file)
    again = abbe.Errors.read(file, trunnion.machine)
    numpy.testing.assert_array_equal(again.values_mm_rad, trunnion.values_mm_rad)
    again.values_mm_rad = 2 * trunnion.values_mm_rad
    numpy.testing.assert_array_equal(again.values_mm_rad, 2 * trunnion.values_mm_rad)
    with pytest.raises(FileExistsError):
        trunnion.write(file)


def test_errors_made_in_code():
    mill = abbe.Machine.from_chain("w X' Y' b Z t")
    errors = abbe.Errors(mill)
    errors.add_motion("EXX", "table-linear", coefficients_um=[0, 4, 2], nodes_mm=[-250, 0, 250])
    errors.add_motion("EAX", coefficients_urad=[1, 2])
    errors.add_motion("EYY", "fourier", coefficients_um=[1, 2, 3], period_mm=10)
    errors.add_location("EC0Y", value_urad=20, u_urad=2)
    errors.set_reversal("X", value_um=-3)
    numpy.testing.assert_allclose(errors.evaluate("X", [0, 125, 250])[:, 0], [0.004, 0.003, 0.002], atol=1e-15)
    assert "reversal_X" in errors.names
    assert errors.standard_uncertainties_mm_rad[errors.names.index("EC0Y")] == pytest.approx(2e-6)
    covariance = numpy.diag(numpy.full(len(errors), 1e-6))
    errors.covariance = covariance
    numpy.testing.assert_array_equal(errors.covariance, covariance)
    assert errors.evaluate_uncertainty("X", [0.0])[0, 0] == pytest.approx(1e-3)
    errors.covariance = None
    assert errors.covariance is None


@pytest.mark.parametrize("call", [
    lambda e: e.add_motion("EXQ", coefficients_um=[1]), lambda e: e.add_motion("EC0Y", coefficients_um=[1]),
    lambda e: e.add_motion("EXX", coefficients_urad=[1]), lambda e: e.add_motion("EXX"),
    lambda e: e.add_motion("EXX", coefficients_um=[]), lambda e: e.add_motion("EXX", "cubic", coefficients_um=[1]),
    lambda e: e.add_motion("EXX", "bspline", coefficients_um=[1]), lambda e: e.add_motion("EXX", "fourier", coefficients_um=[1, 2]),
    lambda e: e.add_motion("EXX", "table-linear", coefficients_um=[1, 2], nodes_mm=[1, 0]),
    lambda e: e.add_motion("EXX", coefficients_um=[1], range_mm=[1, 0]), lambda e: e.add_motion("EXX", coefficients_um=[1], range_deg=[0, 1]),
    lambda e: e.add_location("EC0Y", value_um=1), lambda e: e.add_location("EA0X", value_urad=1),
    lambda e: e.add_location("EC0Y", value_urad=1, u_urad=-1), lambda e: e.set_reversal("X", value_urad=1),
    lambda e: setattr(e, "values_mm_rad", [1, 2]), lambda e: setattr(e, "values_mm_rad", [numpy.nan] * len(e)),
    lambda e: setattr(e, "covariance", numpy.zeros((2, 2))), lambda e: setattr(e, "covariance", numpy.triu(numpy.ones((3, 3)))),
    lambda e: e.evaluate("X", [[1, 2]]), lambda e: abbe.Errors.random(e.machine, mean_volumetric_um=0),
])
def test_errors_that_make_no_sense_are_refused(call):
    errors = abbe.Errors(abbe.Machine.from_chain("w X' Y' b Z t"))
    with pytest.raises(abbe.InputError):
        call(errors)


def test_random_errors_have_their_size_and_seed(trunnion):
    one = abbe.Errors.random(trunnion.machine, seed=4, mean_volumetric_um=30)
    numpy.testing.assert_array_equal(one.values_mm_rad, abbe.Errors.random(trunnion.machine, seed=4, mean_volumetric_um=30).values_mm_rad)
    assert not numpy.array_equal(one.values_mm_rad, abbe.Errors.random(trunnion.machine, seed=5).values_mm_rad)
