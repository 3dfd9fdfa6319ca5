"""Evaluations of ISO 230, against the command: texts, JSON, pages and folders are the same bytes."""

import csv
import json
import re

import abbe
import numpy
import pandas
import pytest
from use_examples import EXAMPLES, command, machine

#: Also run under the address sanitizer (CMakeLists.txt).
bad_input = pytest.mark.bad_input

EVALUATE, ENGRAVER = EXAMPLES / "evaluate", EXAMPLES / "laser_engraver"
ACCURACY = {"u_x_um": 2.77, "u_y_um": 1.55, "u_z_um": 3.55, "u_mark_um": 2, "u_width_um": 2}

#: Of each: what the command is asked, the readings, and the same of Python.
KINDS = {
    "positioning": (["positioning", "--instrument-um-per-m", 0.6, "--misalignment-mm", 1, "--environment-um", 1.2],
                    EVALUATE / "linear.csv",
                    lambda r, **more: abbe.evaluate_positioning(r, uncertainty={
                        "instrument_um_per_m": 0.6, "misalignment_mm": 1, "environment_um": 1.2}, **more)),
    "rotary": (["positioning", "--instrument-arcsec", 0.3], EVALUATE / "rotary.csv",
               lambda r, **more: abbe.evaluate_positioning(r, uncertainty={"instrument_arcsec": 0.3}, **more)),
    "linear, at 20 degC": (
        ["positioning", "--machine-temperature-degC", 23.5, "--machine-expansion-um-per-m-K", 11.5,
         "--u-machine-temperature-K", 0.3, "--u-common-temperature-K", 0.1], EVALUATE / "linear.csv",
        lambda r, **more: abbe.evaluate_positioning(
            r, uncertainty={"machine_expansion_um_per_m_K": 11.5},
            expansion={"machine_temperature_degC": 23.5, "u_machine_temperature_K": 0.3,
                       "u_common_temperature_K": 0.1}, **more)),
    "circular, at 20 degC": (
        ["circular", "--radius-mm", 150, "--machine-temperature-degC", 23, "--machine-expansion-um-per-m-K", 10],
        EVALUATE / "circular.csv",
        lambda r, **more: abbe.evaluate_circular(
            r, 150, expansion={"machine_temperature_degC": 23, "machine_expansion_um_per_m_K": 10}, **more)),
    "diagonals": (["diagonals"], EVALUATE / "diagonals.csv", abbe.evaluate_diagonals),
    "circular": (["circular", "--radius-mm", 150, "--u-reading-um", 0.2, "--u-length-um", 0.5, "--skip-reversal-deg", 6,
                  "--feed-mm-min", 1000, "--plane", "YZ", "--centre", "minimum-zone"], EVALUATE / "circular.csv",
                 lambda r, **more: abbe.evaluate_circular(
                     r, 150, u_reading_um=0.2, u_length_um=0.5, skip_reversal_deg=6, feed_mm_min=1000, plane="YZ",
                     centre="minimum-zone", **more)),
    "circular, length unknown": (["circular", "--radius-mm", 150, "--length-not-calibrated"], EVALUATE / "circular.csv",
                                 lambda r, **more: abbe.evaluate_circular(r, 150, length_calibrated=False, **more)),
    "rotation": (["rotation", "--plane-distance-mm", 80, "--u-reading-um", 0.02, "--sensitive-deg", 30],
                 EVALUATE / "rotation.csv",
                 lambda r, **more: abbe.evaluate_rotation(r, plane_distance_mm=80, u_reading_um=0.02, sensitive_deg=30,
                                                          **more)),
    "straightness": (["straightness", "--u-reading-um", 0.3, "--reference", "minimum-zone"],
                     EVALUATE / "straightness.csv",
                     lambda r, **more: abbe.evaluate_straightness(r, u_reading_um=0.3, reference="minimum-zone",
                                                                  **more)),
    "squareness": (["squareness", "--u-reading-um", 0.3, "--u-square-urad", 1, "--square-urad", -3],
                   EVALUATE / "squareness.csv",
                   lambda r, **more: abbe.evaluate_squareness(r, u_reading_um=0.3, u_square_urad=1, square_urad=-3,
                                                              **more)),
    "etve": (["etve", "--plane-distance-mm", 150, "--u-reading-um", 0.1, "--length-mm", 500,
              "--workpiece-expansion-um-per-m-K", 23, "--u-scale-expansion-um-per-m-K", 1,
              "--scale-expansion-um-per-m-K", 8], EVALUATE / "etve.csv",
             lambda r, **more: abbe.evaluate_etve(r, options={
                 "plane_distance_mm": 150, "u_reading_um": 0.1, "length_mm": 500,
                 "workpiece_expansion_um_per_m_K": 23, "u_scale_expansion_um_per_m_K": 1,
                 "scale_expansion_um_per_m_K": 8}, **more)),
    "spindle": (["spindle-distortion", "--stop-min", 240, "--plane-distance-mm", 150], EVALUATE / "spindle.csv",
                lambda r, **more: abbe.evaluate_spindle_distortion(r, options={"stop_min": 240,
                                                                               "plane_distance_mm": 150}, **more)),
    "axis": (["axis-distortion", "--u-reading-um", 0.1], EVALUATE / "axis_warming.csv",
             lambda r, **more: abbe.evaluate_axis_distortion(r, options={"u_reading_um": 0.1}, **more)),
    "sections": (["contour", "--u-height-um", 2, "--u-across-um", 1], ENGRAVER / "sections.csv",
                 lambda r, **more: abbe.evaluate_sections(r, u_height_um=2, u_across_um=1, **more)),
    "linkage": (["linkage", "--exit-to-axis-mm", 120, "--board-mm", 4, "--machine",
                 EXAMPLES / "machines/yin-engraver-u.machine.toml",
                 *[text for name, value in ACCURACY.items() for text in ("--" + name.replace("_", "-"), value)]],
                ENGRAVER / "five-steps.csv",
                lambda r, **more: abbe.evaluate_linkage(r, 120, 4, machine=machine("yin-engraver-u"),
                                                        accuracy=ACCURACY, **more)),
}


