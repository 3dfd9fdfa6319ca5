"""Alarms against the simulated truth: false alarms, detected events and delays. Only here is the truth read."""

from __future__ import annotations

import math
from statistics import median
from typing import Any

from campaigns import KINDS, Kind
from control import binomial_interval, false_alarm
from shards import Settings


def alarm_of(row: dict[str, Any]) -> dict[str, Any] | None:
    """The first alarm of a machine, whichever kind of campaign raised it."""
    found = [{**row[kind.name]["alarm"], "kind": kind.name} for kind in KINDS if row[kind.name]["alarm"]]
    for alarm in found:
        if alarm["error"].startswith("reversal_"):  # the tool stands so far apart after approaches from both sides
            alarm["at_tool_um"] = abs(alarm["change"])
    return min(found, key=lambda alarm: alarm["day"]) if found else None


def expected_share(settings: Settings) -> tuple[float, float]:
    """Bounds of the probability of a false alarm over the weeks. Each chart's is exact. Both follow one machine and so
    depend on each other: together it lies between the larger one and the sum."""
    each = [false_alarm(len(kind.followed), len(kind.days(settings.weeks)) - 1, settings.weight, settings.limit(kind))
            for kind in KINDS if len(kind.days(settings.weeks)) > 1]
    return max(each), sum(each)


def mean_squares(kind: Kind, charts: list[dict[str, Any]]) -> dict[str, Any] | None:
    """Of the innovations, by error and of all; each is 1 if drift, scatter and uncertainties are as stated. An error's
    is that beside the errors before it. All together say less: one that is too large hides one that is too small."""
    count = sum(len(one["lengths"]) for one in charts)
    if count == 0:
        return None
    each = [sum(sums) / count for sums in zip(*(one["squares"] for one in charts))]
    return {"all": sum(each) / len(each), "by_error": dict(zip(kind.followed, each)),
            "standard_deviation": math.sqrt(2 / count)}


def score_fleet(settings: Settings, rows: list[dict[str, Any]], truth: list[dict[str, Any]]) -> dict[str, Any]:
    known = {row["machine"]: row for row in truth}
    quiet = [row for row in rows if known[row["machine"]]["event"] is None]
    false = [row for row in quiet if alarm_of(row)]
    low, high = binomial_interval(len(false), len(quiet))
    expected_low, expected_high = expected_share(settings)
    events: dict[str, dict[str, Any]] = {}
    before_event = 0
    for row in rows:
        event = known[row["machine"]]
        if event["event"] is None:
            continue
        one = events.setdefault(event["event"], {"machines": 0, "detected": 0, "undetected": 0, "before": 0,
                                                 "delays_days": []})
        one["machines"] += 1
        alarm = alarm_of(row)
        if alarm is None:
            one["undetected"] += 1
        elif alarm["day"] < event["day"]:
            one["before"] += 1
            before_event += 1
        else:
            one["detected"] += 1
            one["delays_days"].append(alarm["day"] - event["day"])
    for one in events.values():
        one["delays_days"].sort()
        one["median_days"] = median(one["delays_days"]) if one["delays_days"] else None
    return {
        "alarms": sum(alarm_of(row) is not None for row in rows), "before_event": before_event,
        "false_alarms": {"machines": len(false), "of": len(quiet), "share": len(false) / len(quiet) if quiet else 0,
                         "interval": [low, high], "expected_at_least": expected_low, "expected": expected_high,
                         "years": len(quiet) * settings.weeks / 52},
        "by_kind": {kind.name: {"machines": sum(row[kind.name]["alarm"] is not None for row in quiet),
                                "limit": settings.limit(kind), "followed": len(kind.followed)} for kind in KINDS},
        "mean_square_of_innovations": {kind.name: mean_squares(kind, [row[kind.name] for row in quiet])
                                       for kind in KINDS},
        "events": dict(sorted(events.items())),
    }
