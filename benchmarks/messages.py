"""Counts the messages and bytes that each of several processes sends, for each kind of shared work (docs/scale.md).

    messages.py --abbe PROGRAM --mpirun PROGRAM --examples FOLDER --counts LIBRARY [--processes N ...] [--only KIND ...]

LIBRARY is message_counts.cpp as a shared library. More processes than cores are started: their times say nothing, and
what they send does not depend on times, but for the questions for blocks. All messages go to the first process or come
from it. For every kind: what the first process sends, what it receives, and how much that is for an item and for each
further process.
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
    """[(messages, bytes, largest)] of what each process sends."""
    counts = folder / "counts"
    done = subprocess.run([arguments.mpirun, "-n", str(processes), "--oversubscribe", "-x",
                           f"LD_PRELOAD={arguments.counts.resolve()}", "-x", f"ABBE_MESSAGE_COUNTS={counts}",
                           arguments.abbe, *map(str, words)], capture_output=True, text=True,
                          env={**os.environ, **ENVIRONMENT})
    if done.returncode != 0:
        sys.exit(done.stderr)
    return [tuple(map(int, pathlib.Path(f"{counts}.{rank}").read_text().split())) for rank in range(processes)]


def main():
    parser = argparse.ArgumentParser()
    for name in ("--abbe", "--mpirun", "--examples", "--counts"):
        parser.add_argument(name, required=True, type=pathlib.Path)
    parser.add_argument("--errors", type=pathlib.Path, help="errors of the trunnion mill with covariance")
    parser.add_argument("--processes", nargs="+", type=int, default=[2, 3, 4, 6, 8])
    parser.add_argument("--only", nargs="+", metavar="KIND")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        runs = kinds.Runs(arguments, pathlib.Path(folder))
        given = {"monte-carlo": (kinds.monte_carlo, 20000), "map": (kinds.poses, 100000),
                 "deviate": (kinds.deviations, 1600000), "deviate-files": (kinds.deviation_files, 1600000),
                 "deviate-in-blocks": (kinds.streamed_deviations, 1600000), "register": (kinds.registration, 400000),
                 "plan": (kinds.plan, 240)}
        for name in arguments.only or given:
            words, items = given[name]
            for processes in arguments.processes:
                sent = counted(arguments, runs.folder, processes, words(runs, items))
                out, back = sent[0], [sum(column) for column in zip(*sent[1:])]
                print(f"{name}, {items} items, {processes} processes: the first one sends {out[0]} messages, "
                      f"{out[1]} bytes, and receives {back[0]} messages, {back[1]} bytes; of an item "
                      f"{out[1] / items / (processes - 1):.2f} bytes to each process and {back[1] / items:.2f} back",
                      flush=True)


if __name__ == "__main__":
    main()
