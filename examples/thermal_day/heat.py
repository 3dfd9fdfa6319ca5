"""Heat in rods and plates by finite volumes, and how rods and plates deform.

Cells exchange heat by conduction with their neighbours and by convection with air; what one cell loses the other gains,
so energy is conserved to rounding. Time steps are explicit; a step that would not be stable is refused. SI units.
"""
import numpy as np

STEEL = {"conductivity": 46.0, "density": 7850.0, "capacity": 470.0, "expansion": 11.5e-6}
CAST_IRON = {"conductivity": 50.0, "density": 7200.0, "capacity": 500.0, "expansion": 10.5e-6}


class Rod:
    """A rod along its axis: cells of equal length; convection at the mantle."""

    def __init__(self, length, area, perimeter, cells, material, start):
        self.material, self.length = material, length
        self.step = length / cells
        self.middle = (np.arange(cells) + 0.5) * self.step
        self.temperature = np.full(cells, float(start))
        self.heat_capacity = material["density"] * material["capacity"] * area * self.step  # J/K of a cell
        self.conductance = material["conductivity"] * area / self.step  # W/K between cells
        self.surface = perimeter * self.step  # m^2 of a cell

    def advance(self, seconds, watts, convection, air):
        """@param watts  into each cell;  convection  W/(m^2 K), one or per cell;  air  degC, one or per cell"""
        t = self.temperature
        if seconds * (2 * self.conductance + np.max(convection) * self.surface) > self.heat_capacity:
            raise ValueError("the time step of the rod is too long")
        flow = self.conductance * np.diff(t)
        gain = watts + convection * self.surface * (air - t)
        gain[:-1] += flow
        gain[1:] -= flow
        self.temperature = t + seconds / self.heat_capacity * gain

    def growth(self, to):
        """Displacement, m, of the point `to` (m from the held end) against the rod at 20 degC."""
        rise = np.concatenate([[0.0], np.cumsum(self.temperature - 20.0) * self.step])
        return self.material["expansion"] * np.interp(to, np.arange(rise.size) * self.step, rise)


class Plate:
    """A wall in the plane of its length and its height; temperature is even across its width.

    Its first index runs along the length, the second one from its lower face to its upper face.
    """

    def __init__(self, length, height, width, cells, material, start, hollow=1.0):
        """@param hollow  part of the volume that is filled: a rib structure conducts and stores so much less"""
        self.material, self.length, self.height = material, length, height
        self.steps = (length / cells[0], height / cells[1])
        self.along = (np.arange(cells[0]) + 0.5) * self.steps[0]
        self.across = (np.arange(cells[1]) + 0.5) * self.steps[1] - height / 2
        self.temperature = np.full(cells, float(start))
        a, b = self.steps
        self.heat_capacity = material["density"] * material["capacity"] * a * b * width * hollow
        self.conductance = [material["conductivity"] * width * hollow * b / a,
                            material["conductivity"] * width * hollow * a / b]
        self.face, self.end, self.side = a * width, b * width, 2 * a * b  # m^2 of a cell

    def advance(self, seconds, watts, convection, air):
        """@param watts  into each cell
        @param convection  W/(m^2 K) at (lower face, upper face, sides, first end, last end)
        @param air  degC there
        """
        t = self.temperature
        if seconds * (2 * sum(self.conductance) + max(convection) * (2 * self.face + self.side)) > self.heat_capacity:
            raise ValueError("the time step of the plate is too long")
        gain = watts + convection[2] * self.side * (air[2] - t)
        along, across = self.conductance[0] * np.diff(t, axis=0), self.conductance[1] * np.diff(t, axis=1)
        gain[:-1] += along
        gain[1:] -= along
        gain[:, :-1] += across
        gain[:, 1:] -= across
        gain[:, 0] += convection[0] * self.face * (air[0] - t[:, 0])
        gain[:, -1] += convection[1] * self.face * (air[1] - t[:, -1])
        gain[0] += convection[3] * self.end * (air[3] - t[0])
        gain[-1] += convection[4] * self.end * (air[4] - t[-1])
        self.temperature = t + seconds / self.heat_capacity * gain

    def deformation(self):
        """Of the free beam whose cross-sections stay plane (Boley and Weiner, Theory of thermal stresses, 1960, 10.2).

        @return  at the ends of the cells: growth along the length, slope, deflection towards the upper face; m, rad, m
        """
        rise = self.temperature - 20.0
        expansion = self.material["expansion"]
        axial = expansion * rise.mean(axis=1)
        # The plane that is left by alpha T (least squares over the height): warm above bends the ends down.
        curvature = -expansion * (rise @ self.across) / np.sum(self.across**2)
        step = self.steps[0]
        growth = np.concatenate([[0.0], np.cumsum(axial) * step])
        slope = np.concatenate([[0.0], np.cumsum(curvature) * step])
        deflection = np.concatenate([[0.0], np.cumsum(slope[:-1] * step + curvature * step**2 / 2)])
        return growth, slope, deflection

    def at(self, values, place):
        """A value of deformation() at a place along the length, m."""
        return np.interp(place, np.arange(values.size) * self.steps[0], values)
