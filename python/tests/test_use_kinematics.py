"""Kinematic values for controls, against the command."""

import numpy
import pytest
from use_examples import EXAMPLES, command, command_json, mill, trunnion

import abbe

KINEMATICS = ["compensate", "kinematics", "--machine", EXAMPLES / "machines/trunnion-mill.machine.toml", "--errors",
              EXAMPLES / "compensate/trunnion.errors.toml", "--positions", "3"]


@pytest.mark.parametrize(("format_", "options", "keywords"), [
    ("values", [], {}),
    ("linuxcnc", ["--limit-um", "100", "--limit-urad", "200"], {"limit_um": 100, "limit_urad": 200}),
    ("siemens", ["--tool-carrier", "3"], {"tool_carrier": 3}),
    ("fanuc", ["--least-reduction-percent", "5"], {"least_reduction_percent": 5}),
])
def test_values_are_those_of_the_command(format_, options, keywords, tmp_path):
    arguments = [*KINEMATICS, "--for", format_, *options, "-o", "file"]
    values = abbe.kinematic_values(trunnion(), format_, positions=3, **keywords)
    assert not values.says_no, values.refused
    assert values.text(["file"]) == command(arguments, tmp_path)
    assert (tmp_path / "file").read_text() == values.file
    assert values.to_dict(["file"]) == command_json(arguments, tmp_path)
    values.write(tmp_path / values.file_name)
    assert (tmp_path / values.file_name).read_bytes() == (tmp_path / "file").read_bytes()
    with pytest.raises(FileExistsError):
        values.write(tmp_path / values.file_name)
    assert values.format.name == format_ and values.settings == values.to_dict()["settings"]
    assert values.after.position_statistics_mm.rms < 0.85 * values.before.position_statistics_mm.rms
    assert values.positions_mm_rad.shape == (3**5, 5) and values.grid == [3] * 5 and values.ideal_not_reached == 0
    assert values.left_by_values_mm.count == 3**5 and values.partial.known > 0


def test_a_value_is_the_axis_with_its_location_errors():
    errors = trunnion()
    values = abbe.kinematic_values(errors, "values", positions=3)
    found = {value.name: value for value in values.values}
    axis = errors.machine.axes[errors.machine.axis_names.index("C")]
    shift = 1e3 * (values["C,machine,x_mm"].actual_mm_rad - axis.point_mm[0])
    assert shift == pytest.approx(14, abs=1e-3) and values["C,machine,x_mm"].kind == "length"
    assert values["C,machine,x_mm"].standard_uncertainty_mm_rad == pytest.approx(0.8e-3)
    assert len(values) == len(found) and {value.kind for value in found.values()} == {"length", "direction", "angle"}
    carried = {error.name: error.carried for error in values.errors}
    assert carried["EX0C"] == pytest.approx(1, abs=1e-3) and carried["EXX"] == pytest.approx(0, abs=1e-3)
    with pytest.raises(KeyError, match="nothing"):
        values["nothing"]


def test_values_that_must_not_be_used(tmp_path):
    values = abbe.kinematic_values(trunnion(), "siemens", positions=3, limit_um=10)
    assert values.says_no and values.file is None and values.file_name == "TRAFO5.INI"
    assert values.refused and all("is above limit_um 10: $MC_TRAFO5_" in reason for reason in values.refused)
    with pytest.raises(abbe.InputError, match="nothing is written"):
        values.write(tmp_path / "x")
    assert values.to_dict() == command_json([*KINEMATICS, "--for", "siemens", "--limit-um", "10", "-o", "f"], tmp_path, 1)
    few = abbe.Errors(trunnion().machine)
    few.add_motion("EXX", coefficients_um=[0, 20])
    none = abbe.kinematic_values(few, "values", positions=3)
    assert none.says_no and "less than least_reduction_percent 1" in none.refused[0]
    assert not abbe.kinematic_values(few, "values", positions=3, least_reduction_percent=0).says_no
    assert none.partial.is_partial and numpy.allclose(none.after.position_mm, none.before.position_mm, atol=1e-9)


@pytest.mark.parametrize(("format_", "keywords", "field"), [
    ("mazak", {}, "format"), ("linuxcnc", {"tool_carrier": 3}, "tool_carrier"), ("siemens", {"tool_carrier": 0}, "tool_carrier"),
    ("values", {"limit_um": 0}, "limit_um"), ("values", {"limit_urad": float("nan")}, "limit_urad"),
    ("values", {"least_reduction_percent": 101}, "least_reduction_percent"),
    ("values", {"least_reduction_percent": float("nan")}, "least_reduction_percent"), ("values", {"positions": 1}, "positions"),
])
def test_bad_arguments_are_named(format_, keywords, field):
    with pytest.raises(abbe.InputError) as error:
        abbe.kinematic_values(trunnion(), format_, **keywords)
    assert error.value.field.split()[0] == field and "--" not in str(error.value), error.value


def test_formats_and_machines_that_a_control_does_not_have():
    formats = {one.name: one for one in abbe.kinematic_formats()}
    assert list(formats) == ["values", "linuxcnc", "siemens", "fanuc", "heidenhain"]
    assert formats["values"].unverified == "" and formats["siemens"].unverified and formats["fanuc"].cannot
    for name in formats:
        with pytest.raises(abbe.InputError):
            abbe.kinematic_values(mill(), name)
    with pytest.raises(TypeError):
        abbe.kinematic_values(trunnion(), "values", positions=-1)


def test_uncertainties_that_the_errors_do_not_state():
    errors = abbe.Errors(trunnion().machine)
    errors.add_location("EX0C", value_um=20)
    values = abbe.kinematic_values(errors, "values", positions=3)
    assert values["C,machine,x_mm"].standard_uncertainty_mm_rad is None
    assert numpy.isfinite(values["C,machine,x_mm"].nominal_mm_rad)
