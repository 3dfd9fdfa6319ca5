"""A program with types, for mypy --strict (test_types.py)."""
from __future__ import annotations

import datetime
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


def radius_mm(points: abbe.PointCloud | numpy.typing.ArrayLike | Path) -> tuple[float, float] | str:
    fitted: abbe.FittedShape = abbe.fit(points, "sphere", method="robust")
    if not fitted.ok or fitted.shape.radius_mm is None or fitted.radius_uncertainty_mm is None:
        return fitted.reason
    return fitted.shape.radius_mm, fitted.radius_uncertainty_mm


def largest_deviation_mm(scan: Path, part: abbe.Mesh | Path) -> float:
    placed: abbe.ScanRegistration = abbe.register_scan(scan, part, progress=step)
    deviations: abbe.ScanDeviations = abbe.scan_deviations(scan, part, transform=placed, faces_deg=30)
    return max(abs(deviations.statistics_mm.minimum), deviations.statistics_mm.maximum)


def imported_mm(table: Path | bytes, machine: abbe.Machine | None) -> list[float]:
    imported: abbe.ImportedTable = abbe.import_table(table, machine=machine, length_unit="mm")
    if not imported.certain:
        raise SystemExit("; ".join(column.name for column in imported.columns if column.doubts))
    numbers = imported.values()["x_mm"]
    return [float(number) for number in numbers]


def largest_change(campaigns: list[Path | abbe.Errors]) -> float | None:
    found: abbe.Comparison = abbe.compare(campaigns, tolerances={"V_max_um": 10.0}, progress=step)
    pair: abbe.ComparedPair = found.pairs[0]
    curve: abbe.ComparedCurve | None = pair["EXX"].curve
    return None if curve is None else float(numpy.abs(curve.change_mm_rad).max())


def due_dates(history: abbe.History, campaigns: list[abbe.Errors | Path], days: list[datetime.date]) -> dict[str, datetime.date]:
    numbers: list[int] = history.add(campaigns, days, names=[day.isoformat() for day in days])
    numbers += history.add(campaigns[:0], numpy.array(["2026-03-02"], dtype="datetime64[D]")[:0])
    trends: abbe.HistoryTrends = history.trends(limit_um=20 if numbers else None, progress=step)
    return {name: trend.due for name, trend in trends.errors.items() if trend.due is not None}


def drift_um(trend: abbe.ErrorTrend, days: numpy.typing.NDArray[numpy.datetime64]) -> numpy.ndarray:
    values, expanded = trend.predict(days)
    largest: numpy.ndarray = 1e3 * numpy.maximum(numpy.abs(values), expanded)
    return largest


def verified(study: abbe.Study, errors: abbe.Errors, readings: abbe.Readings) -> float | None:
    check: abbe.StudyCheck = study.check({"tracker": readings})
    if not check.explained:
        raise SystemExit("; ".join(cause for place in check.unexplained for cause in place.causes))
    result: abbe.VerifiedReadings = study.verify(errors, {"tracker": readings}, largest_ratio=1.5)
    return None if result.says_no else result.coverage


def reported(test: abbe.Evaluation, earlier: abbe.Evaluation | None) -> dict[str, list[str]]:
    report: abbe.CustomerReport = abbe.customer_report(test, {"date": datetime.date(2026, 11, 28)}, before=earlier)
    report.write("report.html", overwrite=True)
    return {figure.symbol: figure.verdicts for figure in report.figures}


def distances(part: abbe.Mesh, points: numpy.typing.NDArray[numpy.float64]) -> numpy.ndarray:
    shifted: abbe.BestFit = abbe.best_fit_transform(points, points + 1, weights=numpy.ones(len(points)))
    return part.closest(points + shifted.matrix[:3, 3]).distance_mm


def program_of(machine: abbe.Machine, readings: abbe.StudyPlan | Path | numpy.typing.ArrayLike, fixture: abbe.Mesh) -> str:
    planned: abbe.PlannedMeasurement = abbe.plan_measurement(
        machine, readings, "siemens", start={"X_mm": 0}, obstacle_boxes_mm=[("table", (0, 0, 0, 10, 10, 10))],
        obstacle_meshes=[("base", fixture), ("X", Path("vice.stl"))])
    touches: abbe.PlannedProbing = abbe.plan_probing(machine, readings, (80, 0, 60, 12.5), words={"C1": "C"})
    if planned.program is None or touches.program is None:
        raise SystemExit(planned.refused or touches.refused)
    last: abbe.PlannedReading = planned.readings[-1]
    print(f"{last.target}: {planned.finished_s[last.number - 1]:.0f} s", touches.readings_csv("0 0 0 0 0 0 0 0 0"))
    return planned.program


def rotary_axes(errors: abbe.Errors) -> dict[str, float]:
    made: abbe.KinematicValues = abbe.kinematic_values(errors, "siemens", tool_carrier=1)
    changes = {value.name: value.actual_mm_rad - value.nominal_mm_rad for value in made.values}
    return {} if made.file is None else changes


def scanned(part: abbe.Mesh, machine: abbe.Machine) -> numpy.ndarray:
    planned: abbe.PlannedScan = abbe.plan_scan(part, machine, along_mm=1, beyond_planes_mm=[(0, 0, 1, 0)])
    return abbe.scan_points(machine, planned.positions_mm_rad, numpy.zeros(len(planned))).points_mm


if __name__ == "__main__":
    print(f"{deviation_mm(machine_from(None), 20, 200):.4f} mm")
