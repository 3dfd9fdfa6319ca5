"""What happens on the days: hall air, doors, programs of the machine. Hours count from midnight of the first day."""
import math
from dataclasses import dataclass

import numpy as np

DAYS = 5
LEAD, TRAINED, UNSEEN = (0, 24), (24, 96), (96, 120)  # h: records only; readings for the identification; verification


@dataclass
class Job:
    """A program: from, to (h), speed of the spindle (part of the largest), mean feed (m/min), stroke (mm) of X Y Z."""
    start: float
    end: float
    speed: float
    feed: tuple
    stroke: tuple


@dataclass
class Door:
    """Open from, to (h), and how far the air by the machine falls, K."""
    start: float
    end: float
    fall: float


TRAVEL = ((0.0, 760.0), (0.0, 440.0), (-460.0, 0.0))


def jobs_of(day, generator, load):
    """Programs of two shifts with breaks. @param load  factor of speeds and feeds of the day"""
    jobs, hour = [], 24 * day + 6 + 0.5 * generator.random()
    while hour < 24 * day + 21.5:
        duration = generator.uniform(0.4, 1.8)
        speed = min(1.0, load * generator.uniform(0.2, 1.0))
        feed = tuple(load * generator.uniform(low, high) for low, high in ((1, 7), (1, 6), (0.5, 4)))
        stroke = []
        for low, high in TRAVEL:
            span = (high - low) * generator.uniform(0.3, 0.9)
            middle = generator.uniform(low + span / 2, high - span / 2)
            stroke.append((middle - span / 2, middle + span / 2))
        jobs.append(Job(hour, min(hour + duration, 24 * day + 22), speed, feed, tuple(stroke)))
        hour += duration + (generator.uniform(0.1, 0.3) if generator.random() < 0.75 else generator.uniform(0.6, 1.5))
    return jobs


def doors_of(day, generator, coldness):
    """Deliveries: the door is open for 5 to 25 minutes."""
    doors = []
    for hour in sorted(generator.uniform(6.2, 20.5, size=generator.integers(4, 7))):
        doors.append(Door(24 * day + hour, 24 * day + hour + generator.uniform(5, 25) / 60,
                          coldness * generator.uniform(0.6, 1.2)))
    return doors


class Days:
    """Five days. The last one, which the identification has not seen, has other programs, doors and weather."""

    def __init__(self, seed=11):
        generator = np.random.default_rng(seed)
        loads, coldness = (0.9, 0.75, 1.0, 0.85, 0.9), (4.0, 3.5, 5.0, 4.5, 5.0)
        self.jobs = [job for day in range(DAYS) for job in jobs_of(day, generator, loads[day])]
        self.doors = [door for day in range(DAYS) for door in doors_of(day, generator, coldness[day])]
        # Mean of the hall and its swing by day, K
        self.mean, self.swing = (20.3, 20.8, 20.0, 21.2, 21.0), (1.6, 2.2, 1.8, 1.4, 2.4)

    def job(self, hour):
        return next((job for job in self.jobs if job.start <= hour < job.end), None)

    def open_door(self, hour):
        return next((door for door in self.doors if door.start <= hour < door.end), None)

    def hall(self, hour):
        """Air of the hall without doors: coolest at five, warmest at five in the afternoon; heating by night lower."""
        day = hour / 24 - 0.5
        nearest = np.arange(DAYS)
        mean, swing = np.interp(day, nearest, self.mean), np.interp(day, nearest, self.swing)
        return mean - swing * math.cos(2 * math.pi * (hour - 5) / 24) + 0.3 * math.sin(4 * math.pi * (hour - 2) / 24)


class DoorAir:
    """How far doors have cooled the air: towards the fall while one is open, and exponential recovery."""

    def __init__(self, opening_s=150, recovery_s=1500, far_part=0.55, far_s=600):
        self.opening_s, self.recovery_s, self.far_part, self.far_s = opening_s, recovery_s, far_part, far_s
        self.near = self.far = 0.0

    def advance(self, seconds, door):
        target, time = (-door.fall, self.opening_s) if door else (0.0, self.recovery_s)
        self.near += (target - self.near) * -math.expm1(-seconds / time)
        self.far += (self.far_part * self.near - self.far) * -math.expm1(-seconds / self.far_s)