def columns_of(path):
    """The columns of a file, numbers where all that is not empty is one."""
    rows = list(csv.DictReader(line for line in path.read_text().splitlines() if line and not line.startswith("#")))

    def values(name):
        texts = [row[name].strip() for row in rows]
        try:
            return numpy.array([float(text) if text else numpy.nan for text in texts])
        except ValueError:
            return texts

    return {name: values(name) for name in rows[0]}


def same_folder(result, wanted, folder):
    assert set(result.files()) | {".abbe-results"} == {path.name for path in wanted.iterdir()}
    result.write(folder)
    for path in wanted.iterdir():
        assert (folder / path.name).read_bytes() == path.read_bytes(), path.name


@pytest.mark.parametrize("kind", KINDS)
def test_results_are_those_of_the_command(kind, tmp_path):
    options, readings, evaluate = KINDS[kind]
    asked = ["evaluate", options[0], readings, *options[1:]]
    for given in (readings, columns_of(readings), pandas.DataFrame(columns_of(readings))):
        result = evaluate(given, **({} if given is readings else {"file": str(readings)}))
        assert result.ok and result.kind == options[0]
        assert result.text() == command(asked, tmp_path)
        assert result.json_text() == command([*asked, "--json"], tmp_path)
    assert result.to_dict() == json.loads(result.json_text())
    command([*asked, "-o", "wanted"], tmp_path)
    same_folder(result, tmp_path / "wanted", tmp_path / "own")
    assert result.page_html() == (tmp_path / "wanted/report.html").read_text()
    result.write_page(tmp_path / "page.html")
    assert (tmp_path / "page.html").read_text() == result.page_html()
    assert [result.plot_svg(name).encode() for name in result.plot_names] == [
        (tmp_path / f"wanted/{name}.svg").read_bytes() for name in result.plot_names]
    with pytest.raises(FileExistsError):
        result.write(tmp_path / "own")
    with pytest.raises(FileExistsError):
        result.write_page(tmp_path / "page.html")


