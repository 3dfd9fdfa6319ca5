"""Readings from Parquet and Arrow IPC files, against the CSV file with the same numbers."""

import os
import re
import subprocess
import sys
import time

import pytest
from use_examples import COMMAND, EXAMPLES

import abbe

pa = pytest.importorskip("pyarrow")
csv = pytest.importorskip("pyarrow.csv")
parquet = pytest.importorskip("pyarrow.parquet")

pytestmark = pytest.mark.skipif("ABBE_COMMAND" not in os.environ, reason="needs the command")


def write_arrow(table, path, rows=None, **options):
    with pa.ipc.new_file(path, table.schema, options=pa.ipc.IpcWriteOptions(**options)) as file:
        file.write_table(table, max_chunksize=rows)


def write_parquet(table, path, rows=None, **options):
    parquet.write_table(table, path, row_group_size=rows, **options)


FORMS = {
    "parquet": lambda table, path: write_parquet(table, path, 3000),
    "gzip.parquet": lambda table, path: write_parquet(table, path, 5000, compression="gzip", use_dictionary=False),
    "zstd.parquet": lambda table, path: write_parquet(table, path, compression="zstd", write_page_checksum=True,
                                                      data_page_size=20000),
    "arrow": write_arrow,
    "zstd.arrow": lambda table, path: write_arrow(table, path, 2500, compression="zstd"),
    "lz4.feather": lambda table, path: write_arrow(table, path, 4096, compression="lz4"),
}


class BallBar:
    """The ball bar of examples/trunnion with its readings in files: 16 times those of the example."""

    def __init__(self, folder):
        self.folder = folder
        study = abbe.Study.read(EXAMPLES / "trunnion/ball-bar.study.toml")
        result = study.run(map=False, advice=False)
        result.write(folder / "simulated")
        (simulated,) = (folder / "simulated/readings").glob("*.csv")
        header, *rows = simulated.read_text().splitlines()
        self.csv = "\n".join([header, *rows * 16]) + "\n"
        (folder / "bar.csv").write_text(self.csv)
        self.table = csv.read_csv(folder / "bar.csv")
        self.text = (EXAMPLES / "trunnion/ball-bar.study.toml").read_text()

    def study(self, *files, in_memory=0, more=""):
        """A study file with these files of readings; in_memory 0: all readings."""
        text = re.sub(r"(?s)\[simulate\].*?(?=\[\[setup\]\])", "", self.text)
        text = re.sub(r"(?s)\[\[setup\.plan\]\].*?(?=\[\[setup\.plan\]\]|\[identify\])", "", text)
        text = re.sub("held_out_fraction = .*", f"held_out_fraction = 0\nreadings_in_memory = {in_memory}", text)
        text = re.sub("machine = .*", f'machine = "{EXAMPLES / "machines/trunnion-mill.machine.toml"}"', text, count=1)
        data = "".join(f'[[setup.data]]\nfile = "{file}"\n{more}\n' for file in files)
        path = self.folder / "bar.study.toml"
        path.write_text(text.replace("[identify]", data + "[identify]", 1))
        return path

    def run(self, *files, exit_code=0, environment=None, **options):
        """Results of the command but what names the files; or what it says where it refuses them."""
        results = self.folder / "results"
        ran = subprocess.run([COMMAND, "run", self.study(*files, **options), "-o", results, "--force", "--quiet"],
                             cwd=self.folder, capture_output=True, text=True, timeout=200,
                             env={**os.environ, "ABBE_COLUMNS_PYTHON": sys.executable, **(environment or {})})
        assert ran.returncode == exit_code, ran.stderr
        if exit_code == 2:
            return ran.stderr
        names = sorted(path.relative_to(results) for path in results.rglob("*") if path.is_file())
        return {name: self.plain(results / name) for name in names if name.name not in ("report.html", "study.toml")}

    @staticmethod
    def plain(path):
        return re.sub(rb"\b(\w+)\.(\w+\.)?(csv|parquet|arrow|feather)\b", rb"\1", path.read_bytes())

    def write(self, table, form="parquet", name="bar"):
        path = self.folder / f"{name}.{form}"
        FORMS[form](table, path)
        return path.name


@pytest.fixture(scope="module")
def module_bar(tmp_path_factory):
    return BallBar(tmp_path_factory.mktemp("columns"))


@pytest.fixture
def bar(module_bar):
    for path in module_bar.folder.glob("*"):
        if path.is_file() and path.name != "bar.csv":
            path.unlink()
    return module_bar


