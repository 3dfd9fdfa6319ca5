#!/usr/bin/python3
"""The hidden machine over five days: what its thermometers and a laser tracker on its table record.

Usage: campaign.py FOLDER [SEED]

Writes readings.csv (tracker, training days), temperatures.csv (from the first day to the end of the training days),
unseen.csv (the same thermometers from the evening before the unseen day to its end) and truth.npz, which only the
judge (judge.py) opens. The identification sees the first two files.
"""
import pathlib
import sys

import numpy as np
from days import LEAD, TRAINED, TRAVEL, UNSEEN, Days
from hidden_mill import LEAST_DIGIT_K, NOISE_K, SENSORS, simulate
from hidden_pose import Geometry, HiddenPoses, rotation

RUN_UP_H = 6  # LinuxCNC is switched on so long before the unseen day, so that lags have forgotten their start
CYCLE_H, POSES = 1 / 6, 3  # every ten minutes the tracker measures three poses
READING_S = 4
REFLECTORS = {"S1": (60, 0, -120), "S2": (-30, 55, -60), "S3": (-40, -50, -90)}  # mm from the gauge point
STATION_MM, STATION_DEG = (-420.0, -260.0, 350.0), (0.02, -0.03, 25.0)  # on the table, workpiece frame
RANGE_MM, RANGE_PER_MM, ANGLE = 2e-3, 0.5e-6, 2 / 3600  # standard deviations: mm, mm/mm; degrees across the beam


def random_commands(count, generator):
    low, high = np.array(TRAVEL).T
    return np.round(low + (high - low) * generator.random((count, 3)), 3)


def tracker_readings(machine, generator):
    """Rows: X Y Z (mm), range (mm), azimuth, elevation (deg), time (s), reflector."""
    cycles = np.arange(TRAINED[0], TRAINED[1], CYCLE_H) + CYCLE_H / 2
    commands = random_commands(POSES * cycles.size, generator)
    poses = np.repeat(cycles, POSES) + np.tile(np.arange(POSES) * len(REFLECTORS) * READING_S / 3600, cycles.size)
    rows = []
    for number, (name, offset) in enumerate(REFLECTORS.items()):
        hours = poses + number * READING_S / 3600
        points = machine.point_in_workpiece(hours, commands, np.array(offset, float)) - STATION_MM
        x, y, z = (points @ rotation(np.radians([STATION_DEG]))[0]).T
        distance = np.sqrt(x * x + y * y + z * z)
        level = np.hypot(x, y)
        azimuth = np.degrees(np.arctan2(y, x)) + ANGLE * distance / level * generator.normal(size=x.size)
        elevation = np.degrees(np.arctan2(z, level)) + ANGLE * generator.normal(size=x.size)
        distance += (RANGE_MM + RANGE_PER_MM * distance) * generator.normal(size=x.size)
        rows += [(*c, d, a, e, 3600 * h, name)
                 for c, d, a, e, h in zip(commands, distance, azimuth, elevation, hours)]
    return sorted(rows, key=lambda row: row[6])


def write_readings(path, rows):
    with open(path, "w", encoding="ascii") as file:
        file.write("X_mm,Y_mm,Z_mm,range_mm,azimuth_deg,elevation_deg,time_s,reflector\n")
        for x, y, z, distance, azimuth, elevation, time, name in rows:
            file.write(f"{x:.3f},{y:.3f},{z:.3f},{distance:.6f},{azimuth:.8f},{elevation:.8f},{time:.1f},{name}\n")


def write_temperatures(path, minutes, values):
    with open(path, "w", encoding="ascii") as file:
        file.write("time_min," + ",".join(f"{name}_degC" for name in SENSORS) + "\n")
        for minute, row in zip(minutes, values):
            file.write(f"{minute}," + ",".join(f"{value:.4f}" for value in row) + "\n")


def main():
    folder, seed = pathlib.Path(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 1
    generator = np.random.default_rng([seed, 2])
    hours, sensors, deformations = simulate(Days(seed))
    machine = HiddenPoses(hours, deformations, Geometry(seed))
    seen = sensors + NOISE_K * generator.normal(size=sensors.shape)
    seen = LEAST_DIGIT_K * np.round(seen / LEAST_DIGIT_K)
    minutes = np.round(60 * hours).astype(int)
    for name, low, high in (("temperatures", LEAD[0], TRAINED[1]), ("unseen", UNSEEN[0] - RUN_UP_H, UNSEEN[1])):
        of = (hours >= low) & (hours <= high)
        write_temperatures(folder / f"{name}.csv", minutes[of], seen[of])
    readings = tracker_readings(machine, generator)
    write_readings(folder / "readings.csv", readings)
    np.savez(folder / "truth.npz", hours=hours, deformations=deformations, seed=seed)
    print(f"{len(readings)} readings on {len(readings) // 3} poses in {TRAINED[1] - TRAINED[0]} h; {len(SENSORS)} "
          "thermometers, a value a minute")


if __name__ == "__main__":
    main()
