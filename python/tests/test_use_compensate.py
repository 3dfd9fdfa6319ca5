"""Corrected commands, NC programs and tables for controls, against the command."""

import os
import pathlib
import signal
import threading

import abbe
import numpy
import pytest
from use_examples import EXAMPLES, command, command_json, machine, mill, trunnion

MILL = ["--machine", EXAMPLES / "machines/three-axis-mill.machine.toml", "--errors",
        EXAMPLES / "compensate/mill.errors.toml"]
TRUNNION = ["--machine", EXAMPLES / "machines/trunnion-mill.machine.toml", "--errors",
            EXAMPLES / "compensate/trunnion.errors.toml"]


def test_poses_are_those_of_the_command(tmp_path):
    poses = EXAMPLES / "compensate/poses.csv"
    arguments = ["compensate", "poses", poses, *TRUNNION, "-o", "c.csv", "--limit-um", "500"]
    result = abbe.correct_commands(trunnion(), abbe.read_poses(poses, machine("trunnion-mill")), limit_um=500)
    assert result.text() + "c.csv written\n" == command(arguments, tmp_path)
    assert (tmp_path / "c.csv").read_text() == result.csv()
    assert result.to_dict("c.csv") == command_json(arguments, tmp_path)
    result.write(tmp_path / "own.csv")
    assert (tmp_path / "own.csv").read_bytes() == (tmp_path / "c.csv").read_bytes()
    assert result.positions_mm_rad.shape == (20, 5) and result.reached.all() and result.not_reached == 0
    assert result.largest_shift_mm[0] == result.shift_mm.max() == result.shift_mm[result.largest_shift_mm[1]]
    assert result.counts == {"reached": 20} or sum(result.counts.values()) == 20


def test_poses_that_are_held_or_refused(tmp_path):
    positions = numpy.zeros((3, 5))
    held = abbe.correct_commands(trunnion(), positions, hold=["C"])
    assert (held.positions_mm_rad[:, trunnion().machine.axis_names.index("C")] == 0).all()
    refused = abbe.correct_commands(trunnion(), positions, limit_um=0.001)
    with pytest.raises(abbe.InputError, match="limit_um"):
        refused.write(tmp_path / "x.csv")
    with pytest.raises(KeyError):
        abbe.correct_commands(trunnion(), positions, hold=["Q"])


@pytest.mark.parametrize("positions", [numpy.zeros(5), numpy.zeros((2, 4)), [["x"] * 5], [[1j] * 5],
                                       [[numpy.inf] * 5], 3, None])
def test_bad_poses_are_named(positions):
    with pytest.raises((abbe.InputError, TypeError)):
        abbe.correct_commands(trunnion(), positions)
    assert abbe.correct_commands(trunnion(), numpy.zeros((0, 5))).positions_mm_rad.shape == (0, 5)


@pytest.mark.parametrize(("file", "options", "errors", "keywords"), [
    ("cone.ngc", [*TRUNNION], trunnion, {}),
    ("plate.ngc", [*TRUNNION, "--tolerance-um", "2", "--decimals", "4"], trunnion, {"tolerance_um": 2, "decimals": 4}),
])
def test_programs_are_those_of_the_command(file, options, errors, keywords, tmp_path):
    source = EXAMPLES / "compensate" / file
    arguments = ["compensate", "gcode", source, *options, "-o", "o.ngc"]
    printed = command(arguments, tmp_path)
    wanted = (tmp_path / "o.ngc").read_bytes()
    told = []
    text = abbe.correct_program(errors(), source.read_text(), program_file=str(source),
                                progress=lambda *words: told.append(words), **keywords)
    assert text.program.encode() == wanted and text.text("o.ngc") == printed
    assert text.to_dict("o.ngc") == command_json(arguments, tmp_path)
    assert text.refused == [] and text.moves == text.to_dict()["moves"]
    assert 1e3 * text.largest_shift.value_mm_rad == text.to_dict()["largest_correction"]["value_um"]
    text.write(tmp_path / "own.ngc")
    assert (tmp_path / "own.ngc").read_bytes() == wanted
    streamed = abbe.correct_program_file(errors(), source, tmp_path / "streamed.ngc", **keywords)
    assert (tmp_path / "streamed.ngc").read_bytes() == wanted and streamed.program is None
    assert abbe.correct_program(errors(), source.read_bytes(), **keywords).program.encode() == wanted
    with pytest.raises(FileExistsError):
        abbe.correct_program_file(errors(), source, tmp_path / "streamed.ngc")


