"""Frozen compensations: the file of the command, and what a control computes with it."""

import pathlib
import pickle

import abbe
import numpy
import pytest
from use_examples import EXAMPLES, command, command_json, mill, trunnion


@pytest.fixture(scope="module")
def frozen():
    return abbe.freeze(mill(), limit_um=500, errors_file="mill.errors.toml")


def test_the_file_and_the_texts_are_those_of_the_command(frozen, tmp_path):
    arguments = ["compensate", "freeze", "--machine", EXAMPLES / "machines/three-axis-mill.machine.toml", "--errors",
                 "mill.errors.toml", "--limit-um", "500", "-o", "mill.abbec"]
    (tmp_path / "mill.errors.toml").write_text((EXAMPLES / "compensate/mill.errors.toml").read_text())
    assert frozen.text("mill.abbec") == command(arguments, tmp_path)
    assert (tmp_path / "mill.abbec").read_bytes() == frozen.bytes
    assert frozen.to_dict("mill.abbec") == command_json(arguments, tmp_path)
    frozen.write(tmp_path / "own.abbec")
    assert (tmp_path / "own.abbec").read_bytes() == frozen.bytes
    with pytest.raises(FileExistsError):
        frozen.write(tmp_path / "own.abbec")
    frozen.write(tmp_path / "own.abbec", overwrite=True)


def test_figures_are_those_of_the_json(frozen):
    json = frozen.to_dict()
    assert frozen.refused == ""
    assert 1e3 * frozen.largest_correction_mm == json["largest_correction_um"]
    assert f"{frozen.checksum:016x}" == json["checksum"]
    assert frozen.accuracy_mm == json["accuracy_mm"]
    assert 1e3 * frozen.mean_uncertainty_mm == json["mean_standard_uncertainty_um"]
    assert frozen.where_mm_rad.shape == (3,) and frozen.largest_joint_at_mm_rad.shape == (3, 3)
    assert frozen.left_out.names == []


def test_a_refused_file_is_not_written(tmp_path):
    refused = abbe.freeze(mill(), limit_um=1)
    assert "above --limit-um 1" in refused.refused
    with pytest.raises(abbe.InputError, match="above limit_um 1.*nothing is written"):
        refused.write(tmp_path / "x.abbec")
    assert not (tmp_path / "x.abbec").exists()


def test_corrections_are_those_of_the_header_and_of_the_full_model(frozen):
    compensation = abbe.FrozenCompensation(frozen.bytes)
    one = compensation.correct([600, 400, -100])
    full = abbe.CompensatedInverse(mill()).correct([[600, 400, -100]])
    assert numpy.abs(one.positions_mm_rad - full.positions_mm_rad).max() < 1e-6
    assert one.status == 0 and one.reached and not one.outside_map and compensation.status_text(one.status) == "ok"
    stated = abbe.correct_commands(mill(), [[600, 400, -100]]).uncertainty_mm[0]
    assert compensation.uncertainty([600, 400, -100]).uncertainty_mm >= 0.95 * stated
    positions = numpy.random.default_rng(1).uniform([0, 0, -300], [700, 440, 0], (20000, 3))
    full = abbe.CompensatedInverse(mill()).correct(positions)
    fast = compensation(positions)
    ok = full.reached & (fast.status == 0)
    assert ok.mean() > 0.9
    assert numpy.abs(full.positions_mm_rad - fast.positions_mm_rad)[ok].max() < 1e-6
    assert fast.iterations.max() <= 40


def test_uncorrect_and_forward_are_the_exact_inverses():
    compensation = abbe.freeze(trunnion(), errors_file="trunnion.errors.toml").compensation()
    machine = trunnion().machine
    rng = numpy.random.default_rng(2)
    nominal = numpy.column_stack([rng.uniform(-0.3, 0.3, 1000) for _ in machine.axes])
    joints = compensation.correct(nominal, tool_mm=[0, 0, -100])
    back = compensation.uncorrect(joints.positions_mm_rad, tool_mm=[0, 0, -100])
    assert numpy.abs(back.positions_mm_rad - nominal).max() < 1e-8
    assert compensation.tool_centre
    points = compensation.forward(joints.positions_mm_rad, tool_mm=[0, 0, -100])
    again = compensation.inverse(points.points_mm, points.words_mm_rad, tool_mm=[0, 0, -100])
    assert numpy.abs(again.positions_mm_rad - joints.positions_mm_rad).max() < 1e-8
    off = compensation.correct(nominal, enable=0)
    assert numpy.abs(off.positions_mm_rad - nominal).max() < 1e-9


