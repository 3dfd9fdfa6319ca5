"""Rows of Parquet and Arrow IPC files by pyarrow, for `abbe`, which runs this text with Python (column_reader.cpp).

    python3 -c TEXT FILE ...

Requests are lines on standard input: `open FILE` asks for the columns and the number of rows, `rows FILE FIRST LAST
COLUMN,...` for rows FIRST .. LAST - 1 of some columns, named in their order; FILE is the number of an argument, all
numbers begin with 0. An answer on standard output is a line with a word and a number of bytes, and so many bytes: `ok`,
a block (column_block.h); `refused`, what is wrong with the file; `missing`, why there is no pyarrow.
"""

import sys

# No module from the folder in which the user happens to be.
sys.path[:] = [folder for folder in sys.path if folder]

import bisect  # noqa: E402
import collections  # noqa: E402
import os  # noqa: E402
import signal  # noqa: E402
import struct  # noqa: E402

MAGIC = b"\0columns"
ROWS_TOGETHER = 16384
# Threads ask for neighbouring rows a little out of order, so what was read just before stays.
KEPT_BATCHES = 4
# Each thread goes through a range of rows of its own.
CURSORS = min(16, 2 + (os.cpu_count() or 1))
# A compressed record batch can be read only as a whole.
MOST_BYTES_OF_BATCH = 32 << 20
# Pages of a mapped file count as memory of this process until it is mapped anew.
MOST_MAPPED_BYTES = 16 << 20
INTEGER, FLOAT, TEXT = "integer", "float", "text"


class Refused(Exception):
    """What is wrong with a file."""


def number_bytes(value):
    return struct.pack("=q", value)


def text_bytes(text):
    data = text.encode("utf-8", "surrogateescape")
    return number_bytes(len(data)) + data


def kind_of(arrow, kind):
    types = arrow.types
    if types.is_dictionary(kind):
        kind = kind.value_type
    if types.is_integer(kind):
        return INTEGER
    if types.is_floating(kind):
        return FLOAT
    if types.is_string(kind) or types.is_large_string(kind) or types.is_string_view(kind):
        return TEXT
    return str(kind).splitlines()[0][:60]


class ParquetTable:
    most_rows_of_cursor = None

    def __init__(self, arrow, path):
        import pyarrow.parquet

        # Page by page: a column of a group of rows may have hundreds of megabytes.
        self.file = pyarrow.parquet.ParquetFile(path, buffer_size=1 << 16, page_checksum_verification=True)
        metadata = self.file.metadata
        self.schema = self.file.schema_arrow
        self.rows = metadata.num_rows
        self.starts = [0]
        for group in range(metadata.num_row_groups):
            self.starts.append(self.starts[-1] + metadata.row_group(group).num_rows)

    def batches(self, group, columns):
        names = [self.schema.names[c] for c in columns]
        # One by one: pyarrow has buffers for all groups that it is given.
        for each in range(group, len(self.starts) - 1):
            yield from self.file.iter_batches(ROWS_TOGETHER, [each], names, use_threads=False)


class IpcTable:
    def __init__(self, arrow, path):
        self.arrow, self.path = arrow, path
        reader = self.reader()
        self.schema = reader.schema
        self.starts = [0]
        for number in range(reader.num_record_batches):
            before = arrow.total_allocated_bytes()
            batch = reader.get_batch(number)
            size = arrow.total_allocated_bytes() - before  # nothing where it is not compressed
            if size > MOST_BYTES_OF_BATCH:
                raise Refused(f"record batch {number} is compressed and takes {size >> 20} MiB, more than "
                              f"{MOST_BYTES_OF_BATCH >> 20}: write smaller batches (max_chunksize), or do not compress")
            self.starts.append(self.starts[-1] + batch.num_rows)
        self.rows = self.starts[-1]
        self.most_rows_of_cursor = MOST_MAPPED_BYTES * self.rows // os.path.getsize(path)

    def reader(self):
        # All columns: with some of them only, pyarrow copies the whole batch.
        return self.arrow.ipc.open_file(self.arrow.memory_map(self.path))

    def batches(self, number, columns):
        reader = self.reader()
        for each in range(number, reader.num_record_batches):
            batch = reader.get_batch(each)
            for begin in range(0, batch.num_rows, ROWS_TOGETHER):
                yield batch.slice(begin, ROWS_TOGETHER)