def test_programs_with_tools_parameters_and_start(tmp_path):
    (tmp_path / "tool.tbl").write_text("T1 P1 Z50.0 D6 ;mill\n")
    (tmp_path / "offsets.var").write_text("5221 10.0\n5222 5.0\n5223 -20.0\n")
    (tmp_path / "p.ngc").write_text("G54 G43 H1\nG1 X10 Y10 Z-100 F500\nX60 Y40\nM30\n")
    arguments = ["compensate", "gcode", "p.ngc", *MILL, "--tool-table", "tool.tbl", "--parameters", "offsets.var",
                 "--start", "X_mm=5", "--start", "Y_mm=6", "--start", "Z_mm=-40", "-o", "o.ngc"]
    printed = command(arguments, tmp_path)
    result = abbe.correct_program(mill(), (tmp_path / "p.ngc").read_text(), program_file="p.ngc",
                                  tools=abbe.read_nc_tools(tmp_path / "tool.tbl"),
                                  parameters=abbe.read_nc_parameters(tmp_path / "offsets.var"),
                                  start={"X_mm": 5, "Y_mm": 6, "Z_mm": -40})
    assert result.text("o.ngc") == printed and result.program == (tmp_path / "o.ngc").read_text()


def test_bad_programs_are_named(tmp_path):
    for bad in (5, None, ["G0"]):
        with pytest.raises((abbe.InputError, TypeError)):
            abbe.correct_program(mill(), bad)
    with pytest.raises(abbe.InputError) as error:
        abbe.correct_program(mill(), "G0 X0 Y0 Z0\nG1 X!\n", program_file="p.ngc")
    assert error.value.line == 2 and error.value.file == "p.ngc"
    for bad in ({"tolerance_um": 0}, {"limit_um": -1}, {"decimals": 20}, {"allow": ["all"]}, {"start": {"X": 1}},
                {"start": {"X_mm": 1e9}}, {"words": {"X": "A"}}, {"largest_turn_deg": float("nan")}):
        with pytest.raises(abbe.InputError, match=next(iter(bad))):
            abbe.correct_program(mill(), "G0 X0 Y0 Z0\n", **bad)
    refused = abbe.correct_program(mill(), "G0 X0 Y0 Z0\nG1 X600 Y400 Z-100 F500\n", limit_um=1)
    assert refused.program is None and "limit of 1 um" in refused.refused[0]
    with pytest.raises(abbe.InputError, match="nothing is written"):
        refused.write(tmp_path / "x.ngc")
    with pytest.raises(abbe.InputError, match="the program itself"):
        (tmp_path / "p.ngc").write_text("G0 X0\n")
        abbe.correct_program_file(mill(), tmp_path / "p.ngc", tmp_path / "p.ngc", overwrite=True)


def test_text_that_is_no_utf8_is_kept():
    program = b"(Fr\xe4sen)\nG0 X10 Y10 Z-50\nG1 X20 F100\n"
    assert abbe.correct_program(mill(), program).program.encode(errors="surrogateescape").startswith(b"(Fr\xe4sen)\n")


def test_a_long_program_is_stopped():
    program = "G0 X0 Y0 Z0\nF500\n" + "".join(f"G1 X{k % 600} Y{k % 400}\n" for k in range(1500000))

    def stop(*_):
        raise StopIteration

    with pytest.raises(abbe.Stopped):
        abbe.correct_program(mill(), program, progress=stop)


