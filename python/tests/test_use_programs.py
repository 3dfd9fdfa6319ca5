"""Programs that drive a machine to readings and to touches of a ball, against the command."""

import numpy
import pytest
from use_examples import EXAMPLES, command, command_json, machine

import abbe

POSES = EXAMPLES / "measuring_program/poses.csv"
PROGRAM = ["program", POSES, "--machine", EXAMPLES / "machines/trunnion-mill.machine.toml"]
BOX = (-60, -60, 0, 60, 60, 80)
POST = abbe.Mesh([[x, y, z] for x in (-20, 20) for y in (-20, 20) for z in (0, 90)],
                 [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6],
                  [0, 6, 4], [1, 5, 7], [1, 7, 3]], name="post.stl")


def listed_positions():
    """Of the readings, mm and rad: C, A, Y, X, Z."""
    numbers = numpy.loadtxt(POSES, delimiter=",", skiprows=2, usecols=range(5))
    return numbers * [numpy.pi / 180, numpy.pi / 180, 1, 1, 1]


def planned(dialect="linuxcnc", readings=POSES, **keywords):
    return abbe.plan_measurement(machine("trunnion-mill"), readings, dialect, **keywords)


def probed(readings=POSES, ball=(80, 0, 60, 12.5), **keywords):
    return abbe.plan_probing(machine("trunnion-mill"), readings, ball, **keywords)


@pytest.mark.parametrize(("dialect", "options", "keywords"), [
    ("linuxcnc", [], {}),
    ("heidenhain", ["--obstacle-box-mm", "table=-60,-60,0,60,60,80", "--tool-radius-mm", "5", "--tool-length-mm", "150",
                    "--clearance-mm", "200", "--dwell-s", "3"],
     {"obstacle_boxes_mm": [("table", BOX)], "tool_radius_mm": 5, "tool_length_mm": 150, "clearance_mm": 200,
      "dwell_s": 3}),
    ("siemens", ["--trigger", "output", "--trigger-number", "3", "--pulse-s", "0.2", "--reading-s", "1.5", "--stop-at",
                 "none", "--shorten", "--word", "C=C1=", "--decimals", "3", "--machine-coordinates"],
     {"trigger": "output", "trigger_number": 3, "pulse_s": 0.2, "reading_s": 1.5, "stop_at": "none", "shorten": True,
      "words": {"C": "C1="}, "decimals": 3, "machine_coordinates": True}),
    ("fanuc", ["--feed-mm-per-min", "2000", "--linear-speed-mm-per-s", "50", "--rotary-speed-deg-per-s", "10"],
     {"feed_mm_per_min": 2000, "linear_speed_mm_per_s": 50, "rotary_speed_deg_per_s": 10}),
    ("linuxcnc", ["--obstacle-box-mm", "base=-300,-300,-100,-250,300,100", "--obstacle-mesh", "table=post.stl",
                  "--clear-at", "Z_mm=0", *(word for start in ("C_deg=0", "A_deg=0", "Y_mm=0", "X_mm=0", "Z_mm=0")
                                            for word in ("--start", start))],
     {"obstacle_boxes_mm": [("base", (-300, -300, -100, -250, 300, 100))], "obstacle_meshes": [("table", POST)],
      "clear_at": {"Z_mm": 0}, "start": {"C_deg": 0, "A_deg": 0, "Y_mm": 0, "X_mm": 0, "Z_mm": 0}}),
])
def test_programs_are_those_of_the_command(dialect, options, keywords, tmp_path):
    POST.write(tmp_path / "post.stl")
    arguments = [*PROGRAM, "--dialect", dialect, *options, "-o", "o.nc", "--sheet", "s.html"]
    program = planned(dialect, name="o.nc", **keywords)
    assert program.refused == ""
    assert program.text() + "o.nc written\ns.html written\n" == command(arguments, tmp_path)
    assert (tmp_path / "o.nc").read_text() == program.program
    assert (tmp_path / "s.html").read_text(encoding="utf-8") == program.sheet_html()
    assert program.to_dict() == command_json(arguments, tmp_path)
    program.write(tmp_path / "own.nc")
    program.write_sheet(tmp_path / "own.html")
    assert (tmp_path / "own.nc").read_bytes() == (tmp_path / "o.nc").read_bytes()
    assert (tmp_path / "own.html").read_bytes() == (tmp_path / "s.html").read_bytes()
    with pytest.raises(FileExistsError):
        program.write(tmp_path / "own.nc")
    assert program.dialect == dialect and program.time_s == program.finished_s[-1] > 0
    assert program.ways_around == sum(len(reading.via_mm_rad) > 0 for reading in program.readings)


