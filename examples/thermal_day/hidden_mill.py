"""The hidden machine, heat: a vertical mill of rods and plates, its losses, its air and its sensors, over some days."""
import numpy as np
from days import DAYS, DoorAir
from heat import CAST_IRON, STEEL, Plate, Rod

STEP_S = 12
FLOOR = 20.0  # degC under the bed

# Thermometers, in the order of the files: lag of the sensor in its well or in its housing, s.
SENSORS = {"ambient": 60, "spindle": 90, "head": 120, "column": 180, "bed": 180, "nut_x": 120, "nut_y": 120,
           "nut_z": 120, "screw_x": 90, "screw_y": 90}
NOISE_K, LEAST_DIGIT_K = 0.05, 0.0625


class Screw:
    """A ball screw, held at its driven end, with its nut; the nut goes over the stroke of the program."""

    def __init__(self, length, diameter, start, nut_at):
        self.rod = Rod(length, np.pi * diameter**2 / 4, np.pi * diameter, round(length / 0.025), STEEL, start)
        self.nut = float(start)
        self.nut_at = nut_at  # m from the held end, of a command in mm
        self.stroke = None

    def advance(self, seconds, feed, stroke, air):
        """@param feed  mean, m/min;  stroke  (mm, mm)"""
        ends = sorted(self.nut_at(place) for place in stroke)
        inside = (self.rod.middle > ends[0] - 0.03) & (self.rod.middle < ends[1] + 0.03)
        friction, bearing = 2.3 * feed, 1.1 * feed + 0.13 * feed**1.5  # W
        to_screw = 8.0 * (self.nut - self.rod.temperature[inside].mean())
        watts = np.zeros(inside.size)
        watts[inside] += (0.6 * friction + to_screw) / inside.sum()
        watts[:3] += bearing / 3
        self.nut += seconds / 1500 * (0.4 * friction - to_screw + 0.5 * (air - self.nut))
        self.rod.advance(seconds, watts, 9 + 4.5 * feed**0.7, air)
        return friction + bearing


