"""Points, meshes and scans, against the command."""

import json
import os
import signal
import threading
import time

import abbe
import numpy
import pytest
from use_examples import BUILD, EXAMPLES, command, machine

#: Also run under the address sanitizer (CMakeLists.txt).
bad_input = pytest.mark.bad_input

CRADLE, SCANNER = EXAMPLES / "cradle_scanner", EXAMPLES / "machines/liu-scanner.machine.toml"
CUBE = numpy.array([[x, y, z] for x in (0, 10) for y in (0, 10) for z in (0, 10)], float)
CUBE_TRIANGLES = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6],
                  [0, 6, 4],
                  [1, 5, 7], [1, 7, 3]]


def cube():
    return abbe.Mesh(CUBE, CUBE_TRIANGLES)


def test_meshes_are_read_and_written(tmp_path):
    part = abbe.Mesh.read(CRADLE / "pyramid.stl")
    assert part.vertices_mm.shape[1] == part.triangles.shape[1] == 3 and len(part) == len(part.triangles)
    assert part.triangles.max() < len(part.vertices_mm) and "STL" in part.format and "assumed" in part.unit
    for ending in ("ply", "stl"):
        part.write(tmp_path / f"part.{ending}")
        again = abbe.Mesh.read(tmp_path / f"part.{ending}")
        assert numpy.allclose(again.vertices_mm[again.triangles], part.vertices_mm[part.triangles], rtol=1e-6)
        with pytest.raises(FileExistsError):
            part.write(tmp_path / f"part.{ending}")
    inches = abbe.Mesh.read(tmp_path / "part.stl", unit="inch")
    assert numpy.allclose(inches.vertices_mm, 25.4 * abbe.Mesh.read(tmp_path / "part.stl").vertices_mm)
    (tmp_path / "two.obj").write_text("o a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\no b\nv 0 0 1\nf 1 2 4\n")
    two = abbe.Mesh.read(tmp_path / "two.obj")
    assert two.faces == 2 and two.face_of_triangle.tolist() == [0, 1] and len(two.face_names) == 2
    assert part.face_of_triangle is None and part.left_out == [] and part.notes == [] and part.deviation_mm == 0


def test_a_checked_mesh_is_that_of_the_command(tmp_path):
    cube().write(tmp_path / "cube.ply")
    part = abbe.Mesh.read(tmp_path / "cube.ply")
    assert part.check() == json.loads(command(["check", "cube.ply", "--json"], tmp_path))
    assert part.check_text() == command(["check", "cube.ply"], tmp_path)
    assert cube().check()["volume_mm3"] == pytest.approx(1000)
    readings = EXAMPLES / "scan/bracket-scan.csv"
    assert abbe.PointCloud.read(readings).check_text() == command(["check", readings], tmp_path)
    assert abbe.PointCloud.read(readings).check() == json.loads(command(["check", readings, "--json"], tmp_path))


def test_step_files_are_read_where_abbe_step_is(monkeypatch):
    if not (BUILD / "bin/abbe-step").exists():
        pytest.skip("abbe-step was not built")
    monkeypatch.setenv("ABBE_STEP_PROGRAM", str(BUILD / "bin/abbe-step"))
    steps = []
    part = abbe.Mesh.read(EXAMPLES.parent / "tests/golden/step/cylinder.step", chord_mm=0.1,
                          progress=lambda *step: steps.append(step))
    assert part.faces == 3 and 0 < part.deviation_mm <= 0.1 and part.face_of_triangle.max() == 2
    assert part.check()["closed"] and part.left_out == [] and "STEP" in part.format


@bad_input
def test_closest_points():
    mesh, random = cube(), numpy.random.default_rng(1)
    points = random.uniform(-5, 15, (5000, 3))
    found = mesh.closest(points)
    inside = ((points > 0) & (points < 10)).all(axis=1)
    outside = numpy.linalg.norm(points - points.clip(0, 10), axis=1)
    expected = numpy.where(inside, -numpy.minimum(points, 10 - points).min(axis=1), outside)
    assert numpy.allclose(found.distance_mm, expected, atol=1e-12)
    assert numpy.allclose(numpy.linalg.norm(found.points_mm - points, axis=1), abs(expected), atol=1e-12)
    assert numpy.allclose(numpy.linalg.norm(found.normals, axis=1), 1) and not found.on_border.any()
    assert found.triangles.min() >= 0 and found.triangles.max() < 12 and len(found) == 5000
    assert len(mesh.closest(numpy.zeros((0, 3)))) == 0
    one = abbe.Mesh(CUBE[:3], [[0, 1, 2]])
    assert one.closest([[-1, -1, -1]]).on_border.tolist() == [True]
    vertices = mesh.vertices_mm
    del mesh
    assert vertices.sum() == CUBE.sum() and not vertices.flags.writeable


