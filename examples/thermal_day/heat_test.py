#!/usr/bin/env python3
"""Heat and deformation of the hidden machine against solutions in closed form. Exit code 77: there is no NumPy."""
import pathlib
import sys
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
try:
    import numpy as np
    from heat import CAST_IRON, STEEL, Plate, Rod
    from hidden_mill import HiddenMill
    from hidden_pose import TOOL, Geometry, HiddenPoses, nominal
    from identified import lag
except ModuleNotFoundError as missing:
    print("skipped:", missing)
    sys.exit(77)


class RodTest(unittest.TestCase):
    def test_energy_is_conserved(self):
        rod = Rod(1.0, 1e-3, 0.1, 40, STEEL, 20)
        watts = np.zeros(40)
        watts[5] = 30
        for _ in range(500):
            rod.advance(10, watts, 0.0, 20.0)
        stored = (rod.heat_capacity * (rod.temperature - 20)).sum()
        self.assertAlmostEqual(stored / (30 * 5000), 1, delta=1e-12)

    def test_a_fin_reaches_its_steady_state(self):
        # Heat Q into one end of a fin, the other insulated: Q cosh(m (L - x)) / (k A m sinh(m L)); Incropera 3.6.
        length, area, perimeter, convection, heat = 0.8, 1.2e-3, 0.12, 15.0, 20.0
        rod = Rod(length, area, perimeter, 80, STEEL, 20)
        watts = np.zeros(80)
        watts[0] = heat
        for _ in range(11000):
            rod.advance(3.3, watts, convection, 20.0)
        m = np.sqrt(convection * perimeter / (STEEL["conductivity"] * area))
        exact = heat * np.cosh(m * (length - rod.middle)) / (STEEL["conductivity"] * area * m * np.sinh(m * length))
        self.assertLess(np.abs(rod.temperature - 20 - exact).max(), 0.005 * exact.max())

    def test_growth_is_the_integral_of_the_rise(self):
        rod = Rod(0.5, 1e-3, 0.1, 50, STEEL, 20)
        rod.temperature = 20 + 30 * rod.middle  # linear: alpha 30 x^2 / 2
        self.assertAlmostEqual(rod.growth(0.4), STEEL["expansion"] * 15 * 0.16, delta=1e-12)
        self.assertEqual(rod.growth(0.0), 0)

    def test_a_step_that_is_not_stable_is_refused(self):
        rod = Rod(1.0, 1e-3, 0.1, 1000, STEEL, 20)
        with self.assertRaises(ValueError):
            rod.advance(10, np.zeros(1000), 0.0, 20.0)


class PlateTest(unittest.TestCase):
    def plate(self, **options):
        return Plate(1.5, 0.4, 0.5, (30, 8), CAST_IRON, 20, **options)

    def test_even_warmth_makes_it_longer_and_no_more(self):
        plate = self.plate()
        plate.temperature += 3
        growth, slope, deflection = plate.deformation()
        self.assertAlmostEqual(growth[-1], CAST_IRON["expansion"] * 3 * 1.5, delta=1e-15)
        self.assertLess(np.abs(slope).max(), 1e-18)
        self.assertLess(np.abs(deflection).max(), 1e-18)

    def test_a_gradient_bends_it_to_a_circle(self):
        plate = self.plate()
        plate.temperature = plate.temperature + 5 * plate.across / 0.4  # 5 K from face to face, warm above
        growth, slope, deflection = plate.deformation()
        curvature = CAST_IRON["expansion"] * 5 / 0.4
        self.assertAlmostEqual(slope[-1], -curvature * 1.5, delta=1e-15)
        self.assertAlmostEqual(deflection[-1], -curvature * 1.5**2 / 2, delta=1e-15)
        self.assertLess(abs(growth[-1]), 1e-18)

    def test_heat_flows_through_it_as_through_a_wall(self):
        # Steady state of a wall between two airs, without sides: resistances in series; Incropera 3.1.
        plate = self.plate(hollow=0.25)
        for _ in range(25000):
            plate.advance(35, 0.0, (10, 20, 0, 0, 0), (30, 20, 20, 20, 20))
        conductivity = CAST_IRON["conductivity"] * 0.25
        # The outermost cells have their temperature at half a cell from the face that convection sees.
        resistance = 1 / 10 + (0.4 - 0.05) / conductivity + 1 / 20
        flow = 10 / resistance
        self.assertAlmostEqual(plate.temperature[7, 0], 30 - flow / 10, delta=2e-3)
        self.assertAlmostEqual(plate.temperature[7, -1], 20 + flow / 20, delta=2e-3)

    def test_energy_is_conserved(self):
        plate, watts = self.plate(), np.zeros((30, 8))
        watts[3, 2] = 100
        for _ in range(200):
            plate.advance(10, watts, (0, 0, 0, 0, 0), (20,) * 5)
        self.assertAlmostEqual(plate.heat_capacity * (plate.temperature - 20).sum() / (100 * 2000), 1, delta=1e-12)


