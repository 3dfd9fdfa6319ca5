"""A shard of machines: the unit of work of a task of Dask or Slurm, and its result file."""

from __future__ import annotations

import json
import math
import os
import time
import uuid
import warnings
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import abbe
from campaigns import KINDS, Kind, Times, add_missing, drift_covariance, followed_values
from control import averages, first_alarm, innovations, limit_for
from machines import MACHINE, SimulatedMachine


@dataclass(frozen=True)
class Settings:
    """What the results depend on; a folder belongs to one of them."""

    machines: int = 2000
    weeks: int = 52
    shard: int = 20
    seed: int = 1
    share_with_event: float = 0.2
    weight: float = 0.25            # of the newest innovation in the average
    false_alarms: float = 0.02      # probability per machine and year that is spent, in equal parts on the kinds

    def shards(self) -> list[int]:
        return list(range(math.ceil(self.machines / self.shard)))

    def numbers(self, shard: int) -> range:
        return range(shard * self.shard + 1, min((shard + 1) * self.shard, self.machines) + 1)

    def limit(self, kind: Kind) -> float:
        """So that the kinds together spend the probability of false alarms of these weeks."""
        count = len(kind.days(self.weeks)) - 1
        share = self.false_alarms * self.weeks / 52 / len(KINDS)
        return limit_for(len(kind.followed), count, self.weight, share) if count > 0 else 0.0


def write_atomically(path: Path, text: str) -> None:
    """Whole or not at all; two writers of the same path do not meet, the last one stays."""
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(f".{path.name}.{uuid.uuid4().hex}")
    part.write_text(text, encoding="utf-8")
    os.replace(part, path)


def json_text(value: Any) -> str:
    return json.dumps(value, indent=1, sort_keys=True) + "\n"


def claim(folder: Path, settings: Settings) -> None:
    """The folder belongs to these settings. Another job with the same may share it; one with others is refused."""
    folder.mkdir(parents=True, exist_ok=True)
    path, text = folder / "fleet.json", json_text(asdict(settings))
    part = folder / f".fleet.{uuid.uuid4().hex}"
    part.write_text(text, encoding="utf-8")
    try:
        os.link(part, path)  # fails if it is there, also on a network file system
    except FileExistsError:
        if path.read_text(encoding="utf-8") != text:
            raise SystemExit(f"fleet: {path} is of another fleet; expected the same machines, weeks, shard, seed and "
                             "share, or another folder") from None
    finally:
        part.unlink()


def shard_path(folder: Path, shard: int) -> Path:
    return folder / "shards" / f"shard-{shard:04}.json"


def judge(settings: Settings, mill: abbe.Machine, kind: Kind, history: abbe.History) -> dict[str, Any]:
    """The control chart of one history, and what changed at its first alarm. Nothing but the history is read."""
    campaigns = history.campaigns()
    days, values, covariances = followed_values(mill, kind, campaigns)
    z = innovations(values, covariances, drift_covariance(mill, kind), days)
    lengths, limit = averages(z, settings.weight), settings.limit(kind)
    found: dict[str, Any] = {
        "campaigns": len(campaigns), "days": sorted(set(days.tolist())),
        "lengths": [round(x, 6) for x in lengths.tolist()],
        "limit": round(limit, 6), "squares": [round(x, 6) for x in (z * z).sum(axis=0).tolist()],
        "alarm": None}
    alarm = first_alarm(lengths, limit, len(kind.followed))
    if alarm:
        pair = abbe.compare([campaigns[alarm.before].errors, campaigns[alarm.campaign].errors]).pairs[0]
        worst = max((error for error in pair.errors if (error.expanded_uncertainty_mm_rad or 0) > 0),
                    key=lambda error: abs(error.change_mm_rad) / error.expanded_uncertainty_mm_rad)
        to_um = 1e6 if worst.is_angle else 1e3
        found["alarm"] = {
            "day": int(days[alarm.campaign]), "since": int(days[alarm.before]),
            "error": worst.name, "words": worst.words,
            "unit": "urad" if worst.is_angle else "um", "change": round(worst.change_mm_rad * to_um, 4),
            "expanded_uncertainty": round(worst.expanded_uncertainty_mm_rad * to_um, 4),
            "at_tool_um": round(worst.at_tool_mm * 1e3, 4)}
    return found


def do_shard(folder: Path, settings: Settings, shard: int) -> int:
    """Everything of the machines of a shard that is not there yet; returns the campaigns that were added."""
    path = shard_path(folder, shard)
    if path.exists():
        return 0
    abbe.set_threads(1)
    mill = abbe.Machine.read(MACHINE)
    rows, truth, times = [], [], Times()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the marks of the campaigns are in their errors files
        for number in settings.numbers(shard):
            machine = SimulatedMachine(settings.seed, number, 7 * settings.weeks, settings.share_with_event)
            truth.append(machine.truth())
            row: dict[str, Any] = {"machine": number}
            for kind in KINDS:
                history_path = folder / "histories" / kind.name / f"{number:05}.history"
                history_path.parent.mkdir(parents=True, exist_ok=True)
                history = add_missing(mill, kind, machine, history_path, settings.weeks, settings.seed, times)
                begin = time.process_time()
                row[kind.name] = judge(settings, mill, kind, history)
                times.judge_s += time.process_time() - begin
            rows.append(row)
    write_atomically(folder / "truth" / path.name, json_text(truth))  # for the score only
    write_atomically(folder / "times" / path.name, json_text(asdict(times)))
    write_atomically(path, json_text(rows))
    return times.campaigns


def rows_of(path: Path) -> list[dict[str, Any]]:
    """The rows of a file of a shard, or an exit that says which one is damaged and what to do."""
    try:
        rows = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise SystemExit(f"fleet: {path} cannot be read ({error}); remove shards/{path.name} and run the same command "
                         "again: its campaigns are in the histories") from None
    return list(rows)


def gather(folder: Path, settings: Settings) -> list[dict[str, Any]]:
    """The rows of all machines, each once, or an exit that names what is missing or twice."""
    missing = [shard for shard in settings.shards() if not shard_path(folder, shard).exists()]
    if missing:
        raise SystemExit(f"fleet: {len(missing)} of {len(settings.shards())} shards are not done, the first is "
                         f"{missing[0]}; run the same command again")
    rows = [row for shard in settings.shards() for row in rows_of(shard_path(folder, shard))]
    if [row["machine"] for row in rows] != list(range(1, settings.machines + 1)):
        raise SystemExit("fleet: the shards do not hold every machine exactly once")
    for row in rows:
        for kind in KINDS:
            expected = kind.days(settings.weeks)
            if row[kind.name]["days"] != expected or row[kind.name]["campaigns"] != len(expected):
                raise SystemExit(f"fleet: machine {row['machine']}: {row[kind.name]['campaigns']} campaigns with the "
                                 f"{kind.name}, expected {len(expected)}, one on each day that is due")
    return rows