def test_figures_of_a_program():
    program = planned(obstacle_boxes_mm=[("table", BOX)], tool_radius_mm=5, tool_length_mm=150, clearance_mm=200)
    assert len(program) == len(program.readings) == 12 and program.ways_around == 2 and program.obstacles == ["box 1"]
    assert [(s.station, s.setup, s.first, s.count) for s in program.sections] == [("front", "", 0, 7), ("left", "", 7, 5)]
    assert program.sections[0].words == "station front"
    assert any("(start says where it begins)" in note for note in program.notes)
    assert numpy.allclose(program.positions_mm_rad, listed_positions(), atol=1e-8)
    reading = program.readings[-1]
    assert (reading.number, reading.line, reading.station, reading.target) == (12, 14, "left", "nose")
    assert (reading.position_mm_rad == program.positions_mm_rad[-1]).all() and reading.via_mm_rad.shape[1] == 5
    assert (numpy.diff(program.finished_s) > 0).all() and program.finished_s.shape == (12,)
    frame = program.to_dataframe()
    assert frame["C_deg"].iloc[-1] == pytest.approx(135.123456) and list(frame["target"][:2]) == ["nose", "side"]


def test_readings_as_arrays_and_plans():
    positions = listed_positions()
    from_array, from_file = planned(readings=positions, stop_at="none"), planned(stop_at="none")
    assert (from_array.positions_mm_rad == from_file.positions_mm_rad).all()
    assert from_array.readings[0].line is None and from_array.readings[0].target == ""
    assert "12 readings of readings" in from_array.text() and "line" not in from_array.to_dict()["sections"][0]["readings"][0]
    assert "12 readings of mine.csv" in planned(readings=positions, readings_file="mine.csv").text()
    moves = [line for line in from_array.program.splitlines() if line.startswith("G0")]
    assert moves == [line for line in from_file.program.splitlines() if line.startswith("G0")]
    touching = planned(readings=positions, obstacle_boxes_mm=[("table", (-400, -400, 0, 400, 400, 600))])
    assert touching.refused.startswith("readings: at reading 1 the tool touches box 1")
    plan = abbe.Study.read(EXAMPLES / "trunnion/trunnion.study.toml").plan()
    assert numpy.allclose(planned(readings=plan, stop_at="none").positions_mm_rad, plan.positions_mm_rad, atol=2e-6)