def test_contour_points_are_those_of_the_command(tmp_path):
    curve, points = ENGRAVER / "table-a4.csv", ENGRAVER / "engraved.csv"
    asked = ["evaluate", "contour", points, "--curve", curve, "--u-origin-um", 1, "--tolerance", "contour_max_um=50"]
    wanted = command([*asked, "--json", "-o", "wanted"], tmp_path)
    result = abbe.evaluate_contour(points, curve, u_origin_um=1, tolerances={"contour_max_um": 50})
    assert result.json_text() == wanted
    assert result.text() + "\nresults in again\n" == command([*asked, "-o", "again"], tmp_path)
    same_folder(result, tmp_path / "wanted", tmp_path / "own")
    columns = columns_of(points)
    array = numpy.stack([columns[name] for name in ("x_mm", "y_mm", "z_mm")], axis=1)
    engraver = machine("yin-engraver-u")
    for given in (abbe.Curve.read(curve, engraver), curve):
        of_array = abbe.evaluate_contour(array, given, machine=engraver, u_origin_um=1)
        assert [f.value for f in of_array.figures.values()] == [f.value for f in result.figures.values()]
    assert numpy.array_equal(of_array.numbers.distance_mm, result.numbers.distance_mm)
    assert len(result.numbers) == len(array) and result.numbers.beyond_end.dtype == bool
    with pytest.raises(abbe.InputError, match="machine"):
        abbe.evaluate_contour(points, ENGRAVER / "regions.ngc")
    assert abbe.evaluate_contour(points, ENGRAVER / "regions.ngc", machine=engraver).figures


def test_tolerances_and_figures(tmp_path):
    asked = ["evaluate", "positioning", EVALUATE / "linear.csv", "--tolerance", "A_um=10", "--tolerance", "E_um=20"]
    result = abbe.evaluate_positioning(EVALUATE / "linear.csv", tolerances={"A_um": 10, "E_um": 20})
    assert result.text() == command(asked, tmp_path, exit_code=1)
    assert result.exceeds_tolerance and not result.ok and result.refused == ""
    figure = result["A"]
    assert figure.verdict == "exceeded" and figure.tolerance == 10 and figure.unit == "um" and figure.value > 10
    assert result["E"].verdict == "within" and result["B"].verdict == "" and result["B"].tolerance is None
    assert list(result.figures)[0] == "A" and repr(figure).startswith("<abbe.EvaluationFigure A: 10.8")
    frame = result.to_dataframe()
    assert frame.loc["A", "value"] == figure.value and frame.index.name == "symbol"
    assert len(frame) == len(result.figures)
    assert "exceeded" in result._repr_html_() and "<script" not in result._repr_html_()
    with pytest.raises(KeyError, match="Q"):
        result["Q"]
    for bad in ({"Q_um": 1}, {"A_kg": 1}, {"A": 1}, {"A_um": 0}, {"A_um": float("nan")}, {"A_um": -1}):
        with pytest.raises(abbe.InputError, match="tolerance"):
            abbe.evaluate_positioning(EVALUATE / "linear.csv", tolerances=bad)


def test_numbers_of_positioning_are_those_of_their_definitions():
    columns = columns_of(EVALUATE / "linear.csv")
    numbers = abbe.evaluate_positioning(columns).numbers
    targets, sides = numpy.unique(columns["target_mm"]), numpy.array(columns["direction"])
    assert numpy.array_equal(numbers.targets_mm_rad, targets) and len(numbers) == len(targets)
    for index, target in enumerate(targets):
        for side, word in enumerate("+-"):
            of_side = 1e-3 * columns["deviation_um"][(columns["target_mm"] == target) & (sides == word)]
            assert numbers.runs[index, side] == len(of_side)
            assert numbers.mean_mm_rad[index, side] == pytest.approx(of_side.mean(), abs=1e-12)
            assert numbers.standard_deviation_mm_rad[index, side] == pytest.approx(of_side.std(ddof=1), abs=1e-12)
    assert numpy.allclose(numbers.reversal_mm_rad, numbers.mean_mm_rad[:, 0] - numbers.mean_mm_rad[:, 1])
    one_run = abbe.evaluate_positioning({"direction": "+-", "target_mm": [0, 0], "deviation_um": [1, 2]}
                                        | {"direction": ["+", "-"]})
    assert numpy.isnan(one_run.numbers.standard_deviation_mm_rad).all()
    assert one_run["A"].value is None and one_run["A"].missing and one_run["A"].text() == one_run["A"].missing