@bad_input
@pytest.mark.parametrize("name, call", [
    ("vertices_mm", lambda: abbe.Mesh([[0, 0]], [[0, 0, 0]])),
    ("vertices_mm", lambda: abbe.Mesh([[0, 0, numpy.nan]], [[0, 0, 0]])),
    ("vertices_mm", lambda: abbe.Mesh("no mesh", [[0, 0, 0]])),
    ("triangles", lambda: abbe.Mesh([[0, 0, 0]], [[0, 0, 1]])),
    ("triangles", lambda: abbe.Mesh([[0, 0, 0]], [[0, 0, -1]])),
    ("triangles", lambda: abbe.Mesh([[0, 0, 0]], [[0, 0, 0.5]])),
    ("triangles", lambda: abbe.Mesh([[0, 0, 0]], [[0, 0, 1e30]])),
    ("triangles", lambda: abbe.Mesh([[0, 0, 0]], [0, 0, 0])),
    ("no triangle", lambda: abbe.Mesh([[0, 0, 0]], numpy.zeros((0, 3))).closest([[0, 0, 0]])),
    ("nowhere", lambda: abbe.Mesh.read("nowhere.stl")),
    ("unit", lambda: abbe.Mesh.read(CRADLE / "pyramid.stl", unit="ft")),
    ("chord_mm", lambda: abbe.Mesh.read(CRADLE / "pyramid.stl", chord_mm=0)),
    ("step_seconds", lambda: abbe.Mesh.read(CRADLE / "pyramid.stl", step_seconds=-1)),
    ("points_mm", lambda: cube().closest([[0, 0]])), ("points_mm", lambda: cube().closest([[0, 0, numpy.inf]])),
    ("points_mm", lambda: cube().closest([0, 0, 0])), ("points_mm", lambda: abbe.PointCloud([[1, 2]])),
    ("normals", lambda: abbe.PointCloud([[1, 2, 3]], [[0, 0, 0]])),
    ("normals", lambda: abbe.PointCloud([[1, 2, 3]], [[0, 0, 1]] * 2)),
    ("nowhere", lambda: abbe.PointCloud.read("nowhere.csv")),
    ("x.txt", lambda: abbe.PointCloud([[1, 2, 3]]).write("x.txt")), ("x.txt", lambda: cube().write("x.txt")),
    ("positions_mm_rad", lambda: abbe.scan_points(machine("liu-scanner"), [[0, 0]], [0])),
    ("positions_mm_rad", lambda: abbe.scan_points(machine("liu-scanner"), [0] * 5, [0])),
    ("indication_mm", lambda: abbe.scan_points(machine("liu-scanner"), [[0] * 5], [0, 0])),
    ("indication_mm", lambda: abbe.scan_points(machine("liu-scanner"), [[0] * 5], [numpy.nan])),
    ("beam", lambda: abbe.scan_points(machine("liu-scanner"), [[0] * 5], [0], beam=[0, 0, 0])),
    ("beam_zero_mm", lambda: abbe.scan_points(machine("liu-scanner"), [[0] * 5], [0], beam_zero_mm=[0, 0])),
    ("decimals", lambda: abbe.scan_points_file(CRADLE / "readings.csv", machine("liu-scanner"), "p.csv", decimals=13)),
    ("indication_range_mm", lambda: abbe.scan_points_file(CRADLE / "readings.csv", machine("liu-scanner"), "p.csv",
                                                          indication_range_mm=(1, 0))),
    ("p.xyz", lambda: abbe.scan_points_file(CRADLE / "readings.csv", machine("liu-scanner"), "p.xyz")),
    ("nowhere", lambda: abbe.scan_points_file("nowhere.csv", machine("liu-scanner"), "p.csv")),
    ("along_mm", lambda: abbe.plan_scan(cube(), machine("liu-scanner"), along_mm=0)),
    ("along_mm", lambda: abbe.plan_scan(cube(), machine("liu-scanner"), along_mm=1e-6)),
    ("largest_angle_deg", lambda: abbe.plan_scan(cube(), machine("liu-scanner"), largest_angle_deg=86)),
    ("beyond_plane", lambda: abbe.plan_scan(cube(), machine("liu-scanner"), beyond_planes_mm=[(0, 0, 0, 1)])),
    ("beyond_plane", lambda: abbe.plan_scan(cube(), machine("liu-scanner"), beyond_planes_mm=[(0, 0, 1, 11)])),
    ("position_mm", lambda: abbe.plan_scan(cube(), machine("liu-scanner"), position_mm=(0, 0, numpy.nan))),
    ("mesh", lambda: abbe.plan_scan(abbe.Mesh(CUBE, CUBE_TRIANGLES[1:]), machine("liu-scanner"))),
])
def test_bad_arguments_are_named(name, call, names_argument):
    names_argument(name, call)


