"""Plots of errors, maps, residuals and histories with matplotlib, styled for print.

Every function draws into axes that are given, or makes a figure, and returns it. Lengths are shown in um, angles in urad.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy
import numpy.typing

from ._core import CircularNumbers, Errors, Evaluation, ScanDeviations, StudyPlan, StudyResult
from ._errors import InputError

try:
    import matplotlib
    import matplotlib.pyplot as pyplot
    from cycler import cycler
    from matplotlib.figure import Figure
except ImportError as error:
    raise ImportError("abbe.plot needs matplotlib: pip install matplotlib") from error

#: Colours that people who see few colours tell apart (Okabe and Ito 2008).
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9")
_COMPONENTS = ("EX", "EY", "EZ", "EA", "EB", "EC")


@contextmanager
def style() -> Iterator[None]:
    """The style of these plots, for own ones: ``with abbe.plot.style(): ...``."""
    settings: Any = {
        "axes.prop_cycle": cycler(color=COLOURS), "axes.spines.top": False, "axes.spines.right": False,
        "axes.grid": True, "grid.linewidth": 0.4, "grid.color": "#cccccc", "axes.axisbelow": True, "font.size": 9,
        "axes.titlesize": 9, "legend.frameon": False, "legend.fontsize": 8, "lines.linewidth": 1.2, "savefig.dpi": 200,
        "figure.constrained_layout.use": True, "axes.titlelocation": "left",
    }
    with matplotlib.rc_context(settings):
        yield


def error_motions(errors: Errors, *, axes: Sequence[str] | None = None, coverage_factor: float = 2.0,
                  count: int = 201) -> Figure:
    """Error motions over the travel of their axes, a row per axis: translations in um, rotations in urad.

    Bands are the expanded uncertainty (``coverage_factor`` times the standard uncertainty) where one is stated. Where an
    error is not known, its line ends.
    """
    machine = errors.machine
    names = list(axes) if axes is not None else machine.axis_names
    wanted = [machine.axis(name) for name in names]
    if not wanted:
        raise InputError("axes: there are none; expected names of axes", field="axes")
    present = {name.split("[")[0] for name in errors.names if "[" in name}
    with style():
        figure, panels = pyplot.subplots(len(wanted), 2, figsize=(7.2, 2.1 * len(wanted)), squeeze=False)
        for row, axis in zip(panels, wanted):
            linear = axis.kind == "linear"
            low, high = axis.travel_mm if linear else numpy.radians(axis.travel_deg)
            positions = numpy.linspace(low, high, count)
            values = errors.evaluate(axis.name, positions)
            uncertainty = errors.evaluate_uncertainty(axis.name, positions)
            shown = positions if linear else numpy.degrees(positions)
            known = _covered(errors, machine.axis_names.index(axis.name), positions)
            for panel, first, factor, unit in ((row[0], 0, 1e3, "um"), (row[1], 3, 1e6, "urad")):
                for component in range(first, first + 3):
                    name = _COMPONENTS[component] + axis.name
                    if name not in present:
                        continue
                    line = numpy.where(known, factor * values[:, component], numpy.nan)
                    band = coverage_factor * factor * uncertainty[:, component]
                    drawn = panel.plot(shown, line, label=name)
                    if band.any():
                        panel.fill_between(shown, line - band, line + band, alpha=0.2, color=drawn[0].get_color(), linewidth=0)
                panel.set_ylabel(_unit(unit))
                panel.set_xlabel(f"{axis.name} / {'mm' if linear else 'deg'}")
                if panel.get_legend_handles_labels()[0]:
                    panel.legend(ncols=3, loc="best")
    return figure


def _covered(errors: Errors, index: int, positions: numpy.ndarray) -> numpy.ndarray:
    """Where the errors of one axis are known."""
    from ._core import PoseModel

    commands = numpy.zeros((len(positions), len(errors.machine.axes)), order="F")
    for other, axis in enumerate(errors.machine.axes):
        low, high = axis.travel_mm if axis.kind == "linear" else numpy.radians(axis.travel_deg)
        commands[:, other] = min(max(0.0, low), high)
    reference = commands[:1].copy()
    commands[:, index] = positions
    model = PoseModel(errors)
    covered = numpy.asarray(model.covered(commands))
    # Another axis may stand where its own errors are not known; then nothing can be said about this one.
    return covered if covered.any() or numpy.all(model.covered(reference)) else numpy.ones(len(positions), bool)


def _unit(unit: str) -> str:
    return {"um": "µm", "urad": "µrad"}.get(unit, unit)


def residuals(result: StudyResult, setup: str | None = None) -> Figure:
    """Residuals of a set-up in the order of the readings and as histograms: lengths in um, angles in urad.

    Readings that did not take part in the fit are grey.
    """
    name = setup if setup is not None else result.setups[0]
    values, used = result.residuals_mm_rad(name), result.used(name)
    if values is None or used is None:
        raise InputError("result: nothing was identified; expected a study with residuals", field="result")
    components = result.readings(name).instrument.components
    with style():
        figure, panels = pyplot.subplots(values.shape[1], 2, figsize=(7.2, 1.9 * values.shape[1]), squeeze=False,
                                         width_ratios=[3, 1], sharey="row")
        index = numpy.arange(len(values))
        for column, (left, right) in enumerate(panels):
            label, unit = components[column].rsplit("_", 1)
            shown = values[:, column] * (1e3 if unit == "mm" else 1e6)
            left.plot(index[~used], shown[~used], ".", color="#999999", markersize=3, label="held out")
            left.plot(index[used], shown[used], ".", markersize=3, label="used")
            left.set_ylabel(f"{label} / {_unit('um' if unit == 'mm' else 'urad')}")
            right.hist(shown[used], bins="auto", orientation="horizontal", color=COLOURS[0])
        panels[0, 0].legend(ncols=2)
        panels[-1, 0].set_xlabel(f"reading of {name}")
        panels[-1, 1].set_xlabel("number")
    return figure


def error_map(points_mm: numpy.typing.ArrayLike, displacements_mm: numpy.typing.ArrayLike, *, scale: float | None = None,
              title: str = "") -> Figure:
    """Displacements at points [n, 3] in the workpiece frame: arrows, enlarged ``scale`` times, coloured by their length.

    Without a scale the longest arrow is a tenth of the volume.
    """
    points, vectors = numpy.asarray(points_mm, float), numpy.asarray(displacements_mm, float)
    if points.ndim != 2 or points.shape[1] != 3 or points.shape != vectors.shape or len(points) == 0:
        raise InputError(f"points_mm: shapes {points.shape} and {vectors.shape}; expected (n, 3) of both", field="points_mm")
    length = numpy.linalg.norm(vectors, axis=1)
    if scale is None:
        scale = 0.1 * float(numpy.ptp(points, axis=0).max() or 1.0) / float(length.max() or 1.0)
    with style():
        figure = pyplot.figure(figsize=(5.6, 4.6))
        panel: Any = figure.add_subplot(projection="3d")
        norm = matplotlib.colors.Normalize(0, 1e3 * float(length.max() or 1.0))
        colours = matplotlib.colormaps["viridis"](norm(1e3 * length))
        for point, vector, colour in zip(points, scale * vectors, colours):
            panel.plot(*numpy.stack([point, point + vector], axis=1), color=colour, linewidth=1)
        panel.scatter(*points.T, c=colours, s=6)
        panel.set(xlabel="x / mm", ylabel="y / mm", zlabel="z / mm", title=title or f"displacement, {scale:.0f} times")
        figure.colorbar(matplotlib.cm.ScalarMappable(norm, "viridis"), ax=panel, label="displacement / µm", shrink=0.7)
    return figure


def polar(angles_deg: numpy.typing.ArrayLike, deviations_mm: numpy.typing.ArrayLike, *, title: str = "",
          radius_mm: float | None = None) -> Figure:
    """A polar plot of deviations (in um) over an angle: circular tests, rotation error motion.

    ``radius_mm``: deviation at the circle from which the plot counts; without it three times their spread is added.
    """
    angles, deviations = numpy.radians(numpy.asarray(angles_deg, float)), 1e3 * numpy.asarray(deviations_mm, float)
    if angles.ndim != 1 or angles.shape != deviations.shape or len(angles) == 0:
        raise InputError(f"angles_deg: shapes {angles.shape} and {deviations.shape}; expected (n,) of both", field="angles_deg")
    return _polar([("", angles, deviations)], title, None if radius_mm is None else 1e3 * radius_mm)


def _polar(curves: Sequence[tuple[str, numpy.ndarray, numpy.ndarray]], title: str, base: float | None = None) -> Figure:
    """Curves (name, angles in rad, deviations in um) about the circle from which the deviations are measured."""
    shown = numpy.concatenate([deviations for _, _, deviations in curves])
    spread = float(numpy.ptp(shown)) or 1.0
    middle = 3 * spread - float(shown.min()) if base is None else base
    with style():
        figure = pyplot.figure(figsize=(4.2, 4.2))
        panel: Any = figure.add_subplot(projection="polar")
        for name, angles, deviations in curves:
            panel.plot(angles, middle + deviations, label=name)
        panel.plot(numpy.linspace(0, 2 * numpy.pi, 361), numpy.full(361, middle), color="#555555", linewidth=0.8)
        ticks = middle + numpy.array([-spread, 0, spread])
        panel.set_yticks(ticks, [f"{tick - middle:+.3g} µm" for tick in ticks])
        panel.set_ylim(0, middle + 1.5 * spread)
        panel.set_title(title)
        if any(name for name, _, _ in curves):
            panel.legend(loc="lower center", bbox_to_anchor=(0.5, -0.22))
    return figure


def circular(evaluation: Evaluation, *, title: str = "") -> Figure:
    """Radial deviations of a circular test (in um), both directions, each about its own centre."""
    numbers = evaluation.numbers
    if not isinstance(numbers, CircularNumbers):
        raise InputError(f"evaluation: is of {evaluation.kind}; expected one by evaluate_circular()", field="evaluation")
    paths = [(name, path) for name, path in (("clockwise", numbers.clockwise),
                                             ("counter-clockwise", numbers.counterclockwise)) if path.status == "done"]
    if not paths:
        raise InputError("evaluation: no path has a centre; expected at least one that has", field="evaluation")
    return _polar([(f"{name}, G = {1e3 * path.circular_mm:.2f} µm", path.angle_rad, 1e3 * path.deviation_mm)
                   for name, path in paths], title or evaluation.title)


def deviations(result: ScanDeviations, *, limits_um: tuple[float, float] | None = None, title: str = "") -> Figure:
    """Histogram of the deviations of a scan from the part (in um), with limits."""
    if not result.has_points:
        raise InputError("result: no point counts; expected at least one that does", field="result")
    shown, statistics = 1e3 * result.counted_mm, result.statistics_mm
    with style():
        figure, panel = pyplot.subplots(figsize=(5.2, 2.8))
        panel.hist(shown, bins="auto" if numpy.ptp(shown) > 0 else 1, color=COLOURS[0])
        panel.axvline(1e3 * statistics.mean, color="#555555", linewidth=0.8)
        for limit in limits_um or ():
            panel.axvline(limit, color=COLOURS[1], linestyle="--", linewidth=0.8)
        panel.set(xlabel="deviation / µm, positive outside", ylabel="points",
                  title=title or f"mean {1e3 * statistics.mean:.1f} µm, rms {1e3 * statistics.rms:.1f} µm")
    return figure


def trend(times: numpy.typing.ArrayLike, values: numpy.typing.ArrayLike, standard_uncertainties: numpy.typing.ArrayLike | None = None,
          *, label: str = "", unit: str = "", limits: tuple[float, float] | None = None) -> Figure:
    """A value over time with its expanded uncertainty (k = 2) and limits."""
    x, y = numpy.asarray(times), numpy.asarray(values, float)
    if x.ndim != 1 or x.shape != y.shape:
        raise InputError(f"times: shapes {x.shape} and {y.shape}; expected (n,) of both", field="times")
    with style():
        figure, panel = pyplot.subplots(figsize=(7.2, 2.4))
        spread = None if standard_uncertainties is None else 2 * numpy.asarray(standard_uncertainties, float)
        panel.errorbar(x, y, spread, fmt="o-", markersize=3, capsize=2)
        for limit in limits or ():
            panel.axhline(limit, color=COLOURS[1], linestyle="--", linewidth=0.8)
        panel.set_ylabel(f"{label} / {_unit(unit)}" if unit else label)
    return figure


def plan_curve(plan: StudyPlan) -> Figure:
    """Predicted uncertainty of the volumetric error against the number of readings."""
    with style():
        figure, panel = pyplot.subplots(figsize=(5.2, 2.8))
        panel.plot(plan.curve[:, 0], 1e3 * plan.curve[:, 1], "o-", markersize=3)
        panel.set(xlabel="readings", ylabel="standard uncertainty / µm", yscale="log")
    return figure