def open_table(arrow, path):
    with open(path, "rb") as file:
        begin = file.read(6)
    if begin.startswith(b"PAR1"):
        table = ParquetTable(arrow, path)
    elif begin == b"ARROW1":
        table = IpcTable(arrow, path)
    else:
        raise Refused("begins neither like a Parquet file nor like an Arrow IPC file: it may be damaged, or an Arrow "
                      "stream, which has to be written as a file")
    names = table.schema.names
    twice = [name for i, name in enumerate(names) if name in names[:i]]
    if twice:
        raise Refused(f"column {twice[0]} is there twice")
    table.kinds = [kind_of(arrow, field.type) for field in table.schema]
    table.heads = [text_bytes(name) + text_bytes(kind) for name, kind in zip(names, table.kinds)]
    return table


class Cursor:
    """Goes through some columns of a table, from the group of rows (or record batch) that holds a row."""

    def __init__(self, table, file, first, columns):
        self.table, self.file, self.columns = table, file, columns
        group = bisect.bisect_right(table.starts, first) - 1
        self.start = self.begin = self.end = table.starts[group]
        self.batches = table.batches(group, columns)
        self.kept = collections.deque()

    def can_serve(self, file, first, columns):
        if self.file != file or self.columns != columns or first < self.begin:
            return False
        most = self.table.most_rows_of_cursor
        if most is not None and self.end - self.start > most:
            return False
        starts = self.table.starts
        return first <= self.end or starts[bisect.bisect_right(starts, first) - 1] <= self.end

    def rows(self, first, last):
        while self.end < last:
            batch = next(self.batches, None)
            if batch is None:
                raise Refused(f"has {self.end} rows, and not {self.table.rows} as it says")
            self.kept.append((self.end, batch))
            self.end += batch.num_rows
            while len(self.kept) > KEPT_BATCHES and self.kept[1][0] <= first:
                self.kept.popleft()
            self.begin = self.kept[0][0]
        wanted = []
        for start, batch in self.kept:
            begin, end = max(first, start), min(last, start + batch.num_rows)
            if begin < end:
                wanted.append(batch.slice(begin - start, end - begin))
        return wanted


def piece(buffer, begin, end, width):
    return memoryview(buffer).cast("B")[begin * width:end * width] if buffer is not None else b""


# The bytes of rows are the same whatever was read before: they have fingerprints.
def joined(arrow, arrays, kind):
    """The arrays as one of a type, by itself or as what a dictionary numbers; texts without gaps."""
    arrays = [array.dictionary_decode() if arrow.types.is_dictionary(array.type) else array for array in arrays]
    return arrow.concat_arrays([arrow.array([], kind), *(a if a.type == kind else a.cast(kind) for a in arrays)])


def number_parts(arrow, arrays):
    """The bytes of numbers: whether all are there; if not, of each whether it is; the numbers."""
    array = joined(arrow, arrays, arrow.float64())
    parts = [b"\1"]
    if array.null_count:
        present = array.is_valid().cast(arrow.uint8())
        parts = [b"\0", piece(present.buffers()[1], present.offset, present.offset + len(present), 1)]
        array = array.fill_null(0)
    return [*parts, piece(array.buffers()[1], array.offset, array.offset + len(array), 8)]


