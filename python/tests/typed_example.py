"""A program with types, for mypy --strict (test_types.py)."""
from __future__ import annotations

from pathlib import Path

import numpy
import numpy.typing

import abbe


def deviation_mm(machine: abbe.Machine, squareness_urad: float, y_mm: float) -> float:
    errors = abbe.Errors(machine)
    errors.add_location("EC0Y", value_urad=squareness_urad)
    commands: numpy.typing.NDArray[numpy.float64] = abbe.positions(machine, Y_mm=y_mm)
    deviations = abbe.PoseModel(errors).deviations(commands)
    return float(deviations[0, 0])


def machine_from(path: Path | None) -> abbe.Machine:
    try:
        return abbe.Machine.read(path) if path else abbe.Machine.from_chain("w X' Y' b Z t")
    except abbe.InputError as error:
        line: int | None = error.line
        raise SystemExit(f"{error.problem} in line {line}") from error


def corrected(errors: abbe.Errors, commands: numpy.typing.ArrayLike) -> list[str]:
    corrections = abbe.CompensatedInverse(errors, target="point").correct(commands)
    states = numpy.atleast_1d(corrections.status)
    return [abbe.CORRECTION_STATUSES[int(state)] for state in states]


def step(name: str, done: int, total: int) -> None:
    print(f"{name}: {done} of {total}")


def chi_squares(paths: list[Path]) -> dict[str, float]:
    results: dict[str, float] = {}
    for path in paths:
        study: abbe.Study = abbe.Study.read(path)
        result: abbe.StudyResult = study.run(map=False, progress=step)
        results[study.name] = result.chi_square
    return results


def accuracy_um(readings: Path | dict[str, numpy.typing.ArrayLike]) -> float | None:
    evaluation: abbe.Evaluation = abbe.evaluate_positioning(readings, tolerances={"A_um": 10})
    figure: abbe.EvaluationFigure = evaluation["A"]
    return figure.value


def roundness_um(angle_deg: numpy.typing.ArrayLike, deviation_um: numpy.typing.ArrayLike, count: int) -> dict[str, float]:
    columns = {"direction": ["cw"] * count, "angle_deg": angle_deg, "deviation_um": deviation_um}
    figures = abbe.evaluate_circular(columns, 150).figures
    return {symbol: figure.value for symbol, figure in figures.items() if figure.value is not None}


if __name__ == "__main__":
    print(f"{deviation_mm(machine_from(None), 20, 200):.4f} mm")
