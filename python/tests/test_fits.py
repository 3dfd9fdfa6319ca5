"""Fits, registrations and deviations, against the command: texts, JSON, pages and folders are the same bytes."""

import json

import abbe
import numpy
import pytest
from use_examples import EXAMPLES, command

#: Also run under the address sanitizer (CMakeLists.txt).
bad_input = pytest.mark.bad_input

FIT, SCAN = EXAMPLES / "fit", EXAMPLES / "scan"
BRACKET = SCAN / "bracket-scan.csv", SCAN / "bracket.stl"


def turned(axis=2, angle=0.5, shift=(1, 2, 3)):
    matrix, (i, j) = numpy.eye(4), ((axis + 1) % 3, (axis + 2) % 3)
    matrix[i, i] = matrix[j, j] = numpy.cos(angle)
    matrix[j, i], matrix[i, j] = numpy.sin(angle), -numpy.sin(angle)
    matrix[:3, 3] = shift
    return matrix


def same_folder(files, wanted):
    assert set(files) | {".abbe-results"} == {path.name for path in wanted.iterdir()}
    for name, contents in files.items():
        assert contents == (wanted / name).read_bytes(), name


@pytest.mark.parametrize("file, options, arguments", [
    ("bore.csv", ["--shape", "cylinder", "--method", "minimum-zone", "--u-point-um", 0.5],
     {"shape": "cylinder", "method": "minimum-zone", "u_point_um": 0.5}),
    ("bore.csv", ["--shape", "cylinder", "--fixed-direction", "0,0,1", "--fixed-radius-mm", "15"],
     {"shape": "cylinder", "fixed_direction": [0, 0, 1], "fixed_radius_mm": 15}),
    ("ring.csv", ["--shape", "circle2"], {"shape": "circle2"}),
    ("scanned-ball.xyz", ["--shape", "sphere", "--method", "robust", "--loss", "welsch", "--unit", "mm"],
     {"shape": "sphere", "method": "robust", "loss": "welsch", "unit": "mm"}),
])
def test_fits_are_those_of_the_command(file, options, arguments, tmp_path):
    asked = ["fit", FIT / file, *options]
    result = abbe.fit(FIT / file, **arguments)
    wanted = command([*asked, "--residuals", "wanted.csv", "-o", "wanted"], tmp_path)
    assert result.text() + "\nresults in wanted\n" == wanted
    assert result.json_text() == command([*asked, "--json"], tmp_path)
    assert result.to_dict() == json.loads(result.json_text())
    assert result.residuals_csv() == (tmp_path / "wanted.csv").read_text()
    same_folder(result.files(), tmp_path / "wanted")
    result.write_page(tmp_path / "page.html")
    assert (tmp_path / "page.html").read_text() == (tmp_path / "wanted/report.html").read_text()
    del arguments["shape"]
    unit = arguments.pop("unit", None)
    cloud = result.points_mm
    of_array = abbe.fit(cloud, options[1], **arguments)
    assert numpy.array_equal(of_array.deviations_mm, result.deviations_mm)
    assert (unit or of_array["form"].value == result["form"].value)
    assert numpy.allclose(result.shape.distances(cloud), result.deviations_mm) or file == "ring.csv"


def test_coaxial_circles_are_those_of_the_command(tmp_path):
    files = [FIT / "step-1.csv", FIT / "step-2.csv"]
    result = abbe.fit_coaxial_circles(files, fixed_radius_mm=[12, 30], u_point_um=1)
    asked = ["fit", *files, "--shape", "coaxial-circles", "--fixed-radius-mm", "12,30", "--u-point-um", 1]
    assert result.text() == command(asked, tmp_path) and result.json_text() == command([*asked, "--json"], tmp_path)
    free = abbe.fit_coaxial_circles([abbe.PointCloud.read(file) for file in files])
    assert free.text() == command(["fit", *files, "--shape", "coaxial-circles"], tmp_path)
    of_arrays = abbe.fit_coaxial_circles([abbe.PointCloud.read(file).points_mm for file in files])
    assert numpy.array_equal(of_arrays.radii_mm, free.radii_mm) and "circle 2" in of_arrays.text()
    assert free.ok and free.covariance.shape == (10, 10) and len(free.heights_mm) == len(free.form_mm) == 2