def test_an_interruption_ends_a_program_that_becomes_gigabytes():
    program = "G0 X0 Y0 Z0\n" + 50 * "G90 X0\nG91 G81 X0.0001 Z-5 R2 F600 L1000000\n"
    threading.Timer(0.2, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt):
        abbe.correct_program(mill(), program, max_output_mb=1e6, max_minutes=60)


@pytest.mark.parametrize(("format_", "options", "keywords"), [
    ("linuxcnc", [], {}),
    ("linuxcnc", ["--axis", "X", "--type", "0", "--max-points", "20", "--interpolation-um", "5"],
     {"axes": ["X"], "type": 0, "max_points": 20, "interpolation_um": 5}),
    ("siemens-cec", ["--name", "X=X1", "--at", "Z_mm=-100"], {"names": {"X": "X1"}, "at": {"Z_mm": -100}}),
])
def test_tables_are_those_of_the_command(format_, options, keywords, tmp_path):
    arguments = ["compensate", "table", *MILL, "--for", format_, *options, "--limit-um", "200", "-o", "t", "--map",
                 "map.csv"]
    tables = abbe.control_tables(mill(), format_, limit_um=200, **keywords)
    assert not tables.says_no, (tables.refused, tables.too_few_nodes)
    printed = command(arguments, tmp_path)
    written = [f"t/{name}" for name in tables.files]
    assert tables.text([*written, "map.csv"]) == printed
    assert {name: (tmp_path / "t" / name).read_text() for name in tables.files} == tables.files
    assert sorted(tables.files) == sorted(p.name for p in (tmp_path / "t").iterdir() if not p.name.startswith("."))
    assert (tmp_path / "map.csv").read_text() == tables.map_csv()
    assert tables.to_dict([*written, "map.csv"]) == command_json(arguments, tmp_path)
    assert [pathlib.Path(name).name for name in tables.write(tmp_path / "own")] == list(tables.files)
    assert tables.after.position_mm.shape == tables.before.position_mm.shape == (len(tables.positions_mm_rad),)
    assert tables.after.position_statistics_mm.mean < tables.before.position_statistics_mm.mean


def test_tables_that_must_not_be_used(tmp_path):
    tables = abbe.control_tables(mill(), "linuxcnc", limit_um=0.1)
    assert tables.says_no and tables.files == {} and "limit_um" in tables.refused[0]
    with pytest.raises(abbe.InputError, match="nothing is written"):
        tables.write(tmp_path / "t")
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "other").write_text("")
    with pytest.raises(abbe.InputError):
        abbe.control_tables(mill(), "linuxcnc").write(tmp_path / "full")
    with pytest.raises(abbe.InputError, match="files are to be written"):
        abbe.control_tables(mill(), "linuxcnc").write_file(tmp_path / "x.comp")
    one = abbe.control_tables(mill(), "linuxcnc", axes=["X"])
    one.write_file(tmp_path / "x.comp")
    assert (tmp_path / "x.comp").read_text() == one.files["X.comp"]


def test_formats_and_bad_requests():
    formats = {f.name: f for f in abbe.table_formats()}
    assert "linuxcnc" in formats and "negate" in formats["siemens-cec"].takes
    with pytest.raises(abbe.InputError, match="format"):
        abbe.control_tables(mill(), "nothing")
    for bad in ({"negate": True}, {"axes": ["Q"]}, {"at": {"X": 1}}, {"at": {"X_mm": float("inf")}}, {"max_points": 1},
                {"least_reduction_percent": 200}, {"limit_um": 0}, {"positions": 1}, {"detection_unit_um": 1},
                {"names": {"Q": "1"}}):
        with pytest.raises(abbe.InputError) as error:
            abbe.control_tables(mill(), "linuxcnc", **bad)
        assert "--" not in str(error.value), error.value
