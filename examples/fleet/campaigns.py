"""Campaigns of one machine: simulated readings, their identification, and the history that keeps them."""

from __future__ import annotations

import copy
import datetime
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import abbe
import numpy as np
from machines import (EXPANSION_UM_PER_M_K, FIRST_DAY, MOVING, NAMES, TEMPERATURE_K, SimulatedMachine,
                      errors_of)

RADIUS_MM = 150.0
STRAIGHTNESS = ["EYX", "EZX", "EXY", "EZY", "EXZ", "EYZ"]


def _circle(plane: str, first: float, last: float, points: int) -> dict[str, Any]:
    return {"kind": "circle", "plane": list(plane), "radius_mm": RADIUS_MM, "from_deg": first, "to_deg": last,
            "points": points, "repeats": 2, "there_and_back": True}


# The bar is calibrated before every test. The tracker's station creeps on the table: a drift of its set-up.
BALL_BAR = {
    "threads": 1, "simulate": {"interval_s": 1, "generator": {"mean_volumetric_um": 1}}, "report": {"page": False},
    "setup": [{
        "name": "bar", "instrument": "ball-bar", "spindle_ball_mm": [0, 0, -120], "noise": {"length_um": 0.4},
        "length_deviation_um": 0, "length_deviation_standard_uncertainty_um": 0.3,
        "ball": [{"name": "table", "centre_mm": [0, 0, 150]}],
        "plan": [_circle("XY", 0, 360, 37), _circle("YZ", -10, 190, 21), _circle("XZ", -10, 190, 21)]}],
    "identify": {"held_out_fraction": 0, "locations": ["EC0Y", "EA0Z", "EB0Z"], "reversals": ["X", "Y", "Z"],
                 "motion": [{"errors": ["EXX", "EYY", "EZZ"], "basis": "legendre", "order": 1}]},
}
TRACKER = {
    "threads": 1, "simulate": {"interval_s": 5, "generator": {"mean_volumetric_um": 1}}, "report": {"page": False},
    "setup": [{
        "name": "tracker", "instrument": "tracker", "measure": "range-angles",
        "noise": {"range_um": 0.5, "range_um_per_m": 0.3, "angle_arcsec": 0.15},
        "drift": {"components": ["x", "y", "z"], "degree": 1, "true": {}},
        "station": [{"name": "table", "pose": {"position_mm": [600, -400, 100], "angles_deg": [0, 0, 135]},
                     "true_pose": {"position_mm": [600.4, -400.2, 100.1], "angles_deg": [0.1, 0, 135.2]}}],
        "reflector": [{"name": "spindle", "offset_mm": [0, 0, -120]}],
        "plan": [{"kind": "grid", "axis": {"X": {"count": 5}, "Y": {"count": 4}, "Z": {"count": 4}}}]}],
    "identify": {"held_out_fraction": 0, "locations": ["EC0Y", "EA0Z", "EB0Z"], "reversals": [],
                 "motion": [{"errors": ["EXX", "EYY", "EZZ", *STRAIGHTNESS], "basis": "legendre", "order": 2}]},
}


@dataclass(frozen=True)
class Kind:
    """A kind of campaign: its study, when it is due, and which estimates are followed."""

    name: str
    study: dict[str, Any]
    first: int
    every: int
    followed: tuple[str, ...]

    def days(self, weeks: int) -> list[int]:
        return list(range(self.first, 7 * weeks, self.every))

    def seed(self, settings_seed: int, machine: int, day: int) -> int:
        return int(np.random.SeedSequence([settings_seed, machine, day, self.every]).generate_state(1)[0])


KINDS = (
    Kind("ball-bar", BALL_BAR, 0, 7, ("EXX[P1]", "EYY[P1]", "EZZ[P1]", "EC0Y", "EA0Z", "EB0Z", "reversal_X",
                                      "reversal_Y", "reversal_Z")),
    Kind("tracker", TRACKER, 2, 28, ("EXX[P1]", "EYY[P1]", "EZZ[P1]", "EC0Y", "EA0Z", "EB0Z",
                                     *(f"{name}[P2]" for name in ("EXX", "EYY", "EZZ", *STRAIGHTNESS)))),
)


def day_of(date: datetime.date) -> int:
    return (date - FIRST_DAY).days


def measured_only(study: dict[str, Any]) -> dict[str, Any]:
    """The study without anything of the simulation: what an identification is allowed to know."""
    document = copy.deepcopy(study)
    del document["simulate"]
    for setup in document["setup"]:
        del setup["plan"]
        setup.get("drift", {}).pop("true", None)
        for station in setup.get("station", []):
            station.pop("true_pose", None)
    return document


def measure(mill: abbe.Machine, kind: Kind, truth: abbe.Errors, seed: int) -> dict[str, abbe.Readings]:
    document = copy.deepcopy(kind.study)
    document["seed"] = seed
    rng = np.random.default_rng(seed)
    for setup in document["setup"]:
        if "drift" in setup:
            setup["drift"]["true"] = {f"{axis}_um": [float(rng.normal() * 2)] for axis in "xyz"}
    return abbe.Study(mill, document).gather(truth=truth)