def test_ways_that_are_not_clear_are_refused(tmp_path):
    options = ["--obstacle-box-mm", "table=-60,-60,0,60,60,80", "--tool-radius-mm", "5", "--tool-length-mm", "150"]
    program = planned(obstacle_boxes_mm=[("table", BOX)], tool_radius_mm=5, tool_length_mm=150)
    arguments = [*PROGRAM, "--dialect", "linuxcnc", *options, "-o", "o.ngc"]
    assert program.to_dict() == command_json(arguments, tmp_path, exit_code=1)
    assert "touches box 1" in program.refused and "neither clearance_mm nor clear_at is given" in program.refused
    assert program.program is None and program.time_s is None and numpy.isnan(program.finished_s).all()
    for write in (program.write, program.write_sheet):
        with pytest.raises(abbe.InputError, match="nothing is written"):
            write(tmp_path / "x")
    with pytest.raises(abbe.InputError, match="clearance_mm"):
        program.sheet_html()
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(("keywords", "field"), [
    ({"dialect": "mazak"}, "dialect"), ({"trigger": "light"}, "trigger"), ({"stop_at": "never"}, "stop_at"),
    ({"trigger": "m-function"}, "trigger_number"), ({"trigger_number": 3}, "trigger_number"),
    ({"trigger": "output", "trigger_number": 100000}, "trigger_number"), ({"decimals": 0}, "decimals"),
    ({"decimals": 10}, "decimals"), ({"feed_mm_per_min": 0}, "feed_mm_per_min"),
    ({"feed_mm_per_min": float("nan")}, "feed_mm_per_min"), ({"dwell_s": -1}, "dwell_s"),
    ({"reading_s": float("inf")}, "reading_s"), ({"pulse_s": 4000}, "pulse_s"), ({"words": {"Q": "A"}}, "words"),
    ({"words": {"X": "Y"}}, "words"), ({"start": {"X_mm": 0}}, "start"), ({"start": {"X": 0}}, "start"),
    ({"tool_radius_mm": float("nan")}, "tool_radius_mm"), ({"tool_length_mm": -1}, "tool_length_mm"),
    ({"clearance_mm": 1e6}, "clearance_mm"), ({"clear_at": {"Z_mm": 1e4}}, "clear_at"),
    ({"linear_speed_mm_per_s": 0}, "linear_speed_mm_per_s"), ({"rotary_speed_deg_per_s": -1}, "rotary_speed_deg_per_s"),
    ({"obstacle_boxes_mm": [("floor", BOX)]}, "obstacle_boxes_mm"),
    ({"obstacle_boxes_mm": [("base", (0, 0, 0, 1, 1, 0))]}, "obstacle_boxes_mm"),
    ({"obstacle_boxes_mm": [("base", (0, 0, 0, 1, 1, float("nan")))]}, "obstacle_boxes_mm"),
    ({"obstacle_meshes": [("Q", POST)]}, "obstacle_meshes"),
    ({"dialect": "iso", "obstacle_boxes_mm": [("table", BOX)]}, "feed_mm_per_min"),
    ({"dialect": "fanuc", "machine_coordinates": True, "feed_mm_per_min": 100}, "feed_mm_per_min"),
    ({"readings": [[0, 0, 0, 0]]}, "readings"), ({"readings": [[0, 0, 0, 301, 0]]}, "readings"),
    ({"readings": numpy.zeros((0, 5))}, "readings"), ({"readings": [[0, 0, 0, 0, float("nan")]]}, "readings"),
    ({"readings": {"X_mm": [0]}}, "readings"), ({"readings": b"X_mm"}, "readings"),
])
def test_bad_arguments_are_named(keywords, field):
    with pytest.raises(abbe.InputError) as error:
        planned(**keywords)
    assert error.value.field.split()[0] == field and "--" not in str(error.value), error.value


def test_arguments_of_other_types_are_refused(tmp_path):
    for bad in ({"obstacle_boxes_mm": [("base", (0, 0, 0, 1, 1))]}, {"obstacle_boxes_mm": "base"}, {"readings": None},
                {"obstacle_meshes": [("base", 3)]}, {"start": [0]}, {"decimals": 2.5}):
        with pytest.raises(TypeError):
            planned(**bad)
    with pytest.raises(abbe.InputError, match="none.stl"):
        planned(obstacle_meshes=[("base", tmp_path / "none.stl")])
    with pytest.raises(abbe.InputError, match="none.csv"):
        planned(readings=tmp_path / "none.csv")
    (tmp_path / "poses.csv").write_text("C_deg,A_deg,Y_mm,X_mm,Z_mm\n0,0,0,0,0\n0,0,0,301,0\n")
    with pytest.raises(abbe.InputError) as error:
        planned(readings=tmp_path / "poses.csv")
    assert error.value.line == 3 and error.value.field == "X_mm"


@pytest.mark.parametrize(("options", "keywords"), [
    ([], {}),
    (["--tip-radius-mm", "2", "--touches-per-ball", "7", "--pre-touch-mm", "4", "--over-travel-mm", "1.5",
      "--probing-feed-mm-per-min", "120", "--probe-log", "log.txt", "--feed-mm-per-min", "3000", "--dwell-s", "0",
      "--decimals", "4", "--tool-radius-mm", "4", "--tool-length-mm", "60", "--obstacle-mesh", "table=post.stl"],
     {"tip_radius_mm": 2, "touches_per_ball": 7, "pre_touch_mm": 4, "over_travel_mm": 1.5,
      "probing_feed_mm_per_min": 120, "probe_log": "log.txt", "feed_mm_per_min": 3000, "dwell_s": 0, "decimals": 4,
      "tool_radius_mm": 4, "tool_length_mm": 60, "obstacle_meshes": [("table", POST)]}),
])
def test_touches_are_those_of_the_command(options, keywords, tmp_path):
    POST.write(tmp_path / "post.stl")
    arguments = [*PROGRAM, "--dialect", "linuxcnc", "--probe-ball-mm", "80", "0", "60", "12.5", "--clearance-mm", "150",
                 *options, "-o", "o.ngc", "--touches", "t.csv"]
    program = probed(clearance_mm=150, **keywords)
    assert program.refused == ""
    assert program.text() + "o.ngc written\nt.csv written\n" == command(arguments, tmp_path)
    assert (tmp_path / "o.ngc").read_text() == program.program and (tmp_path / "t.csv").read_text() == program.touches_csv()
    assert program.to_dict() == command_json(arguments, tmp_path)
    program.write(tmp_path / "own.ngc")
    program.write_touches(tmp_path / "own.csv")
    assert (tmp_path / "own.ngc").read_bytes() == (tmp_path / "o.ngc").read_bytes()
    assert (tmp_path / "own.csv").read_bytes() == (tmp_path / "t.csv").read_bytes()
    assert len(program) == 12 * keywords.get("touches_per_ball", 5) and program.ball_positions == 12
    assert program.positions_mm_rad.shape == (len(program), 5)
    assert numpy.allclose(numpy.linalg.norm(program.approaches, axis=1), 1) and program.names[0] == "reading 1, touch 1"


