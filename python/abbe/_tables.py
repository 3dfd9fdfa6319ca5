"""Results as tables of pandas, and as HTML in notebooks."""

from __future__ import annotations

import csv
import html
import io
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy

if TYPE_CHECKING:
    import pandas

    from ._core import (Axis, ComparedPair, Comparison, Errors, Evaluation, FittedCircles, FittedShape, HistoryTrends,
                        ImportedTable, PlannedMeasurement, Readings, ScanDeviations, StudyPlan, StudyResult,
                        VerifiedReadings)

    Reported = Comparison | Evaluation | FittedShape | FittedCircles | HistoryTrends | ScanDeviations | VerifiedReadings

_MOST_ROWS = 40


def _pandas() -> Any:
    try:
        import pandas
    except ImportError as error:
        raise ImportError("to_dataframe() needs pandas: pip install pandas") from error
    return pandas


def _values(names: Sequence[str], values: numpy.ndarray, uncertainties: numpy.ndarray, is_angle: numpy.ndarray,
            is_pure_number: numpy.ndarray | None = None) -> dict[str, list[object]]:
    """Values in the units in which they are read: um, urad, um/m."""
    pure = numpy.zeros(len(names), bool) if is_pure_number is None else is_pure_number
    factor = numpy.where(pure | is_angle, 1e6, 1e3)
    units = numpy.where(pure, "um/m", numpy.where(is_angle, "urad", "um"))
    return {"name": list(names), "value": list(values * factor), "u": list(uncertainties * factor), "unit": list(units)}


def _errors(errors: Errors) -> dict[str, list[object]]:
    return _values(errors.names, errors.values_mm_rad, errors.standard_uncertainties_mm_rad, errors.is_angle)


def _result(result: StudyResult) -> dict[str, list[object]]:
    if len(result.estimates_mm_rad) == 0:
        return {"name": [], "value": [], "u": [], "unit": []}
    uncertainties = result.standard_uncertainties_mm_rad
    if len(uncertainties) == 0:
        uncertainties = numpy.full(len(result.names), numpy.nan)
    return _values(result.names, result.estimates_mm_rad, uncertainties, result.is_angle, result.is_pure_number)


def errors_frame(errors: Errors) -> pandas.DataFrame:
    frame: pandas.DataFrame = _pandas().DataFrame(_errors(errors))
    return frame.set_index("name")


def result_frame(result: StudyResult) -> pandas.DataFrame:
    frame: pandas.DataFrame = _pandas().DataFrame(_result(result))
    return frame.set_index("name")


def _commands(positions: numpy.ndarray, axes: Sequence[Axis]) -> dict[str, numpy.ndarray]:
    columns = {}
    for index, axis in enumerate(axes):
        linear = axis.kind == "linear"
        name = f"{axis.name}_{'mm' if linear else 'deg'}"
        columns[name] = positions[:, index] if linear else numpy.degrees(positions[:, index])
    return columns


def readings_frame(readings: Readings) -> pandas.DataFrame:
    columns: dict[str, object] = dict(_commands(readings.positions_mm_rad, readings.instrument.machine.axes))
    columns["item"] = readings.items
    for values, prefix in ((readings.measured_mm_rad, ""), (readings.standard_uncertainties_mm_rad, "u_")):
        if values is not None:
            for index, name in enumerate(readings.instrument.components):
                columns[prefix + name] = values[:, index]
    frame: pandas.DataFrame = _pandas().DataFrame(columns)
    return frame


def measurement_frame(planned: PlannedMeasurement) -> pandas.DataFrame:
    """A row for each reading, in the order of the program."""
    columns: dict[str, object] = {"number": [reading.number for reading in planned.readings]}
    for name in ("setup", "station", "target", "point"):
        columns[name] = [getattr(reading, name) for reading in planned.readings]
    columns.update(_commands(planned.positions_mm_rad, planned.machine.axes))
    columns["finished_s"] = planned.finished_s
    frame: pandas.DataFrame = _pandas().DataFrame(columns)
    return frame


def imported_values(table: ImportedTable) -> dict[str, numpy.ndarray | list[str]]:
    text, columns = table.csv(), table.columns
    numbers = [index for index, column in enumerate(columns) if not column.is_text]
    read = numpy.loadtxt(io.StringIO(text), delimiter=",", quotechar='"', comments=None, skiprows=1, usecols=numbers,
                         ndmin=2)
    values: dict[str, numpy.ndarray | list[str]] = {}
    for index, column in enumerate(columns):
        if column.is_text:
            rows = csv.reader(io.StringIO(text, newline=""))
            next(rows)
            values[column.name] = [row[index] for row in rows]
        else:
            values[column.name] = read[:, numbers.index(index)].copy()
    return values


def imported_frame(table: ImportedTable) -> pandas.DataFrame:
    frame: pandas.DataFrame = _pandas().DataFrame(table.values())
    return frame


