"""Tables of other programs, against the command: the same bytes."""

import csv
import gzip
import json

import abbe
import numpy
import pytest
from use_examples import EXAMPLES, command, machine

#: Also run under the address sanitizer (CMakeLists.txt).
bad_input = pytest.mark.bad_input

IMPORT = EXAMPLES / "import"
MILL = EXAMPLES / "machines/three-axis-mill.machine.toml"
STATION, POSITIONING = IMPORT / "total-station.txt", IMPORT / "positioning.csv"
NO_UNITS = b"Name;X;Y;Z\nP1;1,5;2;0\nP2;2,5;2;0\n"

#: Of each: the table, what the command is asked, and the same of Python.
TABLES = {
    "positioning": (POSITIONING, [], {}),
    "points": (IMPORT / "points-inch.txt", ["--as", "points"], {"kind": "points"}),
    "points without hints": (IMPORT / "points-inch.txt", [], {}),
    "tracker": (STATION, ["--machine", MILL], {"machine": MILL}),
    "tracker with hints": (STATION, ["--machine", MILL, "--azimuth", "clockwise", "--vertical", "zenith", "--separator",
                                     "semicolon", "--decimal", "comma", "--angle-unit", "gon", "--length-unit", "mm",
                                     "--encoding", "windows-1252"],
                           {"machine": machine("three-axis-mill"), "azimuth": "clockwise", "vertical": "zenith",
                            "separator": "semicolon", "decimal": "comma", "angle_unit": "gon", "length_unit": "mm",
                            "encoding": "windows-1252"}),
    "laser": (IMPORT / "laser.rtl", ["--length-unit", "mm"], {"length_unit": "mm"}),
    "probe log": (IMPORT / "probe-log.txt", ["--format", "linuxcnc-probe", "--length-unit", "mm"],
                  {"format": "linuxcnc-probe", "length_unit": "mm"}),
    "qif": (IMPORT / "results.qif", [], {}),
    "mtconnect": (IMPORT / "streams.xml", [], {}),
    "temperatures": (IMPORT / "streams.xml", ["--format", "mtconnect-temperatures"],
                     {"format": "mtconnect-temperatures"}),
    "ecmc": (IMPORT / "positioning-ecmc.dat", ["--accept-uncertain"], {"accept_uncertain": True}),
    "nominal and measured": (IMPORT / "nominal-measured.csv", ["--machine", MILL], {"machine": MILL}),
    "heidenhain": (IMPORT / "points.tab", [], {}),
    "dmis": (IMPORT / "results.dmo", ["--as", "points"], {"kind": "points"}),
    "tracker by a mapping": (STATION, ["--machine", MILL, "--mapping", IMPORT / "total-station.import.toml"],
                             {"machine": MILL, "mapping": IMPORT / "total-station.import.toml"}),
}


@pytest.mark.parametrize("name", TABLES)
def test_tables_are_those_of_the_command(name, tmp_path):
    path, options, arguments = TABLES[name]
    asked = ["import", path, *options]
    for table in (path, path.read_bytes(), gzip.compress(path.read_bytes())):
        result = abbe.import_table(table, **arguments, file=str(path))
        assert result.certain and result.gzip == (table is not path and table[:2] == b"\x1f\x8b")
        if not result.gzip:
            assert result.text() == command(asked, tmp_path)
            assert result.json_text() == command([*asked, "--json"], tmp_path)
        result.write(tmp_path / "own.csv", overwrite=True)
        result.write_mapping(tmp_path / "own.import.toml", overwrite=True)
    assert result.to_dict() == json.loads(result.json_text())
    command([*asked, "-o", "wanted.csv", "--write-mapping", "wanted.import.toml"], tmp_path)
    for ending in ("csv", "import.toml"):
        assert (tmp_path / f"own.{ending}").read_bytes() == (tmp_path / f"wanted.{ending}").read_bytes()
    assert result.csv().encode() == (tmp_path / "wanted.csv").read_bytes()
    for write in (result.write, result.write_mapping):
        with pytest.raises(FileExistsError, match="overwrite=True"):
            write(tmp_path / "own.csv")
    assert path.name in repr(abbe.import_table(path, **arguments).file)


def test_columns_say_where_they_come_from():
    result = abbe.import_table(STATION, machine=MILL)
    assert (result.kind, result.encoding, result.rows, len(result)) == ("tracker", "windows-1252", 12, 12)
    assert result.doubts == [] and result.not_read == []
    columns = {column.name: column for column in result.columns}
    azimuth = columns["azimuth_deg"]
    assert (azimuth.source, azimuth.source_name, azimuth.unit, azimuth.convention) == (4, "Hz", "gon", "clockwise")
    assert "by its name" in azimuth.reason and azimuth.doubts == [] and not azimuth.is_text
    assert columns["point"].is_text and columns["point"].unit == "" and columns["range_m"].unit == "m"
    assert columns["elevation_deg"].convention == "zenith" and columns["X_mm"].convention == "as-written"
    assert "0xE4" in result.encoding_reason and any("semicolon" in reason for reason in result.layout_reasons)
    assert "tracker" in repr(result) and "azimuth_deg" in repr(azimuth) and result.kind_reason
    told = result.to_dict()["columns"]
    assert [column["column"] for column in told] == [column.source + 1 for column in result.columns]
    assert [column["from"] for column in told] == [column.source_name for column in result.columns]