@bad_input
def test_numbers_of_the_other_kinds():
    circle = abbe.evaluate_circular(EVALUATE / "circular.csv", 150)
    numbers = circle.numbers
    for path, symbol in ((numbers.clockwise, "G_cw"), (numbers.counterclockwise, "G_ccw")):
        assert path.status == "done" and not path.partial and path.angle_rad.shape == path.residuals_mm.shape
        assert numpy.ptp(path.deviation_mm) == pytest.approx(path.circular_mm)
        assert 1e3 * path.circular_mm == pytest.approx(circle[symbol].value, abs=1e-9)
    assert len(numbers.both.deviation_mm) == len(numbers.clockwise.angle_rad) + len(numbers.counterclockwise.angle_rad)
    assert numbers.both.modelled_mm is None and numbers.mean_mm is not None
    path = abbe.evaluate_circular(EVALUATE / "circular.csv", 150).numbers.clockwise
    assert numpy.isfinite(path.deviation_mm).all()  # the evaluation is gone
    spindle = abbe.evaluate_rotation(EVALUATE / "rotation.csv", plane_distance_mm=80).numbers
    motion = spindle.motions["radial_rotating_1"]
    assert motion.total_mm_rad.shape == (spindle.turns, len(spindle.angle_rad))
    assert numpy.allclose(motion.total_mm_rad.mean(axis=0), motion.synchronous_mm_rad, atol=1e-12)
    assert "tilt_rotating" in spindle.motions
    assert "tilt_x" not in abbe.evaluate_rotation(EVALUATE / "rotation.csv").numbers.motions
    line = abbe.evaluate_straightness(EVALUATE / "straightness.csv").numbers
    assert line.minimum_zone.value_mm <= line.least_squares.value_mm
    assert numpy.ptp(line.minimum_zone.deviations_mm) == pytest.approx(line.minimum_zone.value_mm)
    square = abbe.evaluate_squareness(EVALUATE / "squareness.csv", square_urad=5).numbers
    assert square.value_rad == pytest.approx(5e-6 - sum(line.slope_rad for line in square.lines))
    sections = abbe.evaluate_sections(ENGRAVER / "sections.csv").numbers
    assert numpy.isfinite(sections.error_mm).all() and len(sections) == len(sections.reasons) and sections.refused == 0
    diagonals = abbe.evaluate_diagonals(EVALUATE / "diagonals.csv").numbers
    assert len(diagonals.names) == len(diagonals.positioning) == 4
    linkage = abbe.evaluate_linkage(ENGRAVER / "five-steps.csv", 120, 4, accuracy=ACCURACY)
    assert linkage.numbers.values_mm.shape == (7,) and (numpy.diag(linkage.numbers.covariance_mm2) > 0).all()
    assert set(linkage.files()) == {"evaluation.json", "plot.svg", "report.html"} | set(
        f"{name}.svg" for name in linkage.plot_names)


@bad_input
def test_what_is_refused_says_why(tmp_path):
    angle = numpy.arange(0, 100, 2.0)
    arc = {"direction": ["cw"] * 50, "angle_deg": angle, "deviation_um": numpy.zeros(50)}
    result = abbe.evaluate_circular(arc, 100)
    assert not result.ok and "arc is shorter than 200" in result.refused and result["G_cw"].value is None
    assert abbe.evaluate_circular(arc, 100, centre="instrument").ok
    few = {"angle_deg": numpy.arange(0, 1080, 10.0), "axial_um": numpy.zeros(108)}
    assert abbe.evaluate_rotation(few).refused == "fewer than 4 whole turns"
    assert abbe.evaluate_rotation(few).numbers.motions == {}