@pytest.mark.parametrize("in_memory", [0, 1000])
def test_results_have_the_bytes_of_those_from_csv(bar, in_memory):
    from_csv = bar.run("bar.csv", in_memory=in_memory)
    assert len(from_csv) > 5
    for form in FORMS if in_memory else ("parquet", "arrow"):
        assert bar.run(bar.write(bar.table, form), in_memory=in_memory) == from_csv, form


def test_several_files_types_and_dictionaries(bar):
    header = bar.csv.splitlines()[0].split(",")
    assert "item" in header and "length_mm" in header
    table = bar.table
    single = table.column("X_mm").cast(pa.float32())
    # The CSV file states the value of the float32, as a double.
    table = table.set_column(header.index("X_mm"), "X_mm", single.cast(pa.float64()))
    table = table.append_column("X_approach", pa.array([k % 3 - 1 for k in range(table.num_rows)]))
    csv.write_csv(table, bar.folder / "a.csv", csv.WriteOptions(quoting_style="needed"))
    csv.write_csv(table.slice(0, 7001), bar.folder / "b.csv", csv.WriteOptions(quoting_style="needed"))
    from_csv = bar.run("a.csv", "b.csv", in_memory=1000)
    columns = {name: table.column(name) for name in header}
    columns["X_mm"] = single
    columns["item"] = columns["item"].dictionary_encode()
    columns["X_approach"] = table.column("X_approach").cast(pa.int8())
    columns["remark"] = pa.array([[1, 2]] * table.num_rows)
    table = pa.table(columns)
    first = bar.write(table, "parquet", "a")
    second = bar.write(table.slice(0, 7001), "zstd.arrow", "b")
    ours = bar.run(first, second, in_memory=1000, more='ignore = ["remark"]\n')
    assert ours == from_csv
    assert "remark: unknown column" in bar.run(first, in_memory=1000, exit_code=2)


def refused(bar, table, *words, in_memory=(0, 1000), form="parquet"):
    for memory in in_memory:
        said = bar.run(bar.write(table, form), in_memory=memory, exit_code=2)
        for word in words:
            assert word in said, said


def test_bad_cells_and_columns_are_named(bar):
    table = bar.table
    where = table.column_names.index("length_mm")
    lengths = table.column("length_mm").to_pylist()
    for bad, words in ((None, "is empty"), (float("nan"), "'nan' is not a finite number")):
        values = list(lengths)
        values[9000] = values[9500] = bad
        refused(bar, table.set_column(where, "length_mm", pa.array(values, pa.float64())),
                f"bar.parquet: row 9001: length_mm: {words}; expected a length in mm")
    refused(bar, table.drop(["length_mm"]), "bar.parquet: length: missing column; expected length_mm, length_um or length_m")
    refused(bar, table.set_column(where, "length_mm", pa.array(map(str, lengths))),
            "bar.parquet: length_mm: the column holds values of type text; expected a length in mm as float64")
    refused(bar, table.set_column(where, "length_mm", pa.array([str(v) for v in lengths]).cast(pa.decimal128(38, 20))),
            "the column holds values of type decimal128(38, 20)")
    refused(bar, table.rename_columns(["x" if n == "X_mm" else n for n in table.column_names]), "bar.parquet: x: unknown")
    items = table.column("item").to_pylist()
    items[5000] = "nobody"
    refused(bar, table.set_column(table.column_names.index("item"), "item", pa.array(items)), "row 5001: item", "nobody")
    whole = pa.array([2**53 + 1] * table.num_rows, pa.int64())
    refused(bar, table.set_column(where, "length_mm", whole), "cannot be read: column length_mm, rows 1 to ")
    refused(bar, table.slice(0, 0), "bar.parquet: has no rows")


