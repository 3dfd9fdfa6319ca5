"""Paths, test pieces, placements and published studies, against the command."""

import json
import os
import signal
import threading
import time

import abbe
import numpy
import pytest
from use_examples import BUILD, EXAMPLES, command, command_json, machine

ENGRAVER = EXAMPLES / "machines/yin-engraver-u.machine.toml"
LASER = EXAMPLES / "laser_engraver"


def engraver():
    return machine("yin-engraver-u")


def test_a_path_is_that_of_the_command(tmp_path):
    arguments = ["path", LASER / "table-a4.csv", "--machine", ENGRAVER, "--placement", LASER / "part.placement.toml",
                 "-o", "program.ngc", "-o", "commands.csv", "--report", "path.html"]
    planned = abbe.plan_path(engraver(), abbe.Curve.read(LASER / "table-a4.csv", engraver()),
                             placement=abbe.Placement.read(LASER / "part.placement.toml"),
                             placement_file=str(LASER / "part.placement.toml"))
    assert planned.text() + "program.ngc written\ncommands.csv written\n" == command(arguments, tmp_path)
    assert planned.to_dict() == command_json(arguments, tmp_path)
    assert planned.program() == (tmp_path / "program.ngc").read_text()
    assert planned.csv() == (tmp_path / "commands.csv").read_text()
    assert planned.page_html() == (tmp_path / "path.html").read_text()
    planned.write(tmp_path / "own.ngc")
    assert (tmp_path / "own.ngc").read_bytes() == (tmp_path / "program.ngc").read_bytes()
    assert planned.refused == "" and planned.status == "followed" and planned.miss_mm < 1e-9
    assert planned.positions_mm_rad.shape == (30, len(engraver().axes)) and planned.failed_point is None


def test_regions_with_errors_words_and_tolerance(tmp_path):
    arguments = ["path", LASER / "regions.ngc", "--machine", ENGRAVER, "--errors", LASER / "linkage.errors.toml",
                 "--retract-mm", "20", "--tolerance-um", "1", "--word", "C1=C", "--word", "C2=B", "-o", "p.ngc"]
    printed = command(arguments, tmp_path)
    planned = abbe.plan_path(engraver(), abbe.Curve.read(LASER / "regions.ngc", engraver()),
                             errors=abbe.Errors.read(LASER / "linkage.errors.toml", engraver()), retract_mm=20,
                             tolerance_um=1)
    assert planned.text() + "p.ngc written\n" == printed
    assert planned.program(words={"C1": "C", "C2": "B"}) == (tmp_path / "p.ngc").read_text()
    assert planned.regions == len(set(planned.region.tolist())) and planned.inserted == (planned.point == -1).sum() - 2 * planned.regions


def test_curves_of_arrays():
    read = abbe.Curve.read(LASER / "table-a4.csv", engraver())
    made = abbe.Curve(read.points_mm, read.directions, feed_mm_per_min=read.feed_mm_per_min, working=read.working,
                      dwell_s=read.dwell_s)
    assert numpy.array_equal(made.points_mm, read.points_mm) and made.working_runs() == read.working_runs()
    again = abbe.Curve.parse(abbe.Curve([[0, 0, 0], [1, 2, 3]], feed_mm_per_min=60).csv(), engraver())
    assert again.points_mm.tolist() == [[0, 0, 0], [1, 2, 3]] and again.feed_mm_per_min.tolist() == [60, 60]
    indexed = abbe.Curve([[0, 0, 0]] * 2, indexed_mm_rad={"C2": [0.1, 0.1]})
    assert indexed.indexed == ["C2"]
    with pytest.raises(abbe.InputError, match="set beforehand"):
        indexed.csv()
    with pytest.raises(KeyError):
        abbe.plan_path(machine("three-axis-mill"), indexed)
    for bad in ({"points_mm": [0, 0, 0]}, {"points_mm": [[0, 0]]}, {"points_mm": [[0, 0, numpy.nan]]},
                {"points_mm": "x"}, {"points_mm": [[0, 0, 0]], "directions": [0, 0, 0]},
                {"points_mm": [[0, 0, 0]], "feed_mm_per_min": -1}, {"points_mm": [[0, 0, 0]], "dwell_s": [1, 2]},
                {"points_mm": [[0, 0, 0]], "indexed_mm_rad": {"C2": []}}):
        with pytest.raises(abbe.InputError):
            abbe.Curve(**bad)


def test_bad_paths_are_named():
    curve = abbe.Curve([[100, 100, 200], [110, 100, 200]])
    mill = machine("three-axis-mill")
    with pytest.raises(abbe.InputError, match="feed_mm_per_min"):
        abbe.plan_path(mill, curve)
    for bad in ({"feed_mm_per_min": 0}, {"retract_mm": -1}, {"tolerance_um": numpy.nan}, {"hold": {"X": 1}},
                {"start": {"Q_mm": 1}}):
        with pytest.raises(abbe.InputError, match=next(iter(bad))):
            abbe.plan_path(mill, curve, **bad)
    far = abbe.plan_path(mill, abbe.Curve([[100, 100, 200], [1e5, 0, 200]], feed_mm_per_min=100))
    assert not far.has_path and far.refused and far.failed_point == 1 and len(far) == 0
    with pytest.raises(abbe.InputError):
        far.program()
    with pytest.raises(abbe.InputError, match="unknown kind"):
        abbe.plan_path(mill, curve, feed_mm_per_min=100).program(name="x.txt")
    with pytest.raises(abbe.InputError, match="no points"):
        abbe.plan_path(mill, abbe.Curve(numpy.zeros((0, 3))))


