"""How far a driver's speed fluctuates over a cycle at constant effort, by the energy of all that moves."""

from __future__ import annotations

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.dynamics.drives.course_quadrature import Pieces, integrals
from compoundkin.dynamics.drives.driver_course import DriverCourse
from compoundkin.dynamics.work.equivalent_inertia import equivalent_inertia
from compoundkin.kinematics.extremes import between

# Energies are known at so many places a pose; between them parabolas find the extremes.
PARTS = 8
# Halvings of the bracket in which the mean speed is found.
HALVINGS = 60


class SpeedFluctuation:
    """The speed of a driver with constant effort, over a cycle of one design.

    Half of the inertia times the squared speed is the energy of the surplus and what the parts have at the mean speed.
    Loads are taken as they are at the mean speed. Infinite where the machine would stop within the cycle.
    """

    def __init__(self, course: DriverCourse, design: int, mean: float, speed: float) -> None:
        self.speed = speed
        pieces = _fine(course.pieces, design)
        self.energy = np.cumsum(integrals(course.surplus(mean), pieces)[0]) / course.units.inertia
        self.inertia = np.zeros(len(pieces))
        if course.motion.mechanism.masses:
            found = equivalent_inertia(between(course.motion, np.full(len(pieces), design), pieces.high, 2))
            k = found.drivers.index(course.driver)
            self.inertia = found.matrix[:, k, k]
        if not course.forces.inertia:  # the surplus has what the parts lend at constant speed too
            self.energy -= 0.5 * speed**2 * (self.inertia - self.inertia[-1])

    def coefficient(self, flywheel: float) -> float:
        """Return the coefficient of fluctuation with a flywheel of some inertia."""
        total = self.inertia + flywheel
        if not np.all(total > 0.0):
            return np.inf
        # how much the squared speed gains from the energy lent; and from any energy that is there throughout
        lent, more = 2.0 * self.energy / total, float(np.max(total)) / total
        greatest = self.speed**2 + float(np.max(np.abs(lent)))
        least = -greatest
        for _ in range(HALVINGS):
            middle = 0.5 * (least + greatest)
            slowest, fastest = _speeds(self.speed**2 + lent + middle * more)
            least, greatest = (middle, greatest) if slowest + fastest < 2.0 * self.speed else (least, middle)
        return (fastest - slowest) / self.speed if slowest > 0.0 else np.inf


def _speeds(squares: Number) -> tuple[float, float]:
    """Return the roots of the least and of the greatest of values on a closed cycle, between them too."""
    found = []
    for sign in (-1.0, 1.0):
        values = sign * squares
        k = int(np.argmax(values))
        before, here, after = values[k - 1], values[k], values[(k + 1) % len(values)]
        bend = before - 2.0 * here + after
        top = here - (after - before) ** 2 / (8.0 * bend) if bend < 0.0 else here
        found.append(float(np.sqrt(max(sign * top, 0.0))))
    return found[0], found[1]


def _fine(pieces: Pieces, design: int) -> Pieces:
    """Return the pieces of a design, each cut into equal parts."""
    mine = pieces.design == design
    low, high = pieces.low[mine, None], pieces.high[mine, None]
    ends = low + (high - low) * np.linspace(0.0, 1.0, PARTS + 1)
    count = np.count_nonzero(mine) * PARTS
    return Pieces(np.full(count, design), ends[:, :-1].ravel(), ends[:, 1:].ravel())
