"""Arrays of axis commands from commands with names and units."""

from __future__ import annotations

import numpy
import numpy.typing

from ._core import Machine
from ._errors import InputError

_FACTORS = {"linear": {"mm": 1.0, "um": 1e-3, "m": 1e3},
            "rotary": {"rad": 1.0, "deg": numpy.pi / 180, "mrad": 1e-3, "urad": 1e-6, "arcsec": numpy.pi / 648000}}


def _columns(machine: Machine, commands: dict[str, numpy.typing.ArrayLike]) -> list[numpy.ndarray | None]:
    """The commands of every axis in mm or rad, None where an axis has none."""
    kinds = {axis.name: axis.kind for axis in machine.axes}
    names = list(kinds)
    columns: list[numpy.ndarray | None] = [None] * len(names)
    for key, values in commands.items():
        name, _, unit = key.rpartition("_")
        if name not in kinds or unit not in _FACTORS[kinds[name]]:
            expected = ", ".join(f"{axis}_{'mm' if kind == 'linear' else 'deg'}" for axis, kind in kinds.items())
            raise InputError(f"{key}: is no axis with its unit; expected {expected}", field=key,
                             problem="is no axis with its unit", expected=expected)
        if columns[names.index(name)] is not None:
            raise InputError(f"{key}: axis {name} is given twice; expected it once", field=key)
        columns[names.index(name)] = numpy.asarray(values, dtype=float) * _FACTORS[kinds[name]][unit]
    return columns


def positions(machine: Machine, **commands: numpy.typing.ArrayLike) -> numpy.ndarray:
    """Axis commands [n, axes] in mm and rad from one keyword per axis with its unit; axes that are not named stand at 0.

    Numbers and arrays are broadcast against each other. The array is in Fortran order, which the library uses in place.

    >>> import abbe
    >>> mill = abbe.Machine.from_chain("w C' b X Z t")
    >>> abbe.positions(mill, C_deg=[0, 180], X_mm=100).round(4).tolist()
    [[0.0, 100.0, 0.0], [3.1416, 100.0, 0.0]]
    """
    columns = [numpy.zeros(1) if column is None else numpy.atleast_1d(column) for column in _columns(machine, commands)]
    return numpy.asfortranarray(numpy.stack([column.ravel() for column in numpy.broadcast_arrays(*columns)], axis=1))


def grid(machine: Machine, **commands: numpy.typing.ArrayLike) -> numpy.ndarray:
    """All combinations of commands [n, axes] in mm and rad; the first axis of the chain varies slowest.

    >>> import abbe
    >>> mill = abbe.Machine.from_chain("w X' Y' b Z t")
    >>> abbe.grid(mill, X_mm=[0, 10], Y_mm=[0, 5]).tolist()
    [[0.0, 0.0, 0.0], [0.0, 5.0, 0.0], [10.0, 0.0, 0.0], [10.0, 5.0, 0.0]]
    """
    columns = [numpy.zeros(1) if column is None else numpy.atleast_1d(column) for column in _columns(machine, commands)]
    return numpy.asfortranarray(numpy.stack([axis.ravel() for axis in numpy.meshgrid(*columns, indexing="ij")], axis=1))
