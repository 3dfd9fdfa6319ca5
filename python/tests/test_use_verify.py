"""Maps of errors and verifications, against the command."""

import pickle

import abbe
import numpy
import pytest
from use_examples import EXAMPLES, command, command_json, machine, mill, trunnion

MILL = ["--machine", EXAMPLES / "machines/three-axis-mill.machine.toml", "--errors",
        EXAMPLES / "compensate/mill.errors.toml"]
TRUNNION = ["--machine", EXAMPLES / "machines/trunnion-mill.machine.toml", "--errors",
            EXAMPLES / "compensate/trunnion.errors.toml"]


def truth():
    return abbe.Errors.read(EXAMPLES / "verify/truth.errors.toml", machine("trunnion-mill"))


def test_the_map_is_that_of_the_command(tmp_path):
    result = abbe.map_errors(mill())
    arguments = ["map", *MILL, "-o", "map.csv", "-o", "map.vts"]
    assert result.text() + "map.csv written\nmap.vts written\n" == command(arguments, tmp_path)
    assert result.to_dict() == command_json(arguments, tmp_path)
    assert result.csv() == (tmp_path / "map.csv").read_text() and result.vtk() == (tmp_path / "map.vts").read_bytes()
    result.write(tmp_path / "own.vts")
    assert (tmp_path / "own.vts").read_bytes() == result.vtk()
    with pytest.raises(abbe.InputError, match=".vts for these poses"):
        result.write(tmp_path / "own.vtu")


def test_maps_with_a_grid_a_correction_and_the_datum_kept(tmp_path):
    wanted = command_json(["map", *TRUNNION[:2], "--errors", EXAMPLES / "verify/truth.errors.toml", "--minus",
                           EXAMPLES / "compensate/trunnion.errors.toml", "--grid", "X_mm=-100:100:3", "--grid",
                           "C_deg=30", "--keep-datum"], tmp_path)
    result = abbe.map_errors(truth(), minus=trunnion(), grid={"X_mm": (-100, 100, 3), "C_deg": 30}, keep_datum=True)
    assert result.to_dict() == wanted
    assert result.after.statistics_mm.mean < result.before.statistics_mm.mean and result.figures is None
    assert numpy.array_equal(result.before.removed, numpy.eye(4))


def test_arrays_of_a_map_agree_with_the_model():
    positions = numpy.random.default_rng(1).uniform([0, 0, -300], [700, 440, 0], (300, 3))
    result = abbe.map_errors(mill(), positions_mm_rad=positions, keep_datum=True)
    assert numpy.array_equal(result.positions_mm_rad, positions)
    before, deviations = result.before, abbe.PoseModel(mill()).deviations(positions)
    assert numpy.allclose(before.displacement_mm, deviations[:, :3], atol=1e-9)
    assert numpy.allclose(before.rotation_rad, deviations[:, 3:], atol=1e-9)
    assert numpy.allclose(before.norm_mm, numpy.linalg.norm(before.displacement_mm, axis=1))
    assert before.uncertainty_mm_rad.shape == (300, 6) and (before.norm_uncertainty_mm > 0).all()
    assert before.covered.dtype == bool and len(before) == 300 and result.poses_words == "300 poses"
    assert not before.norm_mm.flags.writeable


def test_views_live_as_long_as_they_are_used():
    norm = abbe.map_errors(mill(), grid={"X_mm": (0, 100, 30)}).before.norm_mm
    assert numpy.isfinite(norm).all() and len(norm) == 30 * 81


def test_shares_add_up_and_statistics_are_those_of_the_map():
    result = abbe.map_errors(mill())
    for shares in (abbe.shares_by_axis(mill(), result.positions_mm_rad), abbe.shares_by_kind(mill(), result.positions_mm_rad)):
        assert sum(share.share for share in shares) == pytest.approx(1, abs=1e-3)
    assert [share.name for share in abbe.shares_by_axis(mill(), result.positions_mm_rad)][:3] == mill().machine.axis_names
    streamed = abbe.map_statistics(mill())
    assert streamed.count == 729 and streamed.mean == pytest.approx(result.before.statistics_mm.mean, rel=0.1)
    figures = abbe.volumetric_figures(mill())
    assert figures.predicted_before_mm.mean == result.figures.predicted_before_mm.mean and figures.true_before_mm is None
    assert abbe.volumetric_figures(trunnion(), truth=truth()).true_after_mm.mean > 0