@pytest.mark.parametrize(("name", "sizes"), [("cone-frustum", abbe.ConeFrustum), ("s-shape", abbe.SShape)])
def test_test_pieces_are_those_of_the_command(name, sizes, tmp_path):
    command(["test-piece", name, "--centre-mm", "1", "2", "30", "--height-mm", "25", "--chord-um", "5", "-o", "p.csv"],
            tmp_path)
    piece = sizes(centre_mm=(1, 2, 30), height_mm=25).piece(chord_um=5)
    lines = (tmp_path / "p.csv").read_text().splitlines(keepends=True)
    assert piece.curve.csv() == "".join(line for line in lines if not line.startswith("#"))
    assert piece.foot_mm.shape == piece.head_normals.shape == (len(piece.curve), 3) and piece.tool_radius_mm == 10
    for bad in ({"height_mm": -1}, {"height_mm": numpy.nan}, {"tool_diameter_mm": 1e9}):
        if name == "cone-frustum" and "tool_diameter_mm" in bad:
            continue
        with pytest.raises(abbe.InputError):
            sizes(**bad)


def test_paths_of_poses():
    mill = machine("trunnion-mill")
    t = numpy.linspace(0, 1, 50)
    directions = numpy.column_stack([0.3 * numpy.cos(6 * t), 0.3 * numpy.sin(6 * t), numpy.ones(50)])
    points = numpy.column_stack([20 * t, 0 * t, 40 + 0 * t])
    path = abbe.follow_path(mill, points, directions=directions)
    assert path.status == "followed", path.text()
    poses = abbe.nominal_poses(mill, path.positions_mm_rad)
    assert numpy.abs(poses.points_mm - points).max() < 1e-6
    again = abbe.follow_path(mill, poses.points_mm, rotations=poses.rotations)
    assert again.status in ("followed", "not-reached")
    with pytest.raises(abbe.InputError, match="directions"):
        abbe.follow_path(mill, points, directions=directions[:3])
    assert abbe.follow_path(mill, points + 1e5, directions=directions).failed_pose == 0


def test_placements():
    placement = abbe.Placement.read(LASER / "part.placement.toml")
    again = abbe.Placement.parse(placement.text())
    assert numpy.allclose(again.matrix, placement.matrix, atol=1e-12)
    made = abbe.Placement(placement.matrix, numpy.eye(6) * 1e-6)
    assert numpy.array_equal(made.matrix, placement.matrix) and made.covariance.shape == (6, 6)
    moved = made.machine_with_workpiece(engraver())
    assert not numpy.array_equal(moved.bed_from_workpiece, engraver().bed_from_workpiece)
    angles = (0.1, -0.2, 0.3)
    assert numpy.allclose(abbe.angles_xyz(abbe.rotation_xyz(angles)), angles)
    for bad in (numpy.zeros((4, 4)), numpy.eye(3), 2 * numpy.eye(4), "x", [[numpy.nan] * 4] * 4):
        with pytest.raises(abbe.InputError):
            abbe.Placement(bad)


def test_a_reproduced_study_without_a_folder(tmp_path):
    if not (BUILD / "bin/abbe-papers").exists():
        pytest.skip("abbe-papers is not built")
    ma = abbe.reproduce("ma", tmp_path / "ma")
    assert "summary.json" in ma.files and "report.html" in ma.files
    without = abbe.reproduce("ma")
    assert without.summary == ma.summary == json.loads(command(["reproduce", "ma", "--json"], tmp_path)) and without.files == []


def test_programs_of_studies_that_are_missing_or_others(tmp_path, monkeypatch):
    with pytest.raises(abbe.InputError, match="is no study"):
        abbe.reproduce("nobody")
    with pytest.raises(abbe.InputError, match="does not belong to ma"):
        abbe.reproduce("ma", grids=tmp_path)
    monkeypatch.setenv("ABBE_PAPERS_PROGRAM", str(tmp_path / "none"))
    with pytest.raises(abbe.InputError, match="ABBE_PAPERS_PROGRAM"):
        abbe.reproduce("ma")
    other = tmp_path / "other"
    other.write_text("#!/bin/sh\necho abbe-papers 0.0.1\n")
    other.chmod(0o755)
    monkeypatch.setenv("ABBE_PAPERS_PROGRAM", str(other))
    with pytest.raises(abbe.InputError, match="is version 0.0.1, and abbe is"):
        abbe.reproduce("ma")
    monkeypatch.delenv("ABBE_PAPERS_PROGRAM")
    monkeypatch.setattr("abbe._reproduce._candidates", list)
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(abbe.InputError, match="abbe-papers: this program.*is missing"):
        abbe.reproduce("ma")


def test_an_interruption_ends_the_program(tmp_path, monkeypatch):
    slow = tmp_path / "slow"
    slow.write_text(f'#!/bin/sh\nif [ "$1" = --version ]; then echo abbe-papers {abbe.__version__}; exit; fi\n'
                    f"echo $$ > {tmp_path}/pid\nexec sleep 60\n")
    slow.chmod(0o755)
    monkeypatch.setenv("ABBE_PAPERS_PROGRAM", str(slow))
    def interrupt():
        while not (tmp_path / "pid").exists() or not (tmp_path / "pid").read_text().strip():
            time.sleep(0.02)
        signal.pthread_kill(threading.main_thread().ident, signal.SIGINT)

    threading.Thread(target=interrupt).start()
    with pytest.raises(KeyboardInterrupt):
        abbe.reproduce("ma")
    with pytest.raises(ProcessLookupError):
        os.kill(int((tmp_path / "pid").read_text()), 0)
