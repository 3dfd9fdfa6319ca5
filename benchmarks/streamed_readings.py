#!/usr/bin/env python3
"""Time and memory of an identification from readings that do not fit into memory.

    benchmarks/streamed_readings.py build/release/bin/abbe --readings 10000000 --folder readings

Simulates the ball bar of examples/trunnion nearly without noise, repeats its readings with noise of 0.2 um until there
are as many as asked for, in four files, and identifies from them with `readings_in_memory`. Prints time and the largest
resident memory of the process. The files (60 to 70 bytes a reading) are removed at the end.
"""

import argparse
import json
import os
import pathlib
import random
import re
import shutil
import subprocess
import time

NOISE_MM = 0.0002
FILES = 4


def run(command, **options):
    """Runs a command; returns its exit code, time in s, and largest resident memory in MiB."""
    begin = time.monotonic()
    process = subprocess.Popen(command, **options)
    _, status, usage = os.wait4(process.pid, 0)
    return os.waitstatus_to_exitcode(status), time.monotonic() - begin, usage.ru_maxrss / 1024


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


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("abbe", type=pathlib.Path)
    parser.add_argument("--readings", type=int, default=1_000_000)
    parser.add_argument("--in-memory", type=int, default=50_000, help="0: all readings in memory, to compare with")
    parser.add_argument("--folder", type=pathlib.Path, required=True)
    options = parser.parse_args()
    root = pathlib.Path(__file__).resolve().parent.parent
    example, machine = root / "examples/trunnion/ball-bar.study.toml", root / "examples/machines/trunnion-mill.machine.toml"
    options.folder.mkdir(parents=True)
    try:
        header, before, lengths = simulated_rows(options.abbe, example, machine, options.folder)
        shards = write_shards(options.folder, header, before, lengths, options.readings)
        size = sum(shard.stat().st_size for shard in shards)
        study = measured_study(example, machine, shards, options.in_memory, options.folder)
        with (options.folder / "out.txt").open("w") as out:
            code, seconds, memory = run([options.abbe, "run", study, "-o", options.folder / "results"], stdout=out, stderr=out)
        if code not in (0, 1):
            raise SystemExit((options.folder / "out.txt").read_text())
        summary = json.loads((options.folder / "results/summary.json").read_text())
        print(f"{options.readings} readings, {size / 2**20:.0f} MiB of text: {seconds:.1f} s, {memory:.0f} MiB resident,"
              f" exit code {code}, residuals {summary['normalised_residual_rms']:.4f} times as large as stated")
    finally:
        shutil.rmtree(options.folder)


main()
