"""Geometric accuracy of multi-axis machines: errors, instruments, identification, compensation."""

from ._core import (
    CORRECTION_STATUSES,
    Axis,
    CompensatedInverse,
    Corrections,
    Errors,
    InverseSolutions,
    Machine,
    PoseModel,
    Poses,
    __version__,
    inverse,
    nominal_poses,
    set_threads,
    threads,
)
from ._errors import InputError, Stopped

__all__ = [
    "CORRECTION_STATUSES",
    "Axis",
    "CompensatedInverse",
    "Corrections",
    "Errors",
    "InputError",
    "InverseSolutions",
    "Machine",
    "PoseModel",
    "Poses",
    "Stopped",
    "__version__",
    "inverse",
    "nominal_poses",
    "set_threads",
    "threads",
]