def test_shapes_are_found_with_their_uncertainty():
    random = numpy.random.default_rng(1)
    directions = random.normal(size=(2000, 3))
    directions /= numpy.linalg.norm(directions, axis=1)[:, None]
    points = numpy.array([1000, 2, 3]) + directions * (5 + random.normal(scale=1e-3, size=(2000, 1)))
    ball = abbe.fit(points, "sphere")
    assert ball.ok and ball.status == "ok" and ball.reason == "" and ball.shape.kind == "sphere"
    assert ball.shape.direction is None and ball.shape.half_angle_rad is None and ball.degrees_of_freedom == 1996
    assert abs(ball.shape.radius_mm - 5) < 4 * ball.radius_uncertainty_mm < 4e-4
    assert (abs(ball.shape.point_mm - [1000, 2, 3]) < 5 * ball.point_uncertainty_mm).all()
    assert ball.sigma_mm == pytest.approx(1e-3, rel=0.1) and ball.covariance.shape == (8, 8)
    assert 1e3 * ball.form_mm == pytest.approx(ball["form"].value, abs=1e-6) and not ball.points_mm.flags.writeable
    wrong = points.copy()
    wrong[:400] += 3
    robust = abbe.fit(wrong, "sphere", method="robust")
    assert abs(robust.shape.radius_mm - 5) < 1e-3 and (robust.weights[:400] < 0.5).all() and robust.rejected >= 400
    zone = abbe.fit(points, "sphere", method="minimum-zone")
    assert zone.form_mm <= ball.form_mm and len(zone.contacts) >= 5 and zone.weights is None
    cone = abbe.fit(numpy.array([[h * numpy.cos(a), h * numpy.sin(a), h] for h in (1, 2, 3) for a in range(6)]), "cone")
    assert cone.shape.half_angle_rad == pytest.approx(numpy.pi / 4) and numpy.allclose(cone.shape.apex_mm, 0, atol=1e-9)
    assert "cone" in repr(cone.shape) and "FittedShape cone" in repr(cone)
    assert cone.to_dataframe().loc["form", "unit"] == "um"


def test_fits_are_the_same_on_arrays_in_any_layout():
    points = abbe.PointCloud.read(FIT / "bore.csv").points_mm
    expected = abbe.fit(points, "cylinder").shape
    for same in (points.tolist(), numpy.asfortranarray(points), numpy.repeat(points, 2, axis=0)[::2],
                 points.astype(numpy.longdouble)):
        assert abbe.fit(same, "cylinder").shape.radius_mm == expected.radius_mm
    flat = numpy.array([[3 + 5 * numpy.cos(a), 5 * numpy.sin(a)] for a in range(20)])
    assert abbe.fit(flat, "circle2").shape.radius_mm == pytest.approx(5)
    with pytest.raises(abbe.InputError, match="points_mm"):
        abbe.fit(flat, "circle")


@bad_input
@pytest.mark.parametrize("shape", ["line2", "circle2", "line", "plane", "circle", "sphere", "cylinder", "cone"])
@pytest.mark.parametrize("method", ["least-squares", "minimum-zone", "robust"])
def test_too_few_and_degenerate_points_have_no_answer(shape, method):
    for points in (numpy.zeros((0, 3)), numpy.zeros((1, 3)), numpy.zeros((50, 3)), numpy.ones((2, 3)),
                   numpy.arange(2)[:, None] * [[1, 1, 0]]):
        result = abbe.fit(points, shape, method=method)
        if result.ok:
            assert shape in ("line", "line2") and len(points) == 2
        else:
            assert result.status != "ok" and result.reason and len(result.deviations_mm) == 0 and result.text()
            with pytest.raises(abbe.InputError):
                result.residuals_csv()


