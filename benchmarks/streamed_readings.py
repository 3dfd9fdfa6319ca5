#!/usr/bin/env python3
"""Time and memory of an identification from readings that do not fit into memory.

    benchmarks/streamed_readings.py build/release/bin/abbe --readings 10000000 --folder readings --format parquet

Simulates the ball bar of examples/trunnion nearly without noise, repeats its readings with noise of 0.2 um until there
are as many as asked for, in four files, and identifies from them with `readings_in_memory`. Prints time and the largest
resident memory of the process, and of the process that reads Parquet and Arrow files (the Python that runs this has to
have pyarrow). The files (60 to 70 bytes a reading as text) are removed at the end.
"""

import argparse
import json
import os
import pathlib
import random
import re
import shutil
import subprocess
import sys
import threading
import time

NOISE_MM = 0.0002
FILES = 4


def watch_memory(process, peaks, end):
    """Largest resident memory in MiB of a process and of every process that it starts, as long as it runs."""
    while not end.wait(0.1):
        try:
            children = " ".join(file.read_text() for file in pathlib.Path(f"/proc/{process}/task").glob("*/children"))
            for each in [str(process), *children.split()]:
                peak = re.search(r"VmHWM:\s*(\d+)", pathlib.Path(f"/proc/{each}/status").read_text())
                if peak:
                    peaks[each] = int(peak[1]) / 1024
        except OSError:
            continue  # it has ended meanwhile


def run(command, **options):
    """Runs a command; returns its exit code, time and processor time in s, and largest resident memory in MiB, its own
    and its children's."""
    begin = time.monotonic()
    process, peaks, end = subprocess.Popen(command, **options), {}, threading.Event()
    watch = threading.Thread(target=watch_memory, args=(process.pid, peaks, end))
    watch.start()
    _, status, usage = os.wait4(process.pid, 0)
    seconds = time.monotonic() - begin
    end.set()
    watch.join()
    own = peaks.pop(str(process.pid), 0)
    # The system counts the largest of a process and its children.
    own = own if peaks else usage.ru_maxrss / 1024
    return os.waitstatus_to_exitcode(status), (seconds, usage.ru_utime + usage.ru_stime), own, sum(peaks.values())


def simulated_rows(abbe, example, machine, folder):
    text = example.read_text()
    text = re.sub(r"held_out_fraction = [\d.]+", "held_out_fraction = 0", text)
    text = text.replace("noise = { length_um = 0.2 }", "noise = { length_um = 1e-6 }")
    text = re.sub(r"(?m)^machine = .*$", f'machine = "{machine}"', text)
    study = folder / "exact.study.toml"
    study.write_text(text)
    subprocess.run([abbe, "run", study, "-o", folder / "exact"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    (readings,) = (folder / "exact" / "readings").glob("*.csv")
    header, *rows = readings.read_text().splitlines()
    at = header.split(",").index("length_mm")
    fields = [row.split(",") for row in rows]
    drop = header.split(",").index("time_s")
    names = [name for i, name in enumerate(header.split(",")) if i not in (at, drop)]
    before = [",".join(f for i, f in enumerate(row) if i not in (at, drop)) for row in fields]
    return ",".join([*names, "length_mm"]), before, [float(row[at]) for row in fields]


def write_shards(folder, header, before, lengths, count):
    shards, done = [], 0
    source = random.Random(5)
    noise = [source.gauss(0, NOISE_MM) for _ in range(1 << 20)]
    for k in range(FILES):
        shards.append(folder / f"bar{k}.csv")
        end = count * (k + 1) // FILES
        with shards[-1].open("w") as file:
            file.write(header + "\n")
            while done < end:
                shift = source.randrange(len(noise) - len(before))
                rows = min(len(before), end - done)
                file.write("".join(
                    f"{before[i]},{lengths[i] + noise[shift + i]:.7f}\n" for i in range(rows)))
                done += rows
    return shards


def converted(shards, form):
    """The files in another format, row by row, with the sizes of groups and batches that pyarrow chooses."""
    import pyarrow
    import pyarrow.csv
    import pyarrow.parquet

    for shard in shards:
        with pyarrow.csv.open_csv(shard) as rows:
            to, schema = shard.with_suffix("." + form), rows.schema
            writer = pyarrow.parquet.ParquetWriter(to, schema) if form == "parquet" else pyarrow.ipc.new_file(to, schema)
            with writer:
                for batch in rows:
                    writer.write_batch(batch)
        shard.unlink()
    return [shard.with_suffix("." + form) for shard in shards]


def measured_study(example, machine, shards, in_memory, folder):
    text = example.read_text()
    text = re.sub(r"(?s)\[simulate\].*?(?=\[\[setup\]\])", "", text)
    text = re.sub(r"(?s)\[\[setup\.plan\]\].*?(?=\[\[setup\.plan\]\]|\[identify\])", "", text)
    text = re.sub(r"held_out_fraction = [\d.]+", f"held_out_fraction = 0\nreadings_in_memory = {in_memory}", text)
    text = re.sub(r"(?m)^machine = .*$", f'machine = "{machine}"', text)
    data = "".join(f'[[setup.data]]\nfile = "{shard}"\n\n' for shard in shards)
    study = folder / "bar.study.toml"
    study.write_text(text.replace("[identify]", data + "[identify]", 1))
    return study


def inputs_of(root):
    return root / "examples/trunnion/ball-bar.study.toml", root / "examples/machines/trunnion-mill.machine.toml"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("abbe", type=pathlib.Path)
    parser.add_argument("--readings", type=int, default=1_000_000)
    parser.add_argument("--in-memory", type=int, default=50_000, help="0: all readings in memory, to compare with")
    parser.add_argument("--folder", type=pathlib.Path, required=True)
    parser.add_argument("--format", choices=["csv", "parquet", "arrow"], default="csv")
    options = parser.parse_args()
    root = pathlib.Path(__file__).resolve().parent.parent
    example, machine = inputs_of(root)
    options.folder.mkdir(parents=True)
    try:
        header, before, lengths = simulated_rows(options.abbe, example, machine, options.folder)
        shards = write_shards(options.folder, header, before, lengths, options.readings)
        if options.format != "csv":
            shards = converted(shards, options.format)
        size = sum(shard.stat().st_size for shard in shards)
        study = measured_study(example, machine, shards, options.in_memory, options.folder)
        with (options.folder / "out.txt").open("w") as out:
            command = [options.abbe, "run", study, "-o", options.folder / "results"]
            environment = {**os.environ, "ABBE_COLUMNS_PYTHON": sys.executable}
            code, (seconds, processor), memory, of_reader = run(command, stdout=out, stderr=out, env=environment)
        if code not in (0, 1):
            raise SystemExit((options.folder / "out.txt").read_text())
        summary = json.loads((options.folder / "results/summary.json").read_text())
        print(f"{options.readings} readings, {size / 2**20:.0f} MiB of {options.format}: {seconds:.1f} s,"
              f" {processor:.1f} s of processors, {memory:.0f} MiB resident"
              f"{f' and {of_reader:.0f} MiB of the reader' if of_reader else ''},"
              f" exit code {code}, residuals {summary['normalised_residual_rms']:.4f} times as large as stated")
    finally:
        shutil.rmtree(options.folder)


if __name__ == "__main__":
    main()