def test_touches_meet_the_ball():
    program = probed(clearance_mm=150)
    poses = abbe.nominal_poses(program.machine, program.positions_mm_rad)
    gap = numpy.array([80, 0, 60]) - poses.points_mm
    assert numpy.allclose(numpy.linalg.norm(gap, axis=1), 15.5, atol=2e-6)
    towards = numpy.einsum("nij,nj->ni", poses.rotations, program.approaches)
    assert numpy.allclose((towards * gap).sum(axis=1), 15.5, atol=2e-6)


def test_a_log_becomes_readings_as_by_the_command(tmp_path):
    program = probed(clearance_mm=150)
    degrees = [axis.kind == "rotary" for axis in program.machine.axes]
    stated = dict(zip(program.machine.axis_names, numpy.where(degrees, numpy.degrees(program.positions_mm_rad),
                                                              program.positions_mm_rad).T, strict=True))
    log = numpy.array([stated.get(word, numpy.zeros(len(program))) for word in "XYZABCUVW"]).T
    log[3, 0] += 0.25                                               # where the probe really touched
    numpy.savetxt(tmp_path / "touches.txt", log, fmt="%.6f")
    program.write_touches(tmp_path / "touches.csv")
    command(["import", "touches.txt", "--touches", "touches.csv", *PROGRAM[2:], "-o", "readings.csv"], tmp_path)
    text = (tmp_path / "touches.txt").read_text()
    assert program.readings_csv(text) == program.readings_csv(text.encode()) == (tmp_path / "readings.csv").read_text()
    lines = text.splitlines(keepends=True)
    with pytest.raises(abbe.InputError, match="touches_csv") as error:
        program.readings_csv("".join(lines[:-1]), log_file="touches.txt")
    assert error.value.file == "touches.txt"
    with pytest.raises(abbe.InputError, match="log"):
        program.readings_csv(3)


def test_balls_out_of_reach_and_bad_arguments(tmp_path):
    far = probed(ball=(80, 0, 600, 12.5), clearance_mm=150)
    assert "out of reach" in far.refused and far.program is None and far.text() == ""
    for write in (far.write, far.write_touches):
        with pytest.raises(abbe.InputError, match="nothing is written"):
            write(tmp_path / "x")
    with pytest.raises(abbe.InputError, match="out of reach"):
        far.readings_csv("")
    for bad in ({"tip_radius_mm": 0}, {"touches_per_ball": 3}, {"pre_touch_mm": float("nan")}, {"over_travel_mm": -1},
                {"probing_feed_mm_per_min": 0}, {"probe_log": "a b"}, {"decimals": 10}, {"dwell_s": -1},
                {"words": {"X": "XX"}}, {"clear_at": {"Q_mm": 0}}, {"readings": [[0, 0, 0]]}):
        with pytest.raises(abbe.InputError, match=next(iter(bad))):
            probed(**bad)
    for ball in ((80, 0, 60, 0), (80, 0, float("nan"), 12.5), (80, 0, 60, float("inf"))):
        with pytest.raises(abbe.InputError, match="^probe_ball_mm"):
            probed(ball=ball)
    with pytest.raises(TypeError):
        probed(ball=(80, 0, 60))
