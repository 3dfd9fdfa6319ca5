"""A whole study, from simulated readings to trusted errors: the package beside the same call without Python."""

from __future__ import annotations

import pathlib
import tempfile

import numpy
from library_calls import ROOT, LibraryCalls
from report import Table
from timing import in_turn, seconds

import abbe


def study_file(folder: pathlib.Path, points: int) -> pathlib.Path:
    """The study of examples/aguado with another number of readings and no map, and its machine."""
    example = abbe.Study.read(ROOT / "examples/aguado/aguado.study.toml")
    document = example.to_dict()
    document["machine"] = "aguado.machine.toml"
    document["setup"][0]["plan"][0]["points"] = points
    return abbe.Study(example.machine, document, name="aguado").write(folder)


def identification(library: LibraryCalls, points: int, repetitions: int) -> Table:
    with tempfile.TemporaryDirectory() as name:
        file = study_file(pathlib.Path(name), points)
        study = abbe.Study.read(file)
        library.ask("study", file)
        library.ask("run")
        result = study.run(map=False)
        assert numpy.array_equal(result.estimates_mm_rad, library.numbers("estimates")), "estimates differ"
        times = in_turn({
            "C++: run_study()": lambda: library.ask("run"),
            "Python: Study.run()": lambda: seconds(lambda: study.run(map=False)),
        }, repetitions)
    table = Table(f"Study of a laser tracker, {points:,} readings, {len(result.estimates_mm_rad)} parameters", "ms", "Python / C++")
    base = times["C++: run_study()"].per(1e-3)
    table.add("C++: run_study()", base)
    table.add("Python: Study.run()", times["Python: Study.run()"].per(1e-3), base, at_most=1.05)
    return table