@pytest.mark.parametrize("name", ["positioning", "points", "tracker"])
def test_values_are_those_of_the_csv(name):
    path, _, arguments = TABLES[name]
    result = abbe.import_table(path, **arguments)
    values, rows = result.values(), list(csv.DictReader(result.csv().splitlines()))
    assert list(values) == list(rows[0]) == [column.name for column in result.columns]
    for column in result.columns:
        texts = [row[column.name] for row in rows]
        assert list(values[column.name]) == (texts if column.is_text else [float(text) for text in texts])
    frame = result.to_dataframe()
    assert list(frame.columns) == list(values) and len(frame) == len(result)


def test_values_are_evaluated_as_the_file_is(tmp_path):
    result = abbe.import_table(POSITIONING)
    result.write(tmp_path / "positioning.csv")
    from_file = abbe.evaluate_positioning(tmp_path / "positioning.csv", file="x")
    for values in (result.values(), result.to_dataframe()):
        assert abbe.evaluate_positioning(values, file="x").json_text() == from_file.json_text()


def test_files_of_instruments_say_what_they_are():
    laser = abbe.import_table(IMPORT / "laser.rtl", length_unit="mm")
    assert (laser.format, laser.kind, laser.certain) == ("renishaw-laser", "positioning", True)
    assert "HEADER::" in laser.format_reason and ("Axis", "X") in laser.facts
    assert any("Flags" in part for part in laser.not_read)
    table = abbe.import_table(POSITIONING)
    assert (table.format, table.format_reason, table.facts) == ("table", "", [])
    # The same readings.
    figures = [abbe.evaluate_positioning(one.values(), file="x").to_dict()["figures"] for one in (laser, table)]
    assert figures[0] == figures[1]
    assert not abbe.import_table(IMPORT / "laser.rtl").certain
    with pytest.raises(abbe.InputError, match="format"):
        abbe.import_table(IMPORT / "laser.rtl", format="laser")


def test_inches_become_millimetres():
    values = abbe.import_table(IMPORT / "points-inch.txt").values()
    assert values["x_mm"][0] == pytest.approx(25.4 * 1.84039, rel=1e-15) and values["point"][0] == "bore 1"


def test_what_is_uncertain_is_not_written(tmp_path):
    (tmp_path / "table.csv").write_bytes(NO_UNITS)
    asked = ["import", "table.csv", "-o", "wanted.csv", "--write-mapping", "wanted.import.toml"]
    command(asked, tmp_path, exit_code=1)
    result = abbe.import_table(NO_UNITS, file="table.csv")
    assert not result.certain and "uncertain" in repr(result) and not (tmp_path / "wanted.csv").exists()
    assert len(result.doubts) == 3 and "length_unit" in result.doubts[0] and "--" not in "".join(result.doubts)
    assert result.columns[1].doubts and result.columns[1].name == "x_mm" and "UNCERTAIN" in result.text()
    for refused in (lambda: result.write(tmp_path / "own.csv"), result.values, result.to_dataframe,
                    lambda: abbe.import_table(NO_UNITS, mapping=result)):
        with pytest.raises(abbe.InputError, match="uncertain: x_mm") as error:
            refused()
        assert "accept_uncertain" in error.value.expected and error.value.file == "table.csv"
    assert not (tmp_path / "own.csv").exists() and result.csv().startswith("point,x_mm")
    result.write_mapping(tmp_path / "own.import.toml")
    assert (tmp_path / "own.import.toml").read_bytes() == (tmp_path / "wanted.import.toml").read_bytes()
    accepted = abbe.import_table(NO_UNITS, accept_uncertain=True, file="table.csv")
    accepted.write(tmp_path / "own.csv")
    command([*asked[:4], "--accept-uncertain"], tmp_path)
    assert (tmp_path / "own.csv").read_bytes() == (tmp_path / "wanted.csv").read_bytes()
    assert accepted.certain and accepted.doubts == result.doubts
    inches = abbe.import_table(NO_UNITS, length_unit="inch")
    assert inches.certain and inches.doubts == [] and inches.values()["x_mm"].tolist() == [38.1, 63.5]


@bad_input
def test_a_mapping_reads_the_next_table():
    first = abbe.import_table(NO_UNITS, length_unit="inch")
    other = b"Name;X;Y;Z\nQ;1;0;0\n"
    for mapping in (first, first.mapping_text().encode()):
        again = abbe.import_table(other, mapping=mapping)
        assert again.certain and again.values()["x_mm"].tolist() == [25.4] and again.values()["point"] == ["Q"]


