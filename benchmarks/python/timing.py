"""Times of what is compared, in turn: all share the machine's good and bad moments, and the shortest of several counts."""

from __future__ import annotations

import gc
import os
import time
from collections.abc import Callable, Mapping
from typing import NamedTuple


class Time(NamedTuple):
    """s by the clock, and s of the processor, summed over threads: other programs add little to the second."""

    clock: float
    processor: float

    def per(self, count: float) -> Time:
        return Time(self.clock / count, self.processor / count)


def seconds(call: Callable[[], object], calls: int = 1) -> Time:
    """Per call, without the collection of garbage in between."""
    gc.collect()
    gc.disable()
    try:
        start, processor = time.perf_counter(), time.process_time()
        for _ in range(calls):
            call()
        return Time(time.perf_counter() - start, time.process_time() - processor).per(calls)
    finally:
        gc.enable()


def in_turn(measures: Mapping[str, Callable[[], Time]], repetitions: int) -> dict[str, Time]:
    """The shortest of the times that each measure gives, all measures in turn, first one way round and then the other."""
    found: dict[str, list[Time]] = {name: [] for name in measures}
    for repetition in range(repetitions):
        for name in list(measures)[:: 1 if repetition % 2 == 0 else -1]:
            found[name].append(measures[name]())
    return {name: shortest(times) for name, times in found.items()}


def shortest(times: list[Time]) -> Time:
    return Time(min(time.clock for time in times), min(time.processor for time in times))


def load() -> float:
    """Programs that wanted the processor in the last minute."""
    return os.getloadavg()[0]
