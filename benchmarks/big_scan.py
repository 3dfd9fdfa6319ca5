#!/usr/bin/env python3
"""Time and memory of `abbe deviate` on a scan that is read in blocks.

    python3 benchmarks/big_scan.py build/release/bin/abbe --points 100000000 --triangles 10000000 --folder FOLDER

Makes a wavy sheet as binary STL and points near it as binary PLY (three floats, 12 bytes each), runs the command with
/usr/bin/time -v, prints the time, the processor time, points per second and the peak memory, and removes the files.
"""
import argparse
import pathlib
import re
import subprocess
import time

import numpy as np

SIZE_MM = 1000.0
BLOCK = 1 << 20


def height(x, y):
    return 5 * np.sin(x / 40) * np.cos(y / 55)


def write_part(path, triangles):
    n = int(round((triangles / 2) ** 0.5))
    line = np.linspace(0, SIZE_MM, n + 1)
    record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    with open(path, "wb") as file:
        file.write(b"sheet".ljust(80) + np.uint32(2 * n * n).tobytes())
        for i in range(n):
            def row(x):
                return np.stack([np.full(n + 1, x), line, height(x, line)], axis=1)
            low, high = row(line[i]), row(line[i + 1])
            out = np.zeros(2 * n, record)
            out["corners"][0::2] = np.stack([low[:-1], high[:-1], high[1:]], axis=1)
            out["corners"][1::2] = np.stack([low[:-1], high[1:], low[1:]], axis=1)
            file.write(out.tobytes())
    return 2 * n * n


def write_scan(path, points):
    random = np.random.default_rng(1)
    with open(path, "wb") as file:
        file.write(("ply\nformat binary_little_endian 1.0\ncomment unit mm\n"
                    f"element vertex {points}\nproperty float x\nproperty float y\nproperty float z\n"
                    "end_header\n").encode())
        for begin in range(0, points, BLOCK):
            count = min(BLOCK, points - begin)
            xy = random.uniform(1, SIZE_MM - 1, (count, 2))
            z = height(xy[:, 0], xy[:, 1]) + random.normal(0, 0.02, count)
            file.write(np.column_stack([xy, z]).astype("<f4").tobytes())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("abbe")
    parser.add_argument("--points", type=int, default=100_000_000)
    parser.add_argument("--triangles", type=int, default=10_000_000)
    parser.add_argument("--threads", type=int, default=0)
    parser.add_argument("--folder", type=pathlib.Path, default=pathlib.Path("."))
    options = parser.parse_args()
    scan, part = options.folder / "big_scan.ply", options.folder / "big_part.stl"
    try:
        triangles = write_part(part, options.triangles)
        write_scan(scan, options.points)
        begin = time.perf_counter()
        done = subprocess.run(
            ["/usr/bin/time", "-v", options.abbe, "deviate", str(scan), str(part), "--threads", str(options.threads),
             "--stream-above", "0", "--json"], capture_output=True, text=True)
        seconds = time.perf_counter() - begin
        if done.returncode not in (0, 1):
            raise SystemExit(done.stderr)
        processor = sum(float(re.search(rf"{kind} time \(seconds\): ([\d.]+)", done.stderr).group(1)) for kind in ("User", "System"))
        memory = int(re.search(r"Maximum resident set size \(kbytes\): (\d+)", done.stderr).group(1))
        print(f"{options.points} points, {triangles} triangles: {seconds:.1f} s, "
              f"{processor:.1f} s of the processor, "
              f"{options.points / seconds / 1e6:.2f} million points/s, peak {memory / 1024:.0f} MiB")
    finally:
        scan.unlink(missing_ok=True)
        part.unlink(missing_ok=True)


if __name__ == "__main__":
    main()
