"""Counts what each of several processes sends and receives, for each kind of shared work (docs/scale.md).

    messages.py --abbe PROGRAM --mpirun PROGRAM --examples FOLDER --counts LIBRARY [--processes N ...] [--only KIND ...]

LIBRARY is message_counts.cpp as a shared library. More processes than cores are started: their times say nothing, and
what they send does not depend on times, but for the questions for blocks. For every kind: the messages and bytes that
the first process sends and receives, those of the process that has most of them, and how much that is for an item.
"""

import argparse
import os
import pathlib
import subprocess
import sys
import tempfile

import several_processes as kinds

ENVIRONMENT = {**kinds.ENVIRONMENT, "OMPI_MCA_hwloc_base_binding_policy": "none"}


def counted(arguments, folder, processes, words):
    """[(messages sent, bytes sent, messages received, bytes received)] of each process."""
    counts = folder / "counts"
    done = subprocess.run([arguments.mpirun, "-n", str(processes), "--oversubscribe", "-x",
                           f"LD_PRELOAD={arguments.counts.resolve()}", "-x", f"ABBE_MESSAGE_COUNTS={counts}",
                           arguments.abbe, *map(str, words)], capture_output=True, text=True,
                          env={**os.environ, **ENVIRONMENT})
    if done.returncode != 0:
        sys.exit(done.stderr)
    numbers = [list(map(int, pathlib.Path(f"{counts}.{rank}").read_text().split())) for rank in range(processes)]
    return [(sent, out, received, back) for sent, out, _, received, back, _ in numbers]


def words_of(sent, out, received, back):
    return f"sends {sent} messages, {out / 1e6:.4g} MB, and receives {received}, {back / 1e6:.4g} MB"


def main():
    parser = argparse.ArgumentParser()
    for name in ("--abbe", "--mpirun", "--examples", "--counts"):
        parser.add_argument(name, required=True, type=pathlib.Path)
    parser.add_argument("--errors", type=pathlib.Path, help="errors of the trunnion mill with covariance")
    parser.add_argument("--processes", nargs="+", type=int, default=[2, 3, 4, 6, 8])
    parser.add_argument("--only", nargs="+", metavar="KIND")
    parser.add_argument("--items", type=int, help="in place of the usual number of each kind")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        runs = kinds.Runs(arguments, pathlib.Path(folder))
        given = {"identify-in-pieces": (kinds.streamed_identification, 200000),
                 "monte-carlo": (kinds.monte_carlo, 20000), "map": (kinds.poses, 100000),
                 "deviate": (kinds.deviations, 1600000), "deviate-files": (kinds.deviation_files, 1600000),
                 "deviate-in-blocks": (kinds.streamed_deviations, 1600000), "register": (kinds.registration, 400000),
                 "plan": (kinds.plan, 240)}
        for name in arguments.only or given:
            words, items = given[name]
            items = arguments.items or items
            for processes in arguments.processes:
                counts = counted(arguments, runs.folder, processes, words(runs, items))
                messages = max(range(processes), key=lambda rank: counts[rank][0] + counts[rank][2])
                size = max(range(processes), key=lambda rank: counts[rank][1] + counts[rank][3])
                print(f"{name}, {items} items, {processes} processes: the first one {words_of(*counts[0])}; most "
                      f"messages, process {messages + 1}: {words_of(*counts[messages])}; most bytes, process "
                      f"{size + 1}: {words_of(*counts[size])}, {(counts[size][1] + counts[size][3]) / items:.1f} bytes "
                      "for an item", flush=True)


if __name__ == "__main__":
    main()