class HiddenMill:
    """Temperatures and deformations. Lengths here in m."""

    def __init__(self, start=20.3):
        self.spindle = Rod(0.5, 0.011, 0.45, 20, STEEL, start)  # from its upper end, where it is held, to its nose
        self.head = Rod(0.45, 0.03, 1.0, 9, CAST_IRON, start)  # from the column to the spindle
        self.column = Plate(1.5, 0.4, 0.5, (30, 8), CAST_IRON, start, hollow=0.25)  # upwards; front to back
        self.bed = Plate(1.6, 0.4, 0.9, (32, 8), CAST_IRON, start, hollow=0.25)  # front to back; upwards
        self.screws = {"X": Screw(1.0, 0.040, start, lambda q: 0.12 + (760 - q) / 1000),
                       "Y": Screw(0.7, 0.036, start, lambda q: 0.12 + (440 - q) / 1000),
                       "Z": Screw(0.75, 0.040, start, lambda q: 0.10 - q / 1000)}
        self.inside = float(start)  # air around table and spindle
        self.doors = DoorAir()
        self.last_stroke = ((380, 400), (220, 240), (-20, 0))
        self.sensor = dict.fromkeys(SENSORS, float(start))

    def advance(self, hour, days, seconds):
        job, hall = days.job(hour), days.hall(hour)
        self.doors.advance(seconds, days.open_door(hour))
        near, far = hall + self.doors.near, hall + self.doors.far
        draught = 1 + 0.15 * abs(self.doors.near)
        speed, feeds = (job.speed, job.feed) if job else (0.0, (0.0, 0.0, 0.0))
        if job:
            self.last_stroke = job.stroke
        warmth = sum(screw.advance(seconds, feed, stroke, self.inside if axis != "Z" else 0.5 * (near + far))
                     for (axis, screw), feed, stroke in zip(self.screws.items(), feeds, self.last_stroke))
        lost, into_column = self.advance_spindle(seconds, speed, near, draught)
        self.advance_structure(seconds, speed, feeds, into_column, near, far, draught)
        cutting = 160 * speed if job else 0.0
        exchange = (0.25 * lost + 0.3 * warmth + cutting + 40 * draught * (near - self.inside)
                    + 8 * (self.bed.temperature[:, -1].mean() - self.inside))
        self.inside += seconds / 20e3 * exchange
        self.advance_sensors(seconds, far)

    def advance_spindle(self, seconds, speed, air, draught):
        """Spindle and head. Losses of bearings and motor, W, and the heat that goes into each cell of the column.

        Viscous friction grows with the power 5/3 of the speed: docs/thermal-day.md.
        """
        front, motor = 19 * speed + 52 * speed**(5 / 3), 30 * speed + 45 * speed**(5 / 3)
        rear = 0.45 * front
        watts = np.zeros(20)
        watts[14:18] += front / 4
        watts[6:8] += rear / 2
        watts[0:6] += motor / 6
        to_head = 0.9 * (self.spindle.temperature[3:17] - self.head.temperature[-3:].mean())
        watts[3:17] -= to_head
        self.spindle.advance(seconds, watts, (10 + 25 * speed) * draught, air)
        head = np.zeros(9)
        head[-3:] += to_head.sum() / 3
        # The guides carry heat into the front of the column, where the head stands.
        middle = 1.05 + 0.0005 * sum(self.last_stroke[2])
        rows = np.abs(self.column.along - middle) < 0.18
        to_column = 22.0 * (self.head.temperature[0] - self.column.temperature[rows, 0].mean())
        head[0] -= to_column
        into_column = np.zeros(self.column.temperature.shape)
        into_column[rows, 0] = to_column / rows.sum()
        self.head.advance(seconds, head, 7 * draught, air)
        return front + rear + motor, into_column

    def advance_structure(self, seconds, speed, feeds, into_column, near, far, draught):
        into_column[-3:, 0] += (2.0 * feeds[2] + 12 * (feeds[2] > 0)) / 3  # motor and bearing of Z
        self.column.advance(seconds, into_column, (7 * draught, 6, 6 * draught, 3, 6),
                            (0.6 * near + 0.4 * self.inside, far, 0.5 * (near + far), FLOOR, far + 0.8))
        into_bed = np.zeros(self.bed.temperature.shape)
        into_bed[6:16, -1] += 3.0 * feeds[1] / 10  # guides of Y
        into_bed[1:4, -1] += (4.0 * feeds[1] + 8 * (feeds[1] > 0)) / 3  # motor and bearing of Y
        into_bed[8:22, -1] += 30 * speed / 14  # chips
        self.bed.advance(seconds, into_bed, (2.5, 9, 5 * draught, 5 * draught, 4),
                         (FLOOR, self.inside, near, near, far))

    def advance_sensors(self, seconds, far):
        seen = {"ambient": far, "spindle": 0.85 * self.spindle.temperature[15] + 0.15 * self.head.temperature[-1],
                "head": self.head.temperature[4], "column": self.column.temperature[5, 0],
                "bed": self.bed.temperature[12, -1]}
        for axis, screw in self.screws.items():
            seen[f"nut_{axis.lower()}"] = screw.nut
            seen[f"screw_{axis.lower()}"] = screw.rod.temperature[:3].mean()  # outer ring of the held bearing
        for name, lag in SENSORS.items():
            self.sensor[name] += (seen[name] - self.sensor[name]) * -np.expm1(-seconds / lag)

    def deformation(self):
        """Numbers from which poses follow: see hidden_pose.py."""
        return np.concatenate([self.column_and_bed(), *(self.screw_growth(axis) for axis in "XYZ"),
                               [self.spindle.growth(0.5), self.head.growth(0.45)]])

    def column_and_bed(self):
        return np.concatenate([*self.column.deformation(), *self.bed.deformation()])

    def screw_growth(self, axis):
        rod = self.screws[axis].rod
        return rod.growth(np.linspace(0, rod.length, rod.middle.size + 1))


def simulate(days):
    """@return  for every minute of all days: time (h), sensor values without noise, deformation"""
    mill, times, sensors, deformations = HiddenMill(), [], [], []
    steps = round(DAYS * 24 * 3600 / STEP_S)
    for step in range(steps + 1):
        hour = step * STEP_S / 3600
        if step * STEP_S % 60 == 0:
            times.append(hour)
            sensors.append(list(mill.sensor.values()))
            deformations.append(mill.deformation())
        mill.advance(hour, days, STEP_S)
    return np.array(times), np.array(sensors), np.array(deformations)