def test_bad_maps_are_named():
    for bad in ({"grid": {"Q_mm": 1}}, {"grid": {"X_mm": (0, 100, 1)}}, {"grid": {"X_mm": (0, 100)}},
                {"grid": {"X_deg": 1}}, {"grid": {"X_mm": (0, float("nan"), 3)}},
                {"grid": {"X_mm": (0, 100, 100000), "Y_mm": (0, 100, 100000)}}, {"minus": trunnion()},
                {"positions_mm_rad": [[1, 2]]}, {"positions_mm_rad": [[1, 2, numpy.nan]]}, {"positions_mm_rad": [0, 0, 0]},
                {"positions_mm_rad": "x"}):
        with pytest.raises((abbe.InputError, TypeError)) as error:
            abbe.map_errors(mill(), **bad)
        assert next(iter(bad)) in str(error.value)
    with pytest.raises(TypeError):
        abbe.map_errors(mill(), grid={"X_mm": "0:1:2"})
    assert abbe.map_errors(mill(), positions_mm_rad=numpy.zeros((0, 3)), keep_datum=True).before.norm_mm.shape == (0,)
    assert abbe.map_errors(mill(), positions_mm_rad=numpy.zeros((2, 3), int)[::-1], keep_datum=True).before


def test_the_verification_is_that_of_the_command(tmp_path):
    arguments = ["verify", *TRUNNION, "--truth", EXAMPLES / "verify/truth.errors.toml", "--least-reduction", "10",
                 "--poses", "200", "--seed", "3", "--range", "X_mm=-100:100", "-o", "page.html", "cone-frustum",
                 "--before", EXAMPLES / "verify/cone-before.csv", "--after", EXAMPLES / "verify/cone-after.csv"]
    mill5 = machine("trunnion-mill")
    traces = [abbe.Trace.read(EXAMPLES / f"verify/cone-{when}.csv", mill5) for when in ("before", "after")]
    result = abbe.verify(trunnion(), truth(), poses=200, seed=3, ranges={"X_mm": (-100, 100)}, least_reduction=10,
                         pieces=[(abbe.ConeFrustum(), *traces)],
                         errors_file=str(EXAMPLES / "compensate/trunnion.errors.toml"),
                         truth_file=str(EXAMPLES / "verify/truth.errors.toml"))
    assert result.text() + "\npage: page.html\n" == command(arguments, tmp_path)
    assert result.to_dict() == command_json(arguments, tmp_path)
    assert result.page_html() == (tmp_path / "page.html").read_text()
    assert not result.says_no and [bool(verdict) for verdict in result.verdicts] == [True]
    assert result.poses.after_mm.shape == (200 - result.left_out.count,)
    piece = result.pieces[0]
    assert piece.is_cone and piece.after.aligned.foot.rms_mm < piece.before.aligned.foot.rms_mm
    assert piece.after.deviation.contour_mm.shape == (len(piece.after.deviation.rows), 3)
    files = abbe.verify_results(machine=str(EXAMPLES / "machines/trunnion-mill.machine.toml"),
                                errors=str(EXAMPLES / "compensate/trunnion.errors.toml"),
                                truth=str(EXAMPLES / "verify/truth.errors.toml"), poses=200, seed=3,
                                ranges={"X_mm": (-100, 100)}, least_reduction=10)
    assert files.poses.after_mm.tolist() == result.poses.after_mm.tolist()


def test_a_condition_that_is_not_met():
    result = abbe.verify(trunnion(), truth(), poses=20, least_reduction=1e6)
    assert result.says_no and not result.verdicts[0].met


def test_traces_of_arrays():
    mill5 = machine("trunnion-mill")
    read = abbe.Trace.read(EXAMPLES / "verify/cone-before.csv", mill5)
    made = abbe.Trace(mill5, read.positions_mm_rad, read.time_s)
    assert numpy.array_equal(made.positions_mm_rad, read.positions_mm_rad) and len(made) == len(read)
    for bad in ([[0] * 5], numpy.zeros((3, 4)), [0] * 5, [["x"] * 5] * 2):
        with pytest.raises(abbe.InputError):
            abbe.Trace(mill5, bad)
    with pytest.raises(abbe.InputError, match="time_s"):
        abbe.Trace(mill5, numpy.zeros((3, 5)), [0, 2, 1])


def test_bad_verifications_are_named():
    for bad in ({"poses": 3}, {"poses": 20000}, {"ranges": {"X_mm": (1, 0)}}, {"ranges": {"X_mm": (0, 1e9)}},
                {"least_reduction": -1}, {"reach_mm": 0}, {"largest_ratio": float("nan")}):
        with pytest.raises(abbe.InputError) as error:
            abbe.verify(trunnion(), truth(), **bad)
        assert next(iter(bad)).rstrip("s") in str(error.value) and "--" not in str(error.value)
    with pytest.raises(abbe.InputError, match="truth"):
        abbe.verify(trunnion(), mill())
    with pytest.raises(abbe.InputError, match="missing"):
        abbe.verify_results("missing")
    with pytest.raises(TypeError):
        abbe.verify(trunnion(), truth(), pieces=[abbe.ConeFrustum()])
    with pytest.raises(abbe.InputError, match="pieces"):
        three = abbe.Trace(machine("three-axis-mill"), numpy.zeros((3, 3)))
        abbe.verify(trunnion(), truth(), pieces=[(abbe.ConeFrustum(), three, three)])
