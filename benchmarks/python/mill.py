"""Poses of a five-axis mill with 30 error motions: the package beside the same calls without Python."""

from __future__ import annotations

import numpy
from library_calls import ROOT, LibraryCalls
from report import Table
from timing import in_turn, seconds

import abbe

MACHINE = ROOT / "examples/machines/trunnion-mill.machine.toml"
ERRORS = ROOT / "examples/compensate/trunnion.errors.toml"


def mill() -> abbe.Errors:
    return abbe.Errors.read(ERRORS, abbe.Machine.read(MACHINE))


def commands(machine: abbe.Machine, count: int) -> numpy.ndarray:
    """Random ones within the travel, Fortran order."""
    random = numpy.random.default_rng(7)
    columns = []
    for axis in machine.axes:
        low, high = axis.travel_mm if axis.kind == "linear" else numpy.radians(axis.travel_deg)
        columns.append(random.uniform(low, high, count))
    return numpy.asfortranarray(numpy.stack(columns, axis=1))


def agree(library: LibraryCalls, poses: abbe.Poses) -> None:
    count = len(poses.points_mm)
    expected = library.numbers("results").reshape(12, count)
    assert numpy.array_equal(expected[:3].T, poses.points_mm), "points differ from those of the library"
    assert numpy.array_equal(expected[3:].reshape(3, 3, count).transpose(2, 0, 1), poses.rotations)


def many_poses(library: LibraryCalls, count: int, repetitions: int) -> Table:
    errors = mill()
    model = abbe.PoseModel(errors)
    library.ask("machine", MACHINE, ERRORS)
    columns = commands(errors.machine, count)
    motions = {name.split("[")[0] for name in errors.names if "[" in name}
    table = Table(f"{count:,} poses of a mill with {len(motions)} error motions, {abbe.threads()} threads: ns per pose", "ns",
                  "Python / C++")
    for order, given in (("Fortran order", columns), ("C order", numpy.ascontiguousarray(columns))):
        library.take_commands(columns, "columns" if order == "Fortran order" else "rows")
        library.ask("poses", "kept")
        agree(library, model.poses(given))
        kept = model.poses(given)
        measures = {
            "C++, new memory": lambda: library.ask("poses", "fresh"),
            "Python, new memory": lambda q=given: seconds(lambda: model.poses(q)),
            "C++, the same memory": lambda: library.ask("poses", "kept"),
            "Python, the same memory (out=)": lambda q=given, kept=kept: seconds(lambda: model.poses(q, out=kept)),
        }
        library.ask("poses", "kept")
        times = in_turn(measures, repetitions)
        for python, other in (("Python, new memory", "C++, new memory"),
                              ("Python, the same memory (out=)", "C++, the same memory")):
            base = times[other].per(1e-9 * count)
            table.add(f"{order}: {other}", base)
            table.add(f"{order}: {python}", times[python].per(1e-9 * count), base, at_most=1.1)
    table.notes.append("results are the same to the last bit")
    return table


def one_pose(library: LibraryCalls, calls: int, repetitions: int) -> Table:
    errors = mill()
    model = abbe.PoseModel(errors)
    library.ask("machine", MACHINE, ERRORS)
    some = commands(errors.machine, 1)
    library.take_commands(some, "columns")
    pose = some[0].copy()
    assert numpy.array_equal(model.poses(pose).points_mm, model.poses(some).points_mm[0])
    times = in_turn({
        "C++: pose": lambda: library.ask("one", calls),
        "points() of a pose": lambda: seconds(lambda: model.points(pose), calls),
        "poses() of a pose": lambda: seconds(lambda: model.poses(pose), calls),
        "deviations() of a pose": lambda: seconds(lambda: model.deviations(pose), calls),
        "numpy.empty(3)": lambda: seconds(lambda: numpy.empty(3), calls),
    }, repetitions)
    table = Table("One pose per call", "us")
    for name, time in times.items():
        target = 2.0 if name in ("points() of a pose", "poses() of a pose") else None
        table.add(name, time.per(1e-6), at_most=target)
    table.notes.append(f"means over {calls:,} calls in a row")
    return table