@bad_input
@pytest.mark.parametrize("name, call", [
    ("points_mm", lambda: abbe.fit([[1, 2]], "plane")), ("points_mm", lambda: abbe.fit([1, 2, 3], "plane")),
    ("points_mm", lambda: abbe.fit([[1, 2, numpy.nan]], "plane")),
    ("points_mm", lambda: abbe.fit([[1, 2, 1e300]], "plane")),
    ("points_mm", lambda: abbe.fit({}, "plane")),
    ("points_mm", lambda: abbe.fit([["a"] * 3], "plane")), ("points_mm", lambda: abbe.fit([[1j, 0, 0]], "plane")),
    ("nowhere", lambda: abbe.fit("nowhere.csv", "plane")), ("shape", lambda: abbe.fit([[0, 0, 0]], "torus")),
    ("method", lambda: abbe.fit([[0, 0, 0]], "plane", method="best")),
    ("method", lambda: abbe.fit([[0, 0, 0]], "plane", method="inscribed")),
    ("loss", lambda: abbe.fit([[0, 0, 0]], "plane", loss="l1")),
    ("fixed_radius_mm", lambda: abbe.fit([[0, 0, 0]], "plane", fixed_radius_mm=1)),
    ("fixed_radius_mm", lambda: abbe.fit([[0, 0, 0]], "sphere", fixed_radius_mm=-1)),
    ("fixed_radius_mm", lambda: abbe.fit([[0, 0, 0]], "sphere", fixed_radius_mm=numpy.nan)),
    ("fixed_direction", lambda: abbe.fit([[0, 0, 0]], "plane", fixed_direction=[0, 0, 0])),
    ("fixed_direction", lambda: abbe.fit([[0, 0, 0]], "plane", fixed_direction=[0, 0])),
    ("fixed_half_angle_deg", lambda: abbe.fit([[0, 0, 0]], "cone", fixed_half_angle_deg=90)),
    ("u_point_um", lambda: abbe.fit([[0, 0, 0]], "plane", u_point_um=-1)),
    ("unit", lambda: abbe.fit([[0, 0, 0]], "plane", unit="mm")),
    ("unit", lambda: abbe.fit(FIT / "bore.csv", "plane", unit="ft")),
    ("tolerance", lambda: abbe.fit(FIT / "bore.csv", "plane", tolerances={"form": 1})),
    ("circles", lambda: abbe.fit_coaxial_circles([])),
    ("fixed_radius_mm", lambda: abbe.fit_coaxial_circles([[[0, 0, 0]]], fixed_radius_mm=[1, 2])),
    ("circles", lambda: abbe.fit_coaxial_circles([None])),
    ("fixed_radius_mm", lambda: abbe.fit_coaxial_circles([[[0, 0, 0]]], fixed_radius_mm=[-1])),
    ("radius_mm", lambda: abbe.Shape("sphere", [0, 0, 0])), ("direction", lambda: abbe.Shape("plane", [0, 0, 0])),
    ("direction", lambda: abbe.Shape("plane", [0, 0, 0], [0, 0, 0])),
    ("radius_mm", lambda: abbe.Shape("plane", [0, 0, 0], [0, 0, 1], radius_mm=1)),
    ("point_mm", lambda: abbe.Shape("plane", [0, 0], [0, 0, 1])),
    ("half_angle_deg", lambda: abbe.Shape("cone", [0, 0, 0], [0, 0, 1], radius_mm=1)),
    ("shape", lambda: abbe.Shape("ellipse", [0, 0, 0])),
    ("target_mm", lambda: abbe.best_fit_transform([[0, 0, 0]], [[0, 0, 0]] * 2)),
    ("source_mm", lambda: abbe.best_fit_transform([[0, 0]], [[0, 0]])),
    ("weights", lambda: abbe.best_fit_transform([[0, 0, 0]], [[0, 0, 0]], weights=[-1])),
    ("weights", lambda: abbe.best_fit_transform([[0, 0, 0]], [[0, 0, 0]], weights=[1, 1])),
    ("start", lambda: abbe.register_scan(*BRACKET, start=numpy.ones((4, 4)))),
    ("nowhere", lambda: abbe.register_scan(*BRACKET, start="nowhere.csv")),
    ("loss", lambda: abbe.register_scan(*BRACKET, loss="huber")),
    ("noise_um", lambda: abbe.register_scan(*BRACKET, noise_um=-1)),
    ("point", lambda: abbe.register_scan(numpy.zeros((0, 3)), BRACKET[1])),
    ("part_unit", lambda: abbe.register_scan(*BRACKET, part_unit="km")),
    ("features", lambda: abbe.register_to_features([[0, 0, 0]], [])),
    ("features", lambda: abbe.register_to_features([[0, 0, 0]], [abbe.Shape("line", [0, 0, 0], [0, 0, 1])])),
    ("labels", lambda: abbe.register_to_features([[0, 0, 0]], [abbe.Shape("plane", [0, 0, 0], [0, 0, 1])], labels=[1])),
    ("labels",
     lambda: abbe.register_to_features([[0, 0, 0]], [abbe.Shape("plane", [0, 0, 0], [0, 0, 1])], labels=[0, 0])),
    ("transform", lambda: abbe.scan_deviations(*BRACKET, transform=numpy.eye(3))),
    ("lower_um", lambda: abbe.scan_deviations(*BRACKET, lower_um=1, upper_um=0)),
    ("largest_mm", lambda: abbe.scan_deviations(*BRACKET, largest_mm=-1)),
    ("faces", lambda: abbe.scan_deviations(*BRACKET, faces=True)),
    ("faces_deg", lambda: abbe.scan_deviations(*BRACKET, faces_deg=200)),
    ("faces_deg", lambda: abbe.scan_deviations(*BRACKET, faces=True, faces_deg=20)),
    ("tolerance", lambda: abbe.scan_deviations(*BRACKET, tolerances={"q_um": 1})),
    ("point", lambda: abbe.scan_deviations(numpy.zeros((0, 3)), BRACKET[1])),
])
def test_bad_arguments_are_named(name, call, names_argument):
    names_argument(name, call)


