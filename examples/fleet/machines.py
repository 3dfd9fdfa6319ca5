"""What really happens to the simulated machines: start, drift, temperature, crash and wear, by number and seed."""

from __future__ import annotations

import datetime
from dataclasses import dataclass
from pathlib import Path

import abbe
import numpy as np

MACHINE = Path(__file__).resolve().parent.parent / "machines" / "three-axis-mill.machine.toml"
FIRST_DAY = datetime.date(2026, 1, 5)
EXPANSION_UM_PER_M_K = 11.5
TEMPERATURE_K = 0.2         # from campaign to campaign, standard deviation
HALF_MM = {"X": 380.0, "Y": 220.0, "Z": 230.0}
SCALES = ["EXX", "EYY", "EZZ"]
BENDS = ["EYX", "EZX", "EXY", "EZY", "EXZ", "EYZ", "EXX", "EYY", "EZZ"]
SQUARES = ["EC0Y", "EA0Z", "EB0Z"]

# The errors that move: name, unit, standard deviation at the start, of the drift in a day.
WEEK = 7 ** 0.5
MOVING = ([(f"scale {name[2]}", "um/m", 4.0, 0.4 / WEEK) for name in SCALES]
          + [(name, "urad", 4.0, 0.4 / WEEK) for name in SQUARES]
          + [(f"reversal {axis}", "um", 0.5, 0.04 / WEEK) for axis in "XYZ"]
          + [(f"bend {name}", "um", 0.6, 0.04 / WEEK) for name in BENDS])
NAMES = [each[0] for each in MOVING]


@dataclass(frozen=True)
class Event:
    kind: str       # "crash", "ball screw wear", "guideway wear"
    error: str
    day: int        # since the first day
    size: float     # at once, or after 100 days of wear, in the unit of the error


def errors_of(mill: abbe.Machine, values: dict[str, float]) -> abbe.Errors:
    """Errors of the machine from values by name, in the units of MOVING; others are 0."""
    now = dict.fromkeys(NAMES, 0.0) | values
    errors = abbe.Errors(mill)
    for name in SCALES:
        axis = name[2]
        errors.add_motion(name, "legendre",
                          coefficients_um=[0, 1e-3 * HALF_MM[axis] * now[f"scale {axis}"], now[f"bend {name}"]])
    for name in BENDS[:6]:
        errors.add_motion(name, "legendre", coefficients_um=[0, 0, now[f"bend {name}"]])
    for name in SQUARES:
        errors.add_location(name, value_urad=now[name])
    for axis in "XYZ":
        errors.set_reversal(axis, value_um=now[f"reversal {axis}"])
    return errors


class SimulatedMachine:
    """One machine over its days: errors at a day, and its event. The same number and seed give the same machine."""

    def __init__(self, seed: int, number: int, days: int, share_with_event: float) -> None:
        self.number = number
        rng = np.random.default_rng([seed, number, 1])
        start = rng.normal(size=len(MOVING)) * [each[2] for each in MOVING]
        steps = rng.normal(size=(days, len(MOVING))) * [each[3] for each in MOVING]
        self._walk = np.vstack([start, start + np.cumsum(steps, axis=0)])
        self._warmer_K = rng.normal(size=days + 1) * TEMPERATURE_K
        self.event = self._draw_event(rng, days) if rng.random() < share_with_event else None

    @staticmethod
    def _draw_event(rng: np.random.Generator, days: int) -> Event:
        day = int(rng.integers(days // 10, max(days // 10 + 1, days * 3 // 4)))
        sign = float(rng.choice([-1.0, 1.0]))
        kind = rng.choice(["crash", "ball screw wear", "guideway wear"])
        if kind == "crash":
            return Event("crash", str(rng.choice(SQUARES)), day, sign * float(rng.uniform(10, 40)))
        if kind == "ball screw wear":
            return Event("ball screw wear", f"reversal {rng.choice(list('XYZ'))}", day, -float(rng.uniform(2, 6)))
        return Event("guideway wear", f"bend {rng.choice(BENDS[:6])}", day, sign * float(rng.uniform(1.5, 5)))

    def values(self, day: int) -> dict[str, float]:
        """Errors of a day by name, in the units of MOVING."""
        found = dict(zip(NAMES, self._walk[day].tolist()))
        for name in SCALES:
            found[f"scale {name[2]}"] += EXPANSION_UM_PER_M_K * float(self._warmer_K[day])
        if self.event and day >= self.event.day:
            since = (day - self.event.day) / 100
            found[self.event.error] += self.event.size * (1.0 if self.event.kind == "crash" else since * since)
        return found

    def errors(self, mill: abbe.Machine, day: int) -> abbe.Errors:
        """The same as errors of the machine, for the simulation of its readings."""
        return errors_of(mill, self.values(day))

    def truth(self) -> dict[str, object]:
        """What the score is counted against."""
        event = self.event
        return {"machine": self.number, "event": event.kind if event else None, "error": event.error if event else None,
                "day": event.day if event else None, "size": event.size if event else None}
