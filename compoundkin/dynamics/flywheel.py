"""Flywheels: the fluctuation of energy over a cycle at constant effort, and the inertia that limits that of speed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.dynamics.driver_course import (
    NO_MEAN,
    DriverCourse,
    Line,
    Pieces,
    driver_course,
    in_units,
    integrals,
    smooth_pieces,
    texts_of_designs,
)
from compoundkin.dynamics.forces import Forces
from compoundkin.dynamics.mass_motion import equivalent_inertia
from compoundkin.kinematics.extremes import Places, between, zeros
from compoundkin.model.units import ANGULAR_VELOCITY

# A driver whose net travel over a cycle is below this part of its range oscillates.
NO_TRAVEL = 1e-9
# Places of a motion, counted in poses, are equal within this.
ROUNDING = 1e-12


@dataclass(frozen=True, eq=False, repr=False)
class Flywheel(ShortRepr):
    """A flywheel on a driver; arrays of shape (designs,).

    `mean` is the mean effort, `speed` the mean speed, `fluctuation` the greatest fluctuation of energy, `inertia` the
    flywheel's own for the `coefficient` of fluctuation, in units of mass and length (of a slide its mass). The surplus,
    mean effort less effort, changes its sign at the places `crossings`, with the energy `energies` there from the
    beginning of the cycle on: arrays (n,). `without` and `achieved` are the coefficients of fluctuation without and
    with the flywheel by the energy of all that moves, with the parts' own inertia, which the rule leaves out; infinite
    where the machine would stop.
    """

    driver: str
    coefficient: float
    speed: Number
    mean: Number
    fluctuation: Number
    inertia: Number
    crossings: Places
    energies: Number
    without: Number
    achieved: Number

    def text(self) -> str:
        """Return it as text, a block for each design: torques in N m and energies in J as well, angles in degrees."""
        return texts_of_designs(len(self.inertia), self._lines)

    def _lines(self, k: int) -> Iterator[Line]:
        motion = self.crossings.motion
        units, is_angle = motion.mechanism.stated_units, motion.drives[self.driver].is_angle
        effort, own = ("torque", "flywheel") if is_angle else ("thrust", "added mass")
        unit = f"{units.mass} {units.length}^2" if is_angle else units.mass
        speed = ANGULAR_VELOCITY if is_angle else f"{units.length}/s"
        yield (f"driver {self.driver}",)
        yield in_units("mean speed", self.speed[k], speed)
        mean = self.mean[k] if abs(self.mean[k]) > NO_MEAN * self.fluctuation[k] else 0.0
        yield in_units(f"mean {effort}", mean, units.moment if is_angle else units.force)
        for place in np.flatnonzero(self.crossings.design == k).tolist():
            words = f"surplus up to {self.crossings.text(place)}"
            yield in_units(words, self.energies[place], units.moment, energy=True)
        yield in_units("fluctuation of energy", self.fluctuation[k], units.moment, energy=True)
        yield "coefficient of fluctuation", float(self.coefficient)
        yield own, float(self.inertia[k]), unit
        yield "coefficient without it", float(self.without[k])
        yield "coefficient with it and the parts", float(self.achieved[k])


@checked
def flywheel(forces: Forces, fluctuation: float, *, driver: str | None = None) -> Flywheel:
    """Return the flywheel that holds a driver's speed within a coefficient of fluctuation.

    The driver has its mean effort throughout; its surplus of energy over a cycle is integrated between changes of sign,
    between the poses too. The inertia of the parts is in the effort at constant speed, and is not counted again.
    `forces` are of a closed cycle at constant speed. Raises InvalidInput where they are not.

    Source: J = dE / (Cs w^2), e.g. R. L. Norton, Design of Machinery, 5th ed., McGraw-Hill 2012, section 11.11.

    >>> from compoundkin.dynamics.force_analysis import force_analysis
    >>> from compoundkin.kinematics import solve
    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.model.loads.gravity import gravity
    >>> from compoundkin.model.loads.mass import mass
    >>> from compoundkin.model.mechanism import Mechanism
    >>> parts = link("frame", A=0), link("arm", A=0, B=1), drive("arm"), mass("arm", 2, at="B"), gravity(0, -10)
    >>> arm = Mechanism("Arm", *parts, units={"length": "m", "mass": "kg", "force": "N"})
    >>> found = flywheel(force_analysis(solve(arm, speed=10)), 0.05)
    >>> found.fluctuation.round(9), found.inertia.round(9)              # 2 m g r = 40; 40 / (0.05 x 10^2)
    (array([40.]), array([8.]))
    >>> print(found.text().splitlines()[5])
    fluctuation of energy                   40  N m     40  J
    """
    _check_flywheel(fluctuation)
    course = driver_course(forces, driver, of_cycle=True)
    speed = _speed(course)
    mean = course.work / course.travel
    crossings = zeros(course.motion, course.above(mean)).crossings().at
    places, energies = _energies(course, mean, crossings)
    lent = np.array([np.ptp(np.append(energies[places.design == k], 0.0)) for k in range(course.motion.inputs.designs)])
    inertia = lent / (fluctuation * speed**2) / course.units.inertia
    known = (SpeedFluctuation(course, k, mean[k], speed[k]) for k in range(len(mean)))
    both = np.array([[one.coefficient(0.0), one.coefficient(own)] for one, own in zip(known, inertia, strict=True)])
    return Flywheel(course.driver, fluctuation, speed, mean, lent, inertia, places, energies, *both.T)


def _check_flywheel(fluctuation: float) -> None:
    if not 0.0 < fluctuation < np.inf:
        remedy = "a small number above 0, such as 0.02: greatest less least speed over their mean"
        raise InvalidInput(Problem("fluctuation", f"{fluctuation!r} is no coefficient of fluctuation", remedy))


def _speed(course: DriverCourse) -> Number:
    """Return the mean speed of a driver, (designs,)."""
    motion = course.motion
    shape = motion.failed.shape
    if np.any(
        np.abs(course.travel) <= NO_TRAVEL * np.ptp(np.broadcast_to(motion.drives[course.driver].value, motion.shape))
    ):
        raise InvalidInput(Problem(course.driver, "it oscillates over the cycle", "name a driver that turns"))
    if motion.time is not None:
        times = np.broadcast_to(motion.time, motion.shape).reshape(shape)
        return course.travel / (times[:, -1] - times[:, 0])
    rates = np.broadcast_to(motion.drives[course.driver].rate, motion.shape).reshape(shape)
    if np.any(rates == 0.0) or np.any(np.ptp(rates, axis=1) != 0.0):
        raise InvalidInput(Problem(course.driver, "its speed is not constant above 0", "solve(..., speed=...)"))
    return rates[:, 0]


def _energies(course: DriverCourse, mean: Number, crossings: Places) -> tuple[Places, Number]:
    """Return the crossings in order, with the energy of the surplus there from the beginning of the cycle on."""
    pieces = smooth_pieces(course.motion, crossings)
    (found,) = integrals(course.surplus(mean), pieces)
    energies = np.empty(len(crossings.place))
    for k, (design, place) in enumerate(zip(crossings.design, crossings.place, strict=True)):
        energies[k] = np.sum(found[(pieces.design == design) & (pieces.high <= place + ROUNDING)])
    return crossings, energies


# Energies are computed at so many places for each pose; parabolas through them have the extremes.
PARTS = 8
# Halvings of the bracket in which the mean speed is found.
HALVINGS = 60


class SpeedFluctuation:
    """The speed of a driver with constant effort, over a cycle of one design.

    Half of inertia times squared speed is the energy of the surplus plus that of the parts at the mean speed. Loads are
    those at the mean speed. The coefficient is infinite where the machine would stop within the cycle.
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
        if not course.forces.inertia:  # the surplus includes what the parts give at constant speed
            self.energy -= 0.5 * speed**2 * (self.inertia - self.inertia[-1])

    def coefficient(self, flywheel: float) -> float:
        """Return the coefficient of fluctuation with a flywheel of some inertia."""
        total = self.inertia + flywheel
        if not np.all(total > 0.0):
            return np.inf
        # the change of squared speed by the surplus, and by a constant energy
        lent, more = 2.0 * self.energy / total, float(np.max(total)) / total
        greatest = self.speed**2 + float(np.max(np.abs(lent)))
        least = -greatest
        for _ in range(HALVINGS):
            middle = 0.5 * (least + greatest)
            slowest, fastest = _speeds(self.speed**2 + lent + middle * more)
            least, greatest = (middle, greatest) if slowest + fastest < 2.0 * self.speed else (least, middle)
        return (fastest - slowest) / self.speed if slowest > 0.0 else np.inf


def _speeds(squares: Number) -> tuple[float, float]:
    """Return the square roots of the least and greatest of values on a closed cycle, between the samples too."""
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