@bad_input
def test_point_clouds_are_read_and_written(tmp_path):
    cloud = abbe.PointCloud([[1, 2, 3], [4, 5, 6]], [[0, 0, 2], [1, 0, 0]], name="two")
    assert cloud.normals.tolist() == [[0, 0, 1], [1, 0, 0]] and "two" in repr(cloud) and "normals" in repr(cloud)
    for ending in ("csv", "ply"):
        cloud.write(tmp_path / f"two.{ending}")
        again = abbe.PointCloud.read(tmp_path / f"two.{ending}")
        assert numpy.array_equal(again.points_mm, cloud.points_mm) and numpy.array_equal(again.normals, cloud.normals)
    (tmp_path / "other.csv").write_text("E,N,H,q\n1,2,3,x\n")
    other = abbe.PointCloud.read(tmp_path / "other.csv", columns={"x_mm": "E", "y_mm": "N", "z_m": "H"}, ignore=["q"])
    assert other.points_mm.tolist() == [[1, 2, 3000]] and other.normals is None and other.deviation_mm is None
    empty = abbe.PointCloud(numpy.zeros((0, 3)))
    assert len(empty) == 0 and empty.points_mm.shape == (0, 3) and empty.csv()
    with pytest.raises(abbe.InputError, match="no point"):
        empty.check()
    nothing = abbe.Mesh(numpy.zeros((0, 3)), numpy.zeros((0, 3)))
    assert len(nothing) == 0 and nothing.check()["triangles"] == 0 and nothing.check_text()


def test_points_are_those_of_the_command(tmp_path):
    scanner = machine("liu-scanner")
    stages = abbe.Errors.read(CRADLE / "stages.errors.toml", scanner)
    asked = ["scan", "points", CRADLE / "readings.csv", "--machine", SCANNER]
    with_errors = [*asked, "--errors", CRADLE / "stages.errors.toml", "--indication-range-mm", -0.02, 0.02, "-o",
                   "p.ply"]
    wanted = command(with_errors, tmp_path)
    result = abbe.scan_points_file(CRADLE / "readings.csv", stages, tmp_path / "own.ply",
                                   indication_range_mm=(-0.02, 0.02),
                                   errors_file=str(CRADLE / "stages.errors.toml"))
    assert result.text().replace(str(tmp_path / "own.ply"), "p.ply") == wanted
    assert (tmp_path / "own.ply").read_bytes() == (tmp_path / "p.ply").read_bytes()
    assert (result.readings, result.points) == (468, 363) and result.out_of_range == 105 and result.refused == ""
    told = json.loads(command([*with_errors, "--json", "--force"], tmp_path))
    assert {**result.to_dict(), "output": "p.ply"} == told or {**result.to_dict(), "points_file": "p.ply"} == told
    with pytest.raises(FileExistsError):
        abbe.scan_points_file(CRADLE / "readings.csv", scanner, tmp_path / "own.ply")
    abbe.scan_points_file(CRADLE / "readings.csv", scanner, tmp_path / "own.csv", decimals=12)
    text = command([*asked, "-o", "p.csv", "--decimals", 12], tmp_path)
    assert (tmp_path / "own.csv").read_bytes() == (tmp_path / "p.csv").read_bytes() and "without errors" in text