def changes_frame(pair: ComparedPair) -> pandas.DataFrame:
    """A row for each error; values and changes in um or urad."""
    rows = []
    for error in pair.errors:
        factor = 1e6 if error.is_angle else 1e3
        first, second = error.values_mm_rad or (None, None)
        numbers = {"first": first, "second": second, "change": error.change_mm_rad,
                   "U": error.expanded_uncertainty_mm_rad}
        rows.append({"name": error.name, "what it is": error.words,
                     **{name: None if number is None else factor * number for name, number in numbers.items()},
                     "unit": "urad" if error.is_angle else "um", "p": error.probability,
                     "p_adjusted": error.adjusted_probability,
                     "at_tool_um": None if error.at_tool_mm is None else 1e3 * error.at_tool_mm,
                     "verdict": error.verdict})
    columns = ["name", "what it is", "first", "second", "change", "U", "unit", "p", "p_adjusted", "at_tool_um", "verdict"]
    frame: pandas.DataFrame = _pandas().DataFrame(rows, columns=columns)
    for name in ("first", "second", "change", "U", "p", "p_adjusted", "at_tool_um"):
        frame[name] = frame[name].astype(float)
    return frame.set_index("name")


def trends_frame(trends: HistoryTrends) -> pandas.DataFrame:
    """A row for each error that is followed; changes and drifts in um or urad."""
    rows = []
    for error in trends.errors.values():
        if error.not_followed is not None:
            continue
        factor = 1e6 if error.is_angle else 1e3
        numbers = {"change": error.changes_mm_rad[-1], "drift_per_year": error.drift_mm_rad_per_year,
                   "U_drift": error.drift_expanded_uncertainty_mm_rad_per_year, "scatter": error.scatter_mm_rad,
                   "expected": error.expected_mm_rad, "U_expected": error.expected_expanded_uncertainty_mm_rad}
        rows.append({"name": error.name, "what it is": error.words, "unit": "urad" if error.is_angle else "um",
                     **{name: None if number is None else factor * number for name, number in numbers.items()},
                     "drifts": error.drifts, "last_is_expected": error.last_is_expected, "due": error.due})
    of_numbers = ["change", "drift_per_year", "U_drift", "scatter", "expected", "U_expected"]
    columns = ["name", "what it is", "unit", *of_numbers, "drifts", "last_is_expected", "due"]
    frame: pandas.DataFrame = _pandas().DataFrame(rows, columns=columns)
    for name in of_numbers:
        frame[name] = frame[name].astype(float)
    return frame.set_index("name")


def plan_frame(plan: StudyPlan) -> pandas.DataFrame:
    columns: dict[str, object] = dict(_commands(plan.positions_mm_rad, plan.machine.axes))
    columns["setup"] = plan.setups
    frame: pandas.DataFrame = _pandas().DataFrame(columns)
    return frame


def _table_html(columns: dict[str, list[object]]) -> str:
    rows = list(zip(*columns.values()))
    cells = "".join(
        f"<tr><th style='text-align:left'>{html.escape(str(name))}</th><td>{value:.3f}</td><td>{u:.3f}</td>"
        f"<td style='text-align:left'>{html.escape(str(unit))}</td></tr>" for name, value, u, unit in rows[:_MOST_ROWS])
    more = f"<p>and {len(rows) - _MOST_ROWS} more</p>" if len(rows) > _MOST_ROWS else ""
    head = "".join(f"<th>{name}</th>" for name in columns)
    return f"<table><thead><tr>{head}</tr></thead><tbody>{cells}</tbody></table>{more}"


def errors_html(errors: Errors) -> str:
    return f"<p>{html.escape(repr(errors))}</p>{_table_html(_errors(errors))}"


def result_html(result: StudyResult) -> str:
    parts = [f"<p><b>{html.escape(result.message or result.status)}</b></p>"]
    parts += [f"<p>Not to be trusted: {html.escape(reason)}</p>" for reason in result.distrusted]
    parts.append(_table_html(_result(result)))
    parts.append(f"<details><summary>All that there is to say</summary><pre>{html.escape(result.text())}</pre></details>")
    return "".join(parts)


def _figures(result: Reported) -> dict[str, list[object]]:
    figures = list(result.figures.values())
    names = ("symbol", "name", "value", "expanded_uncertainty", "unit", "tolerance", "verdict")
    return {name: [getattr(figure, name) for figure in figures] for name in names}


def figures_frame(result: Reported) -> pandas.DataFrame:
    frame: pandas.DataFrame = _pandas().DataFrame(_figures(result))
    for name in ("value", "expanded_uncertainty", "tolerance"):
        frame[name] = frame[name].astype(float)
    return frame.set_index("symbol")


def figures_html(result: Reported) -> str:
    columns = _figures(result)

    def cell(name: str, value: object) -> str:
        if value is None:
            return "<td></td>"
        return f"<td style='text-align:{'right' if isinstance(value, float) else 'left'}'>{html.escape(str(value))}</td>"

    head = "".join(f"<th>{name}</th>" for name in columns)
    rows = "".join("<tr>" + "".join(cell(name, value) for name, value in zip(columns, row)) + "</tr>"
                   for row in zip(*columns.values()))
    return (f"<p><b>{html.escape(result.title)}</b> {html.escape(result.standard)}</p><table><thead><tr>{head}</tr></thead>"
            f"<tbody>{rows}</tbody></table>")


def plan_html(plan: StudyPlan) -> str:
    return f"<p>{html.escape(repr(plan))}</p><pre>{html.escape(plan.text())}</pre>"
