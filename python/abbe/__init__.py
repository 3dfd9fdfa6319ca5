"""Geometric accuracy of multi-axis machines: errors, instruments, identification, compensation."""

from ._core import (
    CORRECTION_STATUSES,
    Axis,
    CompensatedInverse,
    Corrections,
    INSTRUMENTS,
    Errors,
    Instrument,
    InverseSolutions,
    Machine,
    PoseModel,
    Poses,
    Readings,
    StudyPlan,
    StudyResult,
    __version__,
    inverse,
    nominal_poses,
    set_threads,
    threads,
)
from ._errors import InputError, Stopped
from ._positions import grid, positions
from ._study import Study, instrument

__all__ = [
    "Axis",
    "CORRECTION_STATUSES",
    "CompensatedInverse",
    "Corrections",
    "Errors",
    "INSTRUMENTS",
    "InputError",
    "Instrument",
    "InverseSolutions",
    "Machine",
    "PoseModel",
    "Poses",
    "Readings",
    "Stopped",
    "Study",
    "StudyPlan",
    "StudyResult",
    "__version__",
    "grid",
    "instrument",
    "inverse",
    "nominal_poses",
    "positions",
    "set_threads",
    "threads",
]