def test_points_of_arrays_are_those_of_the_file(tmp_path):
    scanner = machine("liu-scanner")
    stages = abbe.Errors.read(CRADLE / "stages.errors.toml", scanner)
    header, *rows = [line for line in (CRADLE / "readings.csv").read_text().splitlines() if not line.startswith("#")]
    table = dict(zip(header.split(","), numpy.array([row.split(",") for row in rows], float).T))
    indication = table.pop("indication_um") * 1e-3 if "indication_um" in table else table.pop("indication_mm")
    commands = abbe.positions(scanner, **{name: values for name,
                                          values in table.items() if name.split("_")[0] in scanner.axis_names})
    abbe.scan_points_file(CRADLE / "readings.csv", stages, tmp_path / "p.csv", decimals=12)
    from_file = abbe.PointCloud.read(tmp_path / "p.csv").points_mm
    found = abbe.scan_points(stages, commands, indication)
    assert numpy.allclose(found.points_mm[found.covered], from_file, atol=1e-9) and len(found) == len(rows)
    along = abbe.scan_points(stages, commands, indication + 1)
    assert numpy.allclose(numpy.linalg.norm(along.points_mm - found.points_mm, axis=1), 1)
    shifted = abbe.scan_points(stages, commands, indication, beam_zero_mm=-scanner.tool_direction,
                               beam=-2 * numpy.asarray(scanner.tool_direction))
    assert numpy.allclose(shifted.points_mm, along.points_mm)
    assert len(abbe.scan_points(scanner, numpy.zeros((0, 5)), [])) == 0


def test_the_planned_scan_is_that_of_the_command(tmp_path):
    asked = ["scan", "plan", CRADLE / "pyramid.stl", "--machine", SCANNER, "--along-mm", 1, "--between-mm", 1,
             "--beyond-plane-mm", 0, 1, 0, -0.8]
    files = ["-o", "p.csv", "--program", "p.ngc", "--coverage", "p.ply", "--report", "p.html"]
    wanted = command([*asked, *files], tmp_path)
    scanner, steps = machine("liu-scanner"), []
    result = abbe.plan_scan(CRADLE / "pyramid.stl", scanner, along_mm=1, between_mm=1,
                            beyond_planes_mm=[(0, 1, 0, -0.8)],
                            progress=lambda *step: steps.append(step))
    assert result.text() == wanted and result.complete and "PlannedScan" in repr(result)
    assert result.json_text() == command([*asked, "--json"], tmp_path)
    assert result.to_dict() == json.loads(result.json_text())
    for ending in ("csv", "ngc", "ply", "html"):
        result.write(tmp_path / f"own.{ending}")
        assert (tmp_path / f"own.{ending}").read_bytes() == (tmp_path / f"p.{ending}").read_bytes(), ending
    assert result.csv() == (tmp_path / "p.csv").read_text()
    assert result.coverage_ply() == (tmp_path / "p.ply").read_bytes()
    assert result.measures.sum() == result.points and result.positions_mm_rad.shape == (len(result), 5)
    assert result.face.max() < len(result.faces) and not result.blocked.any() and 0.99 < result.covered_share <= 1
    points = abbe.nominal_poses(scanner, result.positions_mm_rad[result.measures]).points_mm
    assert numpy.allclose(points, result.points_mm[result.measures], atol=1e-6)
    with pytest.raises(abbe.InputError, match="ending"):
        result.write(tmp_path / "own.txt")
    turned = abbe.plan_scan(abbe.Mesh.read(CRADLE / "pyramid.stl"), scanner, along_mm=2, between_mm=2,
                            position_mm=(1, 2, 3),
                            turn_deg=(0, 0, 30), stage=abbe.Mesh(CUBE + [500, 500, 500], CUBE_TRIANGLES))
    placed = ["scan", "plan", CRADLE / "pyramid.stl", "--machine", SCANNER, "--along-mm", 2, "--between-mm", 2,
              "--position-mm", 1,
              2, 3, "--turn-deg", 0, 0, 30, "--stage", "stage.ply", "-o", "t.csv"]
    abbe.Mesh(CUBE + [500, 500, 500], CUBE_TRIANGLES).write(tmp_path / "stage.ply")
    command(placed, tmp_path, exit_code=0 if turned.complete else 1)
    assert turned.csv() == (tmp_path / "t.csv").read_text()


@pytest.mark.parametrize("work", [
    lambda mesh, points: mesh.closest(points),
    lambda mesh, points: abbe.scan_deviations(points, mesh),
    lambda mesh, points: abbe.register_to_features(
        points, [abbe.Shape("plane", [0, 0, 0], [0, 0, 1]), abbe.Shape("sphere", [5, 5, 5], radius_mm=3)]),
], ids=["closest", "scan_deviations", "register_to_features"])
def test_an_interruption_ends_the_work_on_a_large_scan(work):
    mesh = abbe.Mesh([[0, 0, 0], [10, 0, 0], [10, 10, 0], [0, 10, 0]], [[0, 1, 2], [0, 2, 3]])
    points = numpy.random.default_rng(1).uniform(0, 10, (8_000_000, 3))
    finished = []
    with pytest.raises(KeyboardInterrupt):
        threading.Timer(0.2, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
        finished.append(work(mesh, points))
        time.sleep(60)
    assert not finished