class PosesTest(unittest.TestCase):
    def without_geometry(self, mill):
        geometry = Geometry()
        geometry.waves = dict.fromkeys(geometry.waves, [(0, 0, 0)])
        geometry.pitch, geometry.squareness = dict.fromkeys("XYZ", (0, 0, 0)), np.zeros(3)
        return HiddenPoses(np.array([0.0, 1.0]), np.stack([mill.deformation()] * 2), geometry)

    def displacement(self, mill, commands):
        offsets = np.broadcast_to(TOOL, commands.shape)
        machine = self.without_geometry(mill)
        return machine.point_in_workpiece(np.zeros(len(commands)), commands, offsets) - nominal(commands, offsets)

    def test_at_20_degrees_there_are_none(self):
        commands = np.array([[10.0, 20, -30], [700, 400, -450]])
        self.assertLess(np.abs(self.displacement(HiddenMill(20.0), commands)).max(), 1e-12)

    def test_even_warmth_is_the_sum_of_growths(self):
        x, y, z = 200.0, 100.0, -300.0
        steel, iron = 2 * STEEL["expansion"], 2 * CAST_IRON["expansion"]
        expected = [-steel * (120 + 760 - x),
                    -iron * 450 + iron * (1250 - (750 - y)) - steel * (120 + 440 - y),
                    iron * 1450 - steel * (100 - z) - steel * 500]
        found = self.displacement(HiddenMill(22.0), np.array([[x, y, z]]))[0]
        self.assertLess(np.abs(found - expected).max(), 1e-9)

    def test_a_column_that_is_warm_in_front_leans_back(self):
        mill = HiddenMill(20.0)
        mill.column.temperature = mill.column.temperature - 2 * mill.column.across / 0.4
        curvature, (x, y, z) = CAST_IRON["expansion"] * 2 / 0.4, (380.0, 220.0, -100.0)
        guide = 950.0  # mm above the bed, which is 300 mm below the table
        slope, lean = curvature * guide / 1e3, curvature * guide**2 / 2e3
        found = self.displacement(mill, np.array([[x, y, z]]))[0]
        # The guide goes back by `lean`. The turn takes what is below it forward, and what is in front of it up.
        below, front = (guide - 300) - (610 - 120 + z), 450.0
        self.assertLess(np.abs(found - [0, lean - slope * below, slope * front]).max(), 1e-4 * lean)


class LagTest(unittest.TestCase):
    def test_a_ramp_is_followed_behind_by_the_time_constant(self):
        seconds = 60.0 * np.arange(600)
        followed = lag(20 + 1e-3 * seconds, 60.0, 1800.0)
        exact = 20 + 1e-3 * (seconds - 1800 * -np.expm1(-seconds / 1800))
        self.assertLess(np.abs(followed - exact).max(), 1e-10)


if __name__ == "__main__":
    unittest.main()