GOOD = {"direction": ["+", "-"], "target_mm": [0.0, 0.0], "deviation_um": [1.0, 2.0]}
BAD_COLUMNS = {
    "no columns": {}, "no rows": {name: [] for name in GOOD},
    "a missing column": {"target_mm": [0], "direction": ["+"]},
    "different lengths": {**GOOD, "target_mm": [0]}, "nan": {**GOOD, "deviation_um": [1, numpy.nan]},
    "infinity": {**GOOD, "target_mm": [0, numpy.inf]}, "huge": {**GOOD, "target_mm": [0, 1e30]},
    "texts": {**GOOD, "target_mm": ["a", "b"]}, "complex": {**GOOD, "target_mm": [1j, 0]},
    "two dimensions": {**GOOD, "target_mm": [[0], [0]]}, "ragged": {**GOOD, "target_mm": [[0], [0, 1]]},
    "a number": {**GOOD, "target_mm": 0}, "none": {**GOOD, "target_mm": None},
    "an unknown column": {**GOOD, "x": [0, 0]},
    "an unknown unit": {**GOOD, "target_kg": [0, 0]},
    "no unit": {"direction": ["+"], "target": [0], "deviation_um": [0]},
    "a wrong word": {**GOOD, "direction": ["+", "up"]}, "numbers for words": {**GOOD, "direction": [1, 2]},
    "surrogates": {**GOOD, "direction": ["\udcff", "+"]}, "bytes": {**GOOD, "direction": [b"+", b"-"]},
    "name is no text": {1: [0, 0]}, "name is a surrogate": {"\udcff": [0]}, "a name with a comma": {"a,b\n": [0]},
    "objects": {**GOOD, "target_mm": [object(), object()]}, "a class": dict, "a list": [1, 2], "a number alone": 3,
    "a missing file": "/nowhere/a.csv", "a folder": "/", "an empty name": "", "twice": {**GOOD, "target_deg": [0, 0]},
}


@bad_input
@pytest.mark.parametrize("bad", BAD_COLUMNS)
def test_bad_readings_are_named(bad):
    for function in (abbe.evaluate_positioning, abbe.evaluate_diagonals, abbe.evaluate_rotation,
                     abbe.evaluate_straightness,
                     abbe.evaluate_squareness, abbe.evaluate_sections, abbe.evaluate_etve,
                     abbe.evaluate_spindle_distortion, abbe.evaluate_axis_distortion, lambda r: abbe.evaluate_circular(r, 100),
                     lambda r: abbe.evaluate_linkage(r, 120, 4)):
        with pytest.raises(abbe.InputError) as error:
            function(BAD_COLUMNS[bad])
        assert not re.search("--[a-z]", str(error.value))
    with pytest.raises(TypeError):
        abbe.evaluate_positioning(None)


@bad_input
def test_the_place_of_a_bad_reading_is_its_row():
    with pytest.raises(abbe.InputError) as error:
        abbe.evaluate_positioning({**GOOD, "deviation_um": [1, numpy.nan]})
    assert error.value.field == "deviation_um[1]" and error.value.file is None
    assert error.value.expected == "a length in um"
    with pytest.raises(abbe.InputError, match=r"run\[1\]: run 1 approaches this target twice .* first in row 0"):
        abbe.evaluate_positioning({"direction": ["+"] * 2, "target_mm": [0, 0], "deviation_um": [0, 1], "run": [1, 1]})