def test_paired_points():
    random, matrix = numpy.random.default_rng(2), turned()
    source = random.normal(scale=100, size=(300, 3))
    target = source @ matrix[:3, :3].T + matrix[:3, 3]
    found = abbe.best_fit_transform(source, target)
    assert found.ok and numpy.allclose(found.matrix, matrix, atol=1e-9) and found.rms_mm < 1e-9
    assert found.inliers is None
    target[:100] += random.normal(scale=50, size=(100, 3))
    assert not numpy.allclose(abbe.best_fit_transform(source, target).matrix, matrix, atol=1e-3)
    robust = abbe.best_fit_transform(source, target, robust=True)
    assert numpy.allclose(robust.matrix, matrix, atol=1e-6) and robust.inliers[100:].all()
    assert not robust.inliers[:100].any()
    weighted = abbe.best_fit_transform(source, target, weights=numpy.repeat([0, 1.0], [100, 200]))
    assert numpy.allclose(weighted.matrix, matrix, atol=1e-9)
    assert abbe.best_fit_transform(source[:2], target[:2]).status == "too few points"
    assert not abbe.best_fit_transform(numpy.zeros((0, 3)), numpy.zeros((0, 3))).ok
    line = numpy.arange(9)[:, None] * [[1.0, 1, 1]]
    assert abbe.best_fit_transform(line, line).status == "collinear points" or not abbe.best_fit_transform(line,
                                                                                                           line).ok


def test_the_registration_is_that_of_the_command(tmp_path):
    asked = ["register", *BRACKET, "--loss", "tukey", "--noise-um", 5]
    steps = []
    result = abbe.register_scan(*BRACKET, loss="tukey", noise_um=5, progress=lambda *step: steps.append(step))
    assert steps and steps[0][0] == "registering"
    assert result.text() + "\nresults in wanted\n" == command([*asked, "-o", "wanted"], tmp_path)
    assert result.text(uncertainty=True) == command([*asked, "--uncertainty"], tmp_path)
    assert result.json_text() == command([*asked, "--json"], tmp_path)
    assert result.to_dict() == json.loads(result.json_text())
    same_folder(result.files(), tmp_path / "wanted")
    result.write(tmp_path / "own")
    same_folder(result.files(), tmp_path / "own")
    assert result.ok and result.has_pose and result.status == "ok" and result.alternatives == []
    assert result.undetermined == []
    scan = abbe.PointCloud.read(BRACKET[0])
    assert numpy.allclose(scan.points_mm @ result.matrix[:3, :3].T + result.matrix[:3, 3], result.points_mm, atol=1e-9)
    assert (numpy.linalg.eigvalsh(result.covariance) > 0).all() and result.deviations_mm.shape == (len(scan),)
    again = abbe.register_scan(scan, abbe.Mesh.read(BRACKET[1]), start=result.matrix, loss="tukey", noise_um=5,
                               compare=False)
    assert numpy.allclose(again.matrix, result.matrix, atol=1e-6) and again.deviations_mm is None
    assert abbe.register_scan(*BRACKET, start=tmp_path / "wanted/transform.csv").ok


def test_a_pin_turns_about_its_axis(tmp_path):
    pin = SCAN / "pin-scan.csv", SCAN / "pin.stl"
    result = abbe.register_scan(*pin)
    assert result.text() == command(["register", *pin], tmp_path, exit_code=1)
    assert not result.ok and result.has_pose and result.status in ("undetermined", "ambiguous") and result.undetermined