def text_parts(arrow, arrays):
    """The bytes of texts: where each begins, and the last one ends; the texts. One that is not there is empty."""
    array = joined(arrow, arrays, arrow.large_string())
    array = joined(arrow, [array.fill_null("")], arrow.large_string()) if array.null_count else array
    ends = piece(array.buffers()[1], array.offset, array.offset + len(array) + 1, 8)
    places = ends.cast("q")
    return [ends, piece(array.buffers()[2], places[0], places[-1], 1)]


class Tables:
    """All files of a command, opened when they are asked for."""

    def __init__(self, arrow, paths):
        self.arrow, self.paths, self.tables, self.cursors = arrow, paths, {}, []

    def table(self, file):
        if file not in self.tables:
            self.tables[file] = open_table(self.arrow, self.paths[file])
        return self.tables[file]

    def head(self, table, rows, columns):
        parts = [MAGIC, number_bytes(rows), number_bytes(len(table.heads))]
        for i, head in enumerate(table.heads):
            parts += [head, b"\1" if i in columns else b"\0"]
        return b"".join(parts)

    def columns(self, file):
        table = self.table(file)
        return [self.head(table, table.rows, ())]

    def cursor(self, file, first, columns):
        fit = [one for one in self.cursors if one.can_serve(file, first, columns)]
        # One that has the rows already, else the one with the least to pass over.
        cursor = max(fit, key=lambda one: (first < one.end, one.end), default=None)
        if cursor is None:
            cursor = Cursor(self.table(file), file, first, columns)
        else:
            self.cursors.remove(cursor)
        self.cursors = [*self.cursors[1 - CURSORS:], cursor]
        return cursor

    def rows(self, file, first, last, columns):
        table = self.table(file)
        batches = self.cursor(file, first, columns).rows(first, last) if columns else []
        parts = [self.head(table, last - first, columns)]
        for c in columns:
            name, make = table.schema.names[c], text_parts if table.kinds[c] == TEXT else number_parts
            try:
                parts += make(self.arrow, [batch.column(batch.schema.get_field_index(name)) for batch in batches])
            except self.arrow.ArrowException as error:
                raise Refused(f"column {name}, rows {first + 1} to {last}: {words_of(error)}") from error
        return parts

    def bad_column(self, file, first, last, columns):
        """The column that cannot be read alone, for the message."""
        self.cursors.clear()
        for c in columns:
            try:
                Cursor(self.table(file), file, first, (c,)).rows(first, last)
            except Exception:
                return f"column {self.table(file).schema.names[c]}, "
        return ""

    def answer(self, line):
        words = line.split()
        file = int(words[1])
        if words[0] == "open":
            return self.columns(file)
        first, last = int(words[2]), int(words[3])
        columns = tuple(int(word) for word in words[4].split(",")) if len(words) > 4 else ()
        try:
            return self.rows(file, first, last, columns)
        except (Refused, MemoryError):
            raise
        except Exception as error:
            where = self.bad_column(file, first, last, columns)
            raise Refused(f"{where}rows {first + 1} to {last}: {words_of(error)}") from error


def words_of(error):
    if isinstance(error, MemoryError):
        return "needs more memory than there is"
    return " ".join(str(error).split()) or type(error).__name__


def main():
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # it ends with the command, which the user interrupts
    output = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    os.environ.setdefault("ARROW_DEFAULT_MEMORY_POOL", "system")  # gives back what it does not need
    tables, missing = None, ""
    try:
        import pyarrow

        pyarrow.set_cpu_count(1)
        tables = Tables(pyarrow, sys.argv[1:])
    except Exception as error:
        missing = f"{sys.executable} says: {words_of(error)}"
    for line in sys.stdin:
        word = "ok"
        try:
            if tables is None:
                word, parts = "missing", [missing.encode("utf-8", "replace")]
            else:
                parts = tables.answer(line)
        except Exception as error:
            word, parts = "refused", [words_of(error).encode("utf-8", "replace")]
        output.write(f"{word} {sum(len(part) for part in parts)}\n".encode())
        for part in parts:
            output.write(part)
        output.flush()
    os._exit(0)


main()