@bad_input
@pytest.mark.parametrize("name, call", [
    ("radius_mm", lambda: abbe.evaluate_circular(EVALUATE / "circular.csv", 0)),
    ("radius_mm", lambda: abbe.evaluate_circular(EVALUATE / "circular.csv", numpy.nan)),
    ("plane", lambda: abbe.evaluate_circular(EVALUATE / "circular.csv", 150, plane="XX")),
    ("centre", lambda: abbe.evaluate_circular(EVALUATE / "circular.csv", 150, centre="middle")),
    ("skip_reversal_deg", lambda: abbe.evaluate_circular(EVALUATE / "circular.csv", 150, skip_reversal_deg=41)),
    ("feed_mm_min", lambda: abbe.evaluate_circular(EVALUATE / "circular.csv", 150, feed_mm_min=-1)),
    ("u_reading_um", lambda: abbe.evaluate_straightness(EVALUATE / "straightness.csv", u_reading_um=-1)),
    ("reference", lambda: abbe.evaluate_straightness(EVALUATE / "straightness.csv", reference="")),
    ("square_urad", lambda: abbe.evaluate_squareness(EVALUATE / "squareness.csv", square_urad=numpy.inf)),
    ("plane_distance_mm", lambda: abbe.evaluate_rotation(EVALUATE / "rotation.csv", plane_distance_mm=0)),
    ("uncertainty", lambda: abbe.evaluate_positioning(EVALUATE / "linear.csv", uncertainty={"instrument_mm": 1})),
    ("uncertainty", lambda: abbe.evaluate_positioning(EVALUATE / "linear.csv", uncertainty={"instrument_um": -1})),
    ("arcsec", lambda: abbe.evaluate_positioning(EVALUATE / "linear.csv", uncertainty={"instrument_arcsec": 1})),
    ("options", lambda: abbe.evaluate_etve(EVALUATE / "etve.csv", options={"u_reading_mm": 1})),
    ("u_reading_um is -1", lambda: abbe.evaluate_etve(EVALUATE / "etve.csv", options={"u_reading_um": -1})),
    ("stop_min", lambda: abbe.evaluate_spindle_distortion(EVALUATE / "spindle.csv", options={"stop_min": -5})),
    ("length_mm", lambda: abbe.evaluate_etve(EVALUATE / "etve.csv", options={"scale_expansion_um_per_m_K": 8})),
    ("feature", lambda: abbe.evaluate_sections(ENGRAVER / "sections.csv", feature="hole")),
    ("beam_tilt_deg", lambda: abbe.evaluate_sections(ENGRAVER / "sections.csv", beam_tilt_deg=31)),
    ("accuracy", lambda: abbe.evaluate_linkage(ENGRAVER / "five-steps.csv", 120, 4, accuracy={"u_q_um": 1})),
    ("u_x_um", lambda: abbe.evaluate_linkage(ENGRAVER / "five-steps.csv", 120, 4, accuracy={"u_x_um": -1})),
    ("u_c1_arcsec: is -1",
     lambda: abbe.evaluate_linkage(ENGRAVER / "five-steps.csv", 120, 4, accuracy={"u_c1_arcsec": -1})),
    ("board_mm", lambda: abbe.evaluate_linkage(ENGRAVER / "five-steps.csv", 120, -4)),
    ("convention", lambda: abbe.evaluate_linkage(ENGRAVER / "five-steps.csv", 120, 4, convention="other")),
    ("no axis", lambda: abbe.evaluate_linkage(ENGRAVER / "five-steps.csv", 120, 4, machine=machine("trunnion-mill"))),
    ("points_mm", lambda: abbe.evaluate_contour(numpy.zeros((0, 3)), ENGRAVER / "table-a4.csv")),
    ("points_mm", lambda: abbe.evaluate_contour(numpy.zeros((3, 2)), ENGRAVER / "table-a4.csv")),
    ("points_mm", lambda: abbe.evaluate_contour([0, 0, 0], ENGRAVER / "table-a4.csv")),
    ("points_mm", lambda: abbe.evaluate_contour([[0, 0, 1e12]], ENGRAVER / "table-a4.csv")),
    ("points_mm", lambda: abbe.evaluate_contour([[0, 0, numpy.nan]], ENGRAVER / "table-a4.csv")),
    ("nowhere", lambda: abbe.evaluate_contour([[0, 0, 0]], "nowhere.csv")),
])
def test_bad_arguments_are_named(name, call, names_argument):
    names_argument(name, call)