@dataclass
class Times:
    """Seconds of the processor, which do not depend on what else the computer does."""

    measure_s: float = 0
    identify_s: float = 0
    history_s: float = 0
    judge_s: float = 0
    campaigns: int = 0


def add_missing(mill: abbe.Machine, kind: Kind, machine: SimulatedMachine, path: Path, weeks: int, seed: int,
                times: Times) -> abbe.History:
    """Measures and identifies the campaigns that the history does not have, and adds them all at once.

    A campaign is known by its machine (the file) and its day. Whoever comes second finds it there or is refused by the
    history, since the same readings give the same errors; then he looks again."""
    study = abbe.Study(mill, measured_only(kind.study), name=kind.name)
    history = abbe.History(path)
    for attempt in range(3):
        # A job that is killed while it makes the file leaves it empty.
        begun = path.exists() and path.stat().st_size > 0
        there = {day_of(one.date) for one in history.campaigns()} if begun else set()
        missing = [day for day in kind.days(weeks) if day not in there]
        if not missing:
            break
        found = []
        for day in missing:
            begin = time.process_time()
            readings = measure(mill, kind, machine.errors(mill, day), kind.seed(seed, machine.number, day))
            times.measure_s += time.process_time() - begin
            begin = time.process_time()
            result = study.run(readings, map=False, advice=False)
            times.identify_s += time.process_time() - begin
            if not result.usable:
                raise RuntimeError(f"machine {machine.number}, {kind.name}, day {day}: {result.message}")
            found.append(result.errors)
        dates = [FIRST_DAY + datetime.timedelta(day) for day in missing]
        begin = time.process_time()
        try:
            history.add(found, dates, names=[f"{kind.name} {date}" for date in dates])
            times.campaigns += len(found)
        except abbe.InputError:
            if attempt == 2:
                raise
        times.history_s += time.process_time() - begin
    return history


def half_ranges_mm(errors: abbe.Errors) -> dict[str, float]:
    """Half the range of every error motion by name, from the text of the errors."""
    found, name, start = {}, "", 0.0
    for line in errors.text().splitlines():
        key, _, value = line.partition(" = ")
        if key == "name":
            name = value.strip('"')
        elif key == "from_mm":
            start = float(value)
        elif key == "to_mm":
            found[name] = (float(value) - start) / 2
    return found


def followed_of(kind: Kind, errors: abbe.Errors) -> tuple[np.ndarray, np.ndarray]:
    """Values [p] that are followed, and their covariance.

    A coefficient P1 is the scale times half the range that was measured, which differs from axis to axis and from one
    instrument to another. So the scale itself is followed, in mm/mm."""
    half = half_ranges_mm(errors)
    at = [errors.names.index(name) for name in kind.followed]
    factor = np.array([1 / half[name[:3]] if name.endswith("[P1]") else 1.0 for name in kind.followed])
    return factor * errors.values_mm_rad[at], np.outer(factor, factor) * errors.covariance[np.ix_(at, at)]


_responses: dict[str, np.ndarray] = {}


def responses(mill: abbe.Machine, kind: Kind) -> np.ndarray:
    """Change of the followed values by a unit of each error of MOVING, [p, errors], from simulated campaigns.

    An instrument also sees errors that its study does not identify: to a ball bar a bend of Z about the middle of its
    travel is a squareness. They drift too. Equal noise cancels in the differences."""
    if kind.name not in _responses:
        study = abbe.Study(mill, measured_only(kind.study), name=kind.name)

        def found(values: dict[str, float]) -> np.ndarray:
            readings = measure(mill, kind, errors_of(mill, values), seed=1)
            return followed_of(kind, study.run(readings, map=False, advice=False).errors)[0]
        size, start = 5.0, found({})
        _responses[kind.name] = np.array([(found({name: size}) - start) / size for name in NAMES]).T
    return _responses[kind.name]


def scatter_covariance(mill: abbe.Machine, kind: Kind) -> np.ndarray:
    """What varies between campaigns beside the noise: the temperature, which makes all scales longer together."""
    longer = np.array([name.startswith("scale") for name in NAMES]) * EXPANSION_UM_PER_M_K * TEMPERATURE_K
    along = responses(mill, kind) @ longer
    return np.outer(along, along)


def drift_covariance(mill: abbe.Machine, kind: Kind) -> np.ndarray:
    """Normal drift of the followed values in a day, as the maker of such machines states it of every error."""
    root = responses(mill, kind) * [each[3] for each in MOVING]
    return root @ root.T


def followed_values(mill: abbe.Machine, kind: Kind,
                    campaigns: list[abbe.HistoryCampaign]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Days [n], values [n, p] and covariances [n, p, p] of the campaigns, from the history alone."""
    found = [followed_of(kind, one.errors) for one in campaigns]
    scatter = scatter_covariance(mill, kind)
    return (np.array([day_of(one.date) for one in campaigns]), np.array([value for value, _ in found]),
            np.array([covariance + scatter for _, covariance in found]))
