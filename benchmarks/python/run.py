#!/usr/bin/env python3
"""Speed of the Python package: beside the same calls of the library without Python, beside other packages and NumPy.

    make bench-python                       all of it, with the other packages in build/bench-venv
    benchmarks/python/run.py [--json FILE]  with the package and the packages that this Python has
    benchmarks/python/run.py --check        small sizes: whether the numbers agree; nothing is timed for its own sake

Exit code 1: a target is missed.
"""

from __future__ import annotations

import argparse
import json
import os
import pathlib
import platform
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
if not os.environ.get("PYTHONPATH"):
    sys.path.insert(0, str(ROOT / "build/release/python"))

import numpy  # noqa: E402
from arm_identification import arm_identification  # noqa: E402
from arm_poses import arm_poses  # noqa: E402
from library_calls import LibraryCalls  # noqa: E402
from mill import many_poses, one_pose  # noqa: E402
from report import Table, to_json  # noqa: E402
from studies import identification  # noqa: E402
from timing import load  # noqa: E402

import abbe  # noqa: E402


def tables(small: bool) -> list[Table]:
    with LibraryCalls() as library:
        found = [
            many_poses(library, 20_000 if small else 1_000_000, 1 if small else 15),
            one_pose(library, 10 if small else 2_000, 1 if small else 100),
            identification(library, 200 if small else 10_000, 1 if small else 9),
        ]
    return [*found, arm_poses(5_000 if small else 1_000_000, 50 if small else 2_000, 1 if small else 7),
            arm_identification(60 if small else 1_000, 1 if small else 2)]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="small sizes, no judgement of times")
    parser.add_argument("--json", type=pathlib.Path, help="write the results there too")
    arguments = parser.parse_args()
    before = load()
    found = tables(arguments.check)
    conditions = {"abbe": abbe.__version__, "python": platform.python_version(), "numpy": numpy.__version__,
                  "threads": abbe.threads(), "processor": platform.machine(), "load_before": before, "load_after": load()}
    for table in found:
        print(table.text(), end="\n\n")
    print(f"other programs that wanted the processor: {before:.1f} before, {load():.1f} at the end (1: this one)")
    if arguments.json:
        arguments.json.write_text(json.dumps(to_json(found, conditions), indent=1) + "\n", encoding="utf-8")
    missed = [row.what for table in found for row in table.rows if row.met is False]
    return 1 if missed and not arguments.check else 0


if __name__ == "__main__":
    sys.exit(main())