def test_thermal_numbers():
    spindle = abbe.evaluate_spindle_distortion(EVALUATE / "spindle.csv",
                                               options={"stop_min": 240, "plane_distance_mm": 150}).numbers
    assert [sensor.name for sensor in spindle.sensors] == ["X1", "Y1", "X2", "Y2", "Z", "A", "B"]
    assert spindle.sensors[5].unit == "rad" and spindle.temperatures[0].unit == "degC"
    assert spindle.warming[4].status == "done" and spindle.stop_s == 240 * 60
    assert spindle.warming[4].time_constant_s == pytest.approx(45 * 60, abs=3 * spindle.warming[4].uncertainty_s)
    etve = abbe.evaluate_etve({"time_h": [0, 1], "Z_um": [0, numpy.pi]}).numbers
    assert etve.sensors[0].time_s.tolist() == [0, 3600] and len(etve.sensors[0]) == 2 and etve.temperatures == []
    axis = abbe.evaluate_axis_distortion(EVALUATE / "axis_warming.csv").numbers
    assert axis.targets_mm.tolist() == [50, 250, 450] and axis.directions == [""] * 3
    assert axis.expansions[0].expansion == pytest.approx(43.6e-6, rel=0.03)
    assert axis.expansions[0].response.status == "done" and len(axis.sensors[0][0]) == 37


WARM_UP = EXAMPLES / "warm_up/r-test.study.toml"


def test_location_distortion_is_that_of_the_command(tmp_path):
    asked = ["evaluate", "location-distortion", WARM_UP, "--stop-min", 240, "--tolerance", "d_EZ0A_um=20"]
    result = abbe.Study.read(WARM_UP).location_distortion(options={"stop_min": 240}, tolerances={"d_EZ0A_um": 20})
    assert result.ok and result.kind == "location-distortion" and result.refused == ""
    assert result.text() == command(asked, tmp_path)
    numbers = result.numbers
    names = [sensor.name for sensor in numbers.locations]
    assert len(names) == len(numbers.standard_uncertainties_mm_rad) == len(numbers.no_change) == 8
    at = names.index("EZ0A")
    assert numbers.locations[at].unit == "mm" and len(numbers.locations[at]) == 33
    assert numbers.warming[at].time_constant_s == pytest.approx(3600, abs=3 * numbers.warming[at].uncertainty_s)
    assert numbers.cooling[at].status == "done" and numbers.no_change[at] < 1e-6 < numbers.misfit_probability
    assert numbers.temperatures[0].name == "table" and numbers.stop_s == 240 * 60 and numbers.uncertainty_factor >= 1
    with pytest.raises(abbe.InputError, match="stop_min"):
        abbe.Study.read(WARM_UP).location_distortion(options={"stop_min": -5})


@bad_input
def test_many_readings_and_one():
    n = 200_000
    random = numpy.random.default_rng(1)
    many = abbe.evaluate_straightness({"position_mm": numpy.arange(n), "deviation_um": random.normal(size=n)})
    assert many.numbers.minimum_zone.value_mm == pytest.approx(9e-3, rel=0.2)
    one = abbe.evaluate_positioning({"direction": ["+"], "target_mm": [0], "deviation_um": [0]})
    assert one.ok and one["A"].value is None
    with pytest.raises(abbe.InputError, match="three"):
        abbe.evaluate_straightness({"position_mm": [0, 1], "deviation_um": [0, 0]})


def test_a_circle_is_drawn():
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    from abbe import plot

    circle = abbe.evaluate_circular(EVALUATE / "circular.csv", 150)
    labels = [text.get_text() for text in plot.circular(circle).axes[0].get_legend().get_texts()]
    assert labels == [f"{name}, G = {circle[symbol].value:.2f} µm" for name, symbol in (("clockwise", "G_cw"),
                                                                                       ("counter-clockwise", "G_ccw"))]
    arc = {"direction": ["cw"] * 50, "angle_deg": numpy.arange(0, 100, 2.0), "deviation_um": numpy.zeros(50)}
    for wrong in (abbe.evaluate_straightness(EVALUATE / "straightness.csv"), abbe.evaluate_circular(arc, 100)):
        with pytest.raises(abbe.InputError, match="evaluation"):
            plot.circular(wrong)
    matplotlib.pyplot.close("all")