@bad_input
def test_points_on_features():
    random, matrix = numpy.random.default_rng(3), turned(0, 0.05, (0.5, -0.2, 0.1))
    planes = [abbe.Shape("plane", [0, 0, 0], direction) for direction in numpy.eye(3)]
    points = random.uniform(10, 50, (300, 3))
    labels = numpy.arange(300) % 3
    points[numpy.arange(300), labels] = 0
    scan = (points - matrix[:3, 3]) @ matrix[:3, :3]
    for given in (labels.tolist(), None):
        found = abbe.register_to_features(scan, planes, labels=given)
        assert found.ok and numpy.allclose(found.matrix, matrix, atol=1e-6), given
    one = abbe.register_to_features(scan[labels == 0], planes[:1])
    assert not one.ok and "not determine" in one.status and "FeatureRegistration" in repr(one)
    assert not abbe.register_to_features(numpy.zeros((0, 3)), planes).ok


def test_deviations_are_those_of_the_command(tmp_path):
    transform = SCAN / "bracket-transform.csv"
    asked = ["deviate", *BRACKET, "--transform", transform, "--largest-mm", 0.3, "--lower-um", -50, "--upper-um", 60,
             "--faces-deg", 30, "--colour-um", 80]
    given = {"transform": transform, "largest_mm": 0.3, "lower_um": -50, "upper_um": 60, "faces_deg": 30,
             "colour_um": 80}
    result = abbe.scan_deviations(*BRACKET, **given)
    assert result.text() + "\nresults in wanted\n" == command([*asked, "-o", "wanted"], tmp_path)
    assert result.json_text() == command([*asked, "--json"], tmp_path)
    same_folder(result.files(), tmp_path / "wanted")
    assert abbe.scan_deviations(*BRACKET, page=False, **given).json_text() == result.json_text()
    assert result.has_points and result.counted.sum() == result.statistics_mm.count == len(result.counted_mm) == 1793
    assert numpy.array_equal(result.deviations_mm[result.counted], result.counted_mm) and 0.5 < result.within < 1
    assert result.closest_mm.shape == (2000, 3) and len(result.statistics_by_face_mm) > 3
    beyond = abbe.scan_deviations(*BRACKET, transform=transform, tolerances={"maximum_um": 50})
    assert beyond.exceeds_tolerance
    assert beyond.text() == command([*asked[:5], "--tolerance", "maximum_um=50"], tmp_path, exit_code=1)


def test_deviations_of_arrays_and_of_a_registration():
    part, scan = abbe.Mesh.read(BRACKET[1]), abbe.PointCloud.read(BRACKET[0])
    registration = abbe.register_scan(scan, part)
    result = abbe.scan_deviations(scan, part, transform=registration)
    assert numpy.array_equal(result.deviations_mm, registration.deviations_mm)
    assert numpy.array_equal(abbe.scan_deviations(scan.points_mm, part, transform=registration.matrix).deviations_mm,
                             result.deviations_mm)
    assert numpy.allclose(part.closest(registration.points_mm).distance_mm, result.deviations_mm, atol=1e-12)
    assert not result.elsewhere and abbe.scan_deviations(scan.points_mm + 300, part).elsewhere
    nothing = abbe.scan_deviations([[0, 0, 1e6]], part, largest_mm=1)
    assert not nothing.has_points and len(nothing.counted_mm) == 0 and nothing.text()


@bad_input
def test_work_on_a_part_stops():
    def stop(*_):
        raise StopIteration

    with pytest.raises(abbe.Stopped):
        abbe.register_scan(*BRACKET, progress=stop)


def test_deviations_are_drawn():
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    from abbe import plot

    part = abbe.Mesh.read(BRACKET[1])
    result = abbe.scan_deviations(BRACKET[0], part, transform=SCAN / "bracket-transform.csv", largest_mm=0.3)
    panel = plot.deviations(result, limits_um=(-50, 50)).axes[0]
    assert sum(bar.get_height() for bar in panel.patches) == len(result.counted_mm)
    assert "mean 14.4" in panel.get_title("left")
    plot.deviations(abbe.scan_deviations([[0, 0, 0]], part))
    with pytest.raises(abbe.InputError, match="no point"):
        plot.deviations(abbe.scan_deviations([[0, 0, 1e6]], part, largest_mm=1))
    matplotlib.pyplot.close("all")