@bad_input
@pytest.mark.parametrize("name, call", [
    ("nowhere", lambda: abbe.import_table("nowhere.csv")), ("empty", lambda: abbe.import_table(b"")),
    ("empty", lambda: abbe.import_table(b"\n \n")), ("zero byte", lambda: abbe.import_table(b"a,b\n1,2\0\n")),
    ("gzip", lambda: abbe.import_table(b"\x1f\x8b\x08\0")), ("utf-16le", lambda: abbe.import_table(b"a", encoding="x")),
    ("UTF-8", lambda: abbe.import_table(POSITIONING, encoding="utf-8")),
    ("points, tracker", lambda: abbe.import_table(NO_UNITS, kind="cloud")),
    ("semicolon", lambda: abbe.import_table(NO_UNITS, separator=";")),
    ("point", lambda: abbe.import_table(NO_UNITS, decimal=",")),
    ("inch", lambda: abbe.import_table(NO_UNITS, length_unit="yard")),
    ("gon", lambda: abbe.import_table(NO_UNITS, angle_unit="mm")),
    ("anticlockwise", lambda: abbe.import_table(NO_UNITS, azimuth="left")),
    ("horizontal", lambda: abbe.import_table(NO_UNITS, vertical="up")),
    ("mirrored", lambda: abbe.import_table(NO_UNITS, mirrored="w")),
    ("azimuth", lambda: abbe.import_table(NO_UNITS, azimuth="clockwise")),
    ("machine", lambda: abbe.import_table(NO_UNITS, kind="tracker")),
    ("machine", lambda: abbe.import_table(STATION, mapping=IMPORT / "total-station.import.toml")),
    ("kind", lambda: abbe.import_table(STATION, kind="points", mapping=IMPORT / "total-station.import.toml")),
    ("decimal", lambda: abbe.import_table(STATION, decimal="comma", mapping=IMPORT / "total-station.import.toml")),
    ("accept_uncertain", lambda: abbe.import_table(STATION, accept_uncertain=True,
                                                   mapping=IMPORT / "total-station.import.toml")),
    ("mapping", lambda: abbe.import_table(NO_UNITS, mapping=b"kind = 3")),
    ("nowhere", lambda: abbe.import_table(NO_UNITS, mapping="nowhere.toml")),
    ("nowhere", lambda: abbe.import_table(NO_UNITS, machine="nowhere.toml")),
    ("decimal", lambda: abbe.import_table(b"x [mm];y [mm];z [mm]\n1,234;2,345;3,456\n")),
    ("kind points", lambda: abbe.import_table(b"a [mm];b [mm]\n1.5;2.5\n")),
])
def test_bad_arguments_are_named(name, call, names_argument):
    names_argument(name, call)


@bad_input
def test_other_objects_are_no_tables():
    for table in (None, 3, [b"1"], NO_UNITS[0]):
        with pytest.raises(TypeError):
            abbe.import_table(table)


@bad_input
def test_the_place_of_a_bad_row_is_named(tmp_path):
    path = tmp_path / "table.csv"
    path.write_bytes(b"x [mm];y [mm];z [mm]\n1,5;2;0\n1,5;two;0\n")
    with pytest.raises(abbe.InputError) as error:
        abbe.import_table(path)
    assert (error.value.file, error.value.line) == (str(path), 3) and "two" in error.value.problem
    assert "y [mm]" in error.value.field and error.value.expected
    outside = STATION.read_bytes().replace(b"380,0;40,0", b"980,0;40,0", 1)
    with pytest.raises(abbe.InputError, match="travel") as error:
        abbe.import_table(outside, machine=MILL)
    assert error.value.line == 7 and "X" in error.value.field


@bad_input
def test_small_tables_and_other_encodings():
    one = abbe.import_table(b"x [mm],y [mm],z [mm]\n1.5,2.5,3\n")
    assert len(one) == 1 and one.values()["z_mm"].tolist() == [3]
    with pytest.raises(abbe.InputError):
        abbe.import_table(b"x [mm],y [mm],z [mm]\n")
    text = 'Name\tX [mm]\tY [mm]\tZ [mm]\n"Spitze, ""ä"" # 1"\t1.25\t-2\t1e-3\n\t1\t2\t3\n'
    for encoding in ("utf-8", "utf-8-sig", "utf-16", "cp1252"):
        values = abbe.import_table(text.encode(encoding)).values()
        assert values["point"] == ['Spitze, "ä" # 1', ""] and values["y_mm"].tolist() == [-2, 2]


def test_a_large_table_keeps_every_digit():
    points = numpy.random.default_rng(1).uniform(-1000, 1000, (200_000, 3))
    lines = "\n".join(",".join(map(repr, row)) for row in points.tolist())
    values = abbe.import_table(f"x [mm],y [mm],z [mm]\n{lines}\n".encode()).values()
    assert numpy.array_equal(numpy.stack([values["x_mm"], values["y_mm"], values["z_mm"]], axis=1), points)