@pytest.mark.parametrize("form", FORMS)
def test_files_that_are_cut_off_or_damaged_are_refused(bar, form):
    name = bar.write(bar.table, form)
    whole = (bar.folder / name).read_bytes()
    for size in (3, 100, len(whole) // 2, len(whole) - 1):
        (bar.folder / name).write_bytes(whole[:size])
        for in_memory in (0, 1000):
            said = bar.run(name, in_memory=in_memory, exit_code=2)
            assert re.search(rf"{name}.*(cannot be read|ended while it read)", said), said


def test_a_damaged_page_names_its_column(bar):
    name = bar.write(bar.table, "zstd.parquet")
    at = parquet.read_metadata(bar.folder / name).row_group(0)
    column = next(at.column(i) for i in range(at.num_columns) if at.column(i).path_in_schema == "length_mm")
    data = bytearray((bar.folder / name).read_bytes())
    begin = column.dictionary_page_offset or column.data_page_offset
    data[begin + column.total_compressed_size // 2] ^= 0xFF
    (bar.folder / name).write_bytes(data)
    for in_memory in (0, 1000):
        assert f"{name}: cannot be read: column length_mm, rows " in bar.run(name, in_memory=in_memory, exit_code=2)


def test_readings_do_not_count_twice(bar):
    name = bar.write(bar.table)
    other = bar.write(bar.table, name="copy")
    assert f"{other}: has the same content as" in bar.run(name, other, in_memory=1000, exit_code=2)
    assert "is given twice" in bar.run(name, "./" + name, in_memory=1000, exit_code=2)


def test_large_compressed_batches_are_refused(bar):
    table = pa.table({name: pa.concat_arrays([column.combine_chunks().cast(
        pa.string() if name == "item" else pa.float64())] * 60) for name, column in zip(bar.table.column_names, bar.table)})
    write_arrow(table, bar.folder / "bar.arrow", compression="zstd")
    said = bar.run("bar.arrow", in_memory=1000, exit_code=2)
    assert "bar.arrow: cannot be read: record batch 0 is compressed and takes" in said and "max_chunksize" in said


def test_without_pyarrow_the_command_says_how_to_get_it(bar):
    name = bar.write(bar.table)
    (bar.folder / "no").mkdir(exist_ok=True)
    (bar.folder / "no/pyarrow.py").write_text("raise ImportError('none here')")
    for in_memory in (0, 1000):
        said = bar.run(name, in_memory=in_memory, exit_code=2, environment={"PYTHONPATH": str(bar.folder / "no")})
        assert "cannot be read here" in said and "none here" in said and "pip install pyarrow" in said
    # A module in the folder of the user is none of Abbe's business.
    (bar.folder / "pyarrow.py").write_text("raise ImportError('the folder')")
    bar.run(name, in_memory=1000)


def in_python(bar, name, change):
    """Runs a study in this process and changes its file during the identification; what the study says."""
    study = abbe.Study.read(bar.study(name, in_memory=1000))
    changed = []

    def progress(step, done, total):
        if step == "identifying" and not changed:
            changed.append(True)
            change(bar.folder / name)

    with pytest.raises(abbe.InputError) as error:
        study.run(map=False, advice=False, progress=progress)
    assert changed
    return str(error.value)


@pytest.mark.parametrize("form", ["arrow", "zstd.arrow"])
def test_files_that_change_during_the_run_are_refused(bar, form):
    table = pa.concat_tables([bar.table] * 8).combine_chunks()  # more than the reader keeps
    lengths = pa.array([value + 0.5 for value in table.column("length_mm").to_pylist()])
    other = table.set_column(table.column_names.index("length_mm"), "length_mm", lengths)
    name, changed = bar.write(table, form), bar.write(other, form, "other")

    def overwrite(path):
        with path.open("r+b") as file:
            file.write((bar.folder / changed).read_bytes())

    said = in_python(bar, name, overwrite)
    assert name in said and ("has changed since" in said or "cannot be read" in said), said
    name = bar.write(table, form)
    said = in_python(bar, name, lambda path: os.truncate(path, path.stat().st_size // 2))
    assert name in said and ("cannot be read" in said or "ended while it read" in said), said


def test_a_run_that_was_killed_goes_on(bar):
    table = pa.concat_tables([bar.table] * 20).combine_chunks()
    name = bar.write(table)
    whole = bar.run(name, in_memory=1000)
    results = bar.folder / "killed"
    command = [COMMAND, "run", bar.study(name, in_memory=1000), "-o", results, "--quiet"]
    environment = {**os.environ, "ABBE_COLUMNS_PYTHON": sys.executable}
    unfinished, deadline = bar.folder / "killed.unfinished", time.monotonic() + 120
    with subprocess.Popen(command, cwd=bar.folder, env=environment, stderr=subprocess.PIPE) as run:
        while run.poll() is None and time.monotonic() < deadline and not (
                unfinished.exists() and unfinished.stat().st_size > 20000):
            time.sleep(0.01)
        run.kill()
    assert unfinished.exists()
    again = subprocess.run([*command[:-1]], cwd=bar.folder, env=environment, capture_output=True, text=True)
    assert again.returncode == 0 and "are taken from" in again.stderr, again.stderr
    for name, content in whole.items():
        assert bar.plain(results / name) == content
    assert not unfinished.exists()