def test_tools_may_differ_pose_by_pose(frozen):
    compensation = frozen.compensation()
    positions = numpy.tile([100.0, 100.0, -100.0], (3, 1))
    tools = numpy.array([[0, 0, 0], [0, 0, -100], [0, 0, -500.0]])
    together = compensation.correct(positions, tool_mm=tools)
    for k in range(3):
        one = compensation.correct(positions[k], tool_mm=tools[k])
        assert numpy.abs(one.positions_mm_rad - together.positions_mm_rad[k]).max() < 1e-11
    assert together.outside_tool.tolist() == [False, False, True]
    assert compensation.tool_of_offset([0, 0, 50]) == [0, 0, -50]


def test_information_and_pickles(frozen):
    compensation = pickle.loads(pickle.dumps(frozen.compensation()))
    assert compensation.bytes == frozen.bytes
    assert [axis.name for axis in compensation.axes] == mill().machine.axis_names
    assert compensation.axes[0].kind == "linear" and compensation.axes[0].solved
    assert compensation.checksum == frozen.checksum and compensation.has_uncertainty
    assert compensation.largest_correction_mm == frozen.largest_correction_mm


def test_arrays_of_any_layout_give_the_same(frozen):
    compensation = frozen.compensation()
    positions = numpy.random.default_rng(3).uniform(0, 100, (50, 3)) * [1, 1, -1]
    wanted = compensation.correct(positions).positions_mm_rad.tolist()
    assert compensation.correct(numpy.asfortranarray(positions)).positions_mm_rad.tolist() == wanted
    wide = numpy.zeros((100, 6))
    wide[::2, ::2] = positions
    assert compensation.correct(wide[::2, ::2]).positions_mm_rad.tolist() == wanted
    assert compensation.correct(numpy.zeros((0, 3))).positions_mm_rad.shape == (0, 3)
    assert compensation.correct(numpy.array([[1, 2, -3]])).positions_mm_rad.dtype == float


@pytest.mark.parametrize("positions", [[[1, 2]], 5, [[[1, 2, 3]]], "text", [[1j, 0, 0]], [[numpy.nan, 0, 0]],
                                       [["a", "b", "c"]], None])
def test_bad_positions_are_named(frozen, positions):
    with pytest.raises((abbe.InputError, TypeError)):
        frozen.compensation().correct(positions)


def test_bad_input_is_named(frozen):
    compensation = frozen.compensation()
    with pytest.raises(abbe.InputError, match="enable"):
        compensation.correct([0, 0, 0], enable=2)
    with pytest.raises(abbe.InputError, match="tool_mm"):
        compensation.correct([[0, 0, 0]], tool_mm=[[0, 0, 0], [0, 0, 0]])
    for bytes_ in (b"", b"nonsense", frozen.bytes[:-1], frozen.bytes[:100] + b"x" + frozen.bytes[101:]):
        with pytest.raises(abbe.InputError):
            abbe.FrozenCompensation(bytes_)
    with pytest.raises(abbe.InputError, match="missing.abbec"):
        abbe.FrozenCompensation.read("missing.abbec")
    for bad in ({"world": "moon"}, {"limit_um": 0}, {"tool_length_mm": (300, 0)}, {"largest_turn_deg": 50},
                {"tool_mm": (0, 0, float("nan"))}, {"leave_out_below_uncertainty": -1}):
        with pytest.raises(abbe.InputError, match=next(iter(bad))):
            abbe.freeze(mill(), **bad)


def test_far_commands_have_no_result(frozen):
    far = frozen.compensation().correct([[1e7, 0, 0], [0, 0, 0]])
    assert far.status[0] == -1 and not far.computed[0] and far.computed[1]
    assert numpy.isnan(far.positions_mm_rad[0]).all()


def test_distrusted_errors_are_refused():
    text = (EXAMPLES / "compensate/mill.errors.toml").read_text()
    errors = abbe.Errors.parse('distrusted = ["it does not fit"]\n' + text, mill().machine)
    if not errors.distrusted:
        pytest.skip("the key is another one")
    with pytest.raises(abbe.InputError, match="accept_misfit"):
        abbe.freeze(errors)
    with pytest.warns(UserWarning, match="not to be trusted"):
        abbe.freeze(errors, accept_misfit=True)
