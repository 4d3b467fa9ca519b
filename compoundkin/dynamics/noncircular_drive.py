"""Noncircular gears that make the torque of a shaft even: the law by which they turn a driver, and their pitch curves.

Flywheels hold the speed of a driver; here the speed is given away. The shaft turns evenly and gives the same torque all
the time, and the gears slow the driver down where the machine needs more.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import sqrt
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arguments import checked, is_real
from compoundkin.base.arrays import TURN, Number, first_entry
from compoundkin.base.display import ShortRepr, aligned_text
from compoundkin.base.errors import InvalidInput, Problem, suppress_pose_warnings
from compoundkin.dynamics.driver_course import DriverCourse, Line, driver_course, in_units
from compoundkin.dynamics.force_analysis import force_analysis
from compoundkin.dynamics.forces import Forces
from compoundkin.dynamics.mass_motion import equivalent_inertia
from compoundkin.kinematics import Motion, solve
from compoundkin.model.elements import Drive
from compoundkin.model.laws import Law, motion_table
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.units import ANGULAR_VELOCITY

# The cycle is looked at in so many places. Laws are found anew until torques agree to a part of the greatest: loads
# that depend on speeds, and friction, are others at other speeds.
PLACES, ROUNDS, AGREED = 720, 40, 1e-7
# Steps of energies for each place, four times as many where they are too long to be stable, up to so many.
PARTS, MOST_PARTS, STABLE = 2, 128, 0.5
# Values that are read off tables of a cycle by Newton's method on a monotone function take a few steps.
STEPS = 6
# A speed is constant, and a range a turn, to this part.
STEADY = 1e-9


@dataclass(frozen=True, eq=False, repr=False)
class NoncircularDrive(ShortRepr):
    """Noncircular gears between a shaft that turns evenly and a driver, by which the torque of the shaft is even.

    `torque` is that of the shaft, `speed` its speed, which is the mean speed of the driver. At the `angles` of the
    shaft over a turn (n,) the driver has its `values`, and turns `ratio` times as fast as the shaft. `torques` are
    those of the shaft there, computed anew by the forces of the mechanism along this motion, and `before` those of a
    driver at constant speed. The `mechanism` is driven by the `law`.
    """

    driver: str
    mechanism: Mechanism
    law: Law
    speed: float
    torque: float
    angles: Number
    values: Number
    ratio: Number
    torques: Number
    before: Number

    @property
    def unevenness(self) -> float:
        """The greatest difference of the shaft's torque from its mean, over that."""
        return float(np.max(np.abs(self.torques - self.torque)) / abs(self.torque))

    def pitch_curves(self, distance: float) -> tuple[Number, Number]:
        """Return the pitch curves of the two gears, external, as complex points (n,) about their own axes.

        `distance` is that of the axes. The first is on the shaft; both are drawn where the shaft is at zero and the
        axis of the driver is to the right. Raises InvalidInput for a distance that is none.
        """
        if not (is_real(distance) and 0.0 < distance < np.inf):
            raise InvalidInput(Problem("distance", f"{distance!r} is no distance of axes", "a length above 0"))
        own = distance * self.ratio / (1.0 + self.ratio)
        turned = self.values - self.values[0]
        return own * np.exp(-1j * self.angles), (own - distance) * np.exp(1j * turned)

    def text(self) -> str:
        """Return it as text: torques in N m as well."""
        return aligned_text(tuple(self._lines()))

    def _lines(self) -> Iterator[Line]:
        units = self.mechanism.stated_units
        yield (f"noncircular gears before the driver {self.driver}",)
        yield in_units("speed of the shaft", self.speed, ANGULAR_VELOCITY)
        yield in_units("torque of the shaft", self.torque, units.moment)
        yield "greatest difference from it, a part", self.unevenness
        yield in_units("greatest torque without the gears", float(np.max(np.abs(self.before))), units.moment)
        yield "least ratio", float(np.min(self.ratio))
        yield "greatest ratio", float(np.max(self.ratio))


@checked
def noncircular_drive(forces: Forces, *, driver: str | None = None) -> NoncircularDrive:
    """Return the noncircular gears by which a shaft at constant speed drives a machine with an even torque.

    The driver turns once a cycle as the shaft does, faster or slower within it: where the machine needs more it is
    slowed down, and its own inertia gives what is missing. Without inertia, or in statics, the ratio is the mean torque
    over the one needed, which must then be of one sense throughout. `forces` are of one design over a closed cycle of
    a driver that turns at constant speed. Raises InvalidInput where they are not, and where no such gears exist.

    Source: balance of power of the shaft, torque of the shaft = d/dt (kinetic energy) + power of the loads; noncircular
    gears for even input torque, e.g. G. H. Yao, Y. A. Chen, J. Mech. Des. 114 (1992); pitch curves r1 = a i / (1 + i).

    >>> from compoundkin.kinematics import Motion, solve
    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.model.loads.attachments import effort
    >>> from compoundkin.model.mechanism import Mechanism
    >>> from compoundkin.dynamics.force_analysis import force_analysis
    >>> load = effort("arm", lambda q: -2 - np.cos(q))
    >>> parts = link("frame", A=0), link("arm", A=0), drive("arm"), load
    >>> arm = Mechanism("Arm", *parts, units={"length": "m", "mass": "kg", "force": "N"})
    >>> turn = solve(arm, np.linspace(0, 2 * np.pi, 73), speed=3)
    >>> found = noncircular_drive(force_analysis(turn))
    >>> round(found.torque, 6), found.unevenness < 1e-6, round(float(found.ratio[0]), 6)      # 2; 2 / 3
    (2.0, True, 0.666667)
    """
    course = driver_course(forces, driver, of_cycle=True)
    start, speed = _start_and_speed(course)
    shaft = np.linspace(0.0, TURN, PLACES + 1)
    cycle = _MachineTurn(course, start, speed, shaft)
    law = ShaftCourse(start + np.sign(speed) * shaft, np.full(len(shaft), speed), np.zeros(len(shaft)))
    before = effort = cycle.effort(law)
    cycle.check_loads(law, effort)
    for _ in range(ROUNDS):
        loads = cycle.loads(law, effort)
        law = cycle.even_law(loads)
        effort = cycle.effort(law)
        again = cycle.loads(law, effort)
        if np.max(np.abs(again(shaft) - loads(shaft))) <= AGREED * np.max(np.abs(before)):
            break
    else:
        what = "laws found one after another do not come to agree: loads depend too much on speeds"
        raise InvalidInput(Problem(course.driver, what, "solve it at a lower speed"))
    own = motion_table(shaft / abs(speed), law.values, law.rates, law.seconds)
    torques = effort * law.rates / abs(speed)
    return NoncircularDrive(
        course.driver, cycle.driven_by(own), own, abs(speed), float(np.mean(torques[:-1])), shaft, law.values,
        law.rates / speed, torques, np.sign(speed) * before,
    )  # fmt: skip


def _start_and_speed(course: DriverCourse) -> tuple[float, float]:
    """Return where a driver begins, and its speed. Raises InvalidInput for a motion that is not a turn at one speed."""
    motion, name = course.motion, course.driver
    if motion.inputs.designs != 1:
        raise InvalidInput(Problem("forces", "only one design at a time has its gears", "solve that design by itself"))
    own = motion.drives[name]
    values, rates = (np.broadcast_to(one, motion.shape).ravel() for one in (own.value, own.rate))
    travel = float(values[-1] - values[0])
    if not own.is_angle or abs(abs(travel) - TURN) > STEADY * TURN:
        raise InvalidInput(Problem(name, "it does not turn once over the motion", "solve a whole turn of it"))
    if np.ptp(rates) > STEADY * abs(rates[0]) or travel * rates[0] <= 0.0:
        remedy = "solve(..., speed=...), positive where its values grow"
        raise InvalidInput(Problem(name, "it does not turn at a constant speed in the sense of its values", remedy))
    return float(values[0]), float(rates[0])


class ShaftCourse(NamedTuple):
    """Values of a driver, its rates and second rates, at the angles of the shaft (n,)."""

    values: Number
    rates: Number
    seconds: Number


class _MachineTurn:
    """A machine over one turn of its driver, which has gone `way` (radians) from its start."""

    def __init__(self, course: DriverCourse, start: float, speed: float, shaft: Number) -> None:
        self.mechanism, self.driver, self.forces = course.motion.mechanism, course.driver, course.forces
        self.start, self.speed, self.shaft, self.sense = start, abs(speed), shaft, float(np.sign(speed))
        signs = ((one.links[0], one.sign) for one in course.motion.modes.values() if one.sign is not None)
        self.modes = {link: int(first_entry(sign)) for link, sign in signs}
        self.inertia = self._inertia(course)

    def _inertia(self, course: DriverCourse) -> Any:
        """Return what the driver feels of all masses, in units of its energy, over its way; None without inertia."""
        from scipy.interpolate import CubicSpline

        if not (self.forces.inertia and self.mechanism.masses):
            return None
        found = equivalent_inertia(self._motion(self.start + self.sense * self.shaft, self.speed, 0.0))
        k = found.drivers.index(self.driver)
        values = course.units.inertia * found.matrix[..., k, k].ravel()
        return CubicSpline(self.shaft, np.append(values[:-1], values[0]), bc_type="periodic")

    def _motion(self, values: Number, rates: Any, seconds: Any) -> Motion:
        """Return the motion through values. Raises InvalidInput where it is not assembled."""
        own: dict[str, Any] = {"speed": {self.driver: rates}, "acceleration": {self.driver: seconds}}
        with suppress_pose_warnings():
            motion = solve(self.mechanism, {self.driver: values}, modes=self.modes or None, **own)
        if np.any(motion.failed):
            raise InvalidInput(Problem(self.driver, "it is not assembled over the whole turn", "solve a cycle of it"))
        return motion

    def driven_by(self, law: Law) -> Mechanism:
        """Return the mechanism whose driver follows a law."""
        (own,) = (one for one in self.mechanism.drives if one.name == self.driver)
        return self.mechanism.replace(Drive(own.name, own.link, own.on, own.pair, law=law))

    def effort(self, law: ShaftCourse) -> Number:
        """Return the effort of the driver along a law."""
        forces = force_analysis(self._motion(*law), inertia=self.forces.inertia)
        return np.broadcast_to(np.asarray(forces.drives[self.driver].effort, dtype=float), self.shaft.shape)

    def check_loads(self, law: ShaftCourse, effort: Number) -> None:
        """Raise InvalidInput where there is no work to do, or no gear of one sense."""
        loads = self.loads(law, effort)
        if float(loads.antiderivative()(TURN)) <= 0.0:
            raise InvalidInput(Problem("forces", "the driver gives no work over the cycle", "there must be work to do"))
        if self.inertia is None and float(np.min(loads(self.shaft))) <= 0.0:
            what = "without inertia the torque must have one sense throughout"
            raise InvalidInput(Problem("forces", what, "give links their masses, or a flywheel to the driver"))

    def loads(self, law: ShaftCourse, effort: Number) -> Any:
        """Return the torque of the loads over the way: the effort less what masses take. It does not overshoot."""
        from scipy.interpolate import PchipInterpolator

        way, own = self.sense * (law.values - self.start), self.sense * effort
        if self.inertia is not None:
            own = own - self.inertia(way) * self.sense * law.seconds - 0.5 * self.inertia(way, 1) * law.rates**2
        return PchipInterpolator(way, own)

    def even_law(self, loads: Any) -> ShaftCourse:
        """Return the law along which the shaft's torque is even, for given loads over the way."""
        if self.inertia is None:
            work = loads.antiderivative()
            mean = float(work(TURN)) / TURN
            way = self._way(lambda s: work(s) / mean, lambda s: loads(s) / mean)
            ratio = mean / loads(way)
            return self._law(way, ratio, -(ratio**2) * loads(way, 1) / loads(way))
        found = self._energies(loads)
        way = self._way(lambda s: found(s)[1], lambda s: self._slope(s, found(s)[0]))
        energy, inertia = found(way)[0], self.inertia(way)
        ratio = 1.0 / self._slope(way, energy)
        mean = float(loads.antiderivative()(TURN)) / TURN
        rise = mean / ratio - loads(way)  # of the energy over the way
        return self._law(way, ratio, (rise - energy * self.inertia(way, 1) / inertia) / inertia / self.speed**2)

    def _law(self, way: Number, ratio: Number, bend: Number) -> ShaftCourse:
        """Return a law by its ratio and the second derivative of the way by the angle of the shaft."""
        values = self.start + self.sense * way
        return ShaftCourse(values, self.sense * self.speed * ratio, self.sense * self.speed**2 * bend)

    def _slope(self, way: Number, energy: Number) -> Number:
        """Return the rate of the shaft's angle over the way, from the energy of the masses there."""
        return np.sqrt(0.5 * self.inertia(way) / energy) * self.speed

    def _energies(self, loads: Any) -> Any:
        """Return the energy of the masses and the shaft's angle over the way, periodic: both (2, n).

        The energy changes by what the shaft gives less what the loads take. It comes back after a cycle for one value
        at its start only: the more there is, the less the shaft turns meanwhile and gives.
        """
        from scipy.interpolate import CubicHermiteSpline
        from scipy.optimize import brentq

        mean = float(loads.antiderivative()(TURN)) / TURN
        middle = 0.5 * float(np.max(self.inertia(self.shaft))) * self.speed**2
        parts, low, high = PARTS, 0.5 * middle, 2.0 * middle
        while True:
            step = _EnergySteps(self, loads, mean, parts)
            while step.gain(high) > 0.0:
                high *= 4.0
            # the energy is never above that which begins with more: steps too large for that one are too large for it
            if self._is_followed(step, step.cycle(high)[0]):
                while step.gain(low) < 0.0:
                    low *= 0.25
                energies, angles = step.cycle(brentq(step.gain, low, high, xtol=1e-14 * middle, rtol=1e-14))
                if self._is_followed(step, energies):
                    break
            parts *= 4
            if parts > MOST_PARTS:
                remedy = "force_analysis(motion, inertia=False) leaves it out"
                raise InvalidInput(Problem("forces", "the inertia is too small against the loads", remedy))
        slopes = self._slope(step.places, energies)
        rates = np.stack([mean * slopes - loads(step.places), slopes])
        return CubicHermiteSpline(step.places, np.stack([energies, angles]), rates, axis=-1)

    def _is_followed(self, step: _EnergySteps, energies: Number) -> bool:
        """Return whether steps follow how fast a difference of energy dies away."""
        rates = step.mean * self._slope(step.places, energies) / energies
        return float(np.max(rates)) * step.step < STABLE

    def _way(self, angle: Any, slope: Any) -> Number:
        """Return the way at the angles of the shaft, by Newton's method from a table of the monotone angle."""
        way = np.interp(self.shaft, angle(self.shaft) * TURN / angle(np.array([TURN]))[0], self.shaft)
        for _ in range(STEPS):
            way = np.clip(way - (angle(way) - self.shaft) / slope(way), 0.0, TURN)
        return way


class _EnergySteps:
    """The energy of the masses over a cycle by the method of Runge and Kutta, with even steps over the way."""

    def __init__(self, cycle: _MachineTurn, loads: Any, mean: float, parts: int) -> None:
        halves = np.linspace(0.0, TURN, 2 * PLACES * parts + 1)
        self.mean, self.step = mean, TURN / (PLACES * parts)
        self.places = halves[::2]
        self._loads = np.asarray(loads(halves)).tolist()
        self._roots = (cycle.speed * np.sqrt(0.5 * cycle.inertia(halves))).tolist()

    def gain(self, energy: float) -> float:
        """Return by how much the energy has grown after a cycle."""
        return float(self.cycle(energy)[0][-1]) - energy

    def cycle(self, energy: float) -> tuple[Number, Number]:
        """Return the energies at all places, and the angles of the shaft."""
        mean, h, loads, roots = self.mean, self.step, self._loads, self._roots
        least, angle = 1e-9 * energy, 0.0
        energies, angles = [energy], [angle]
        for k in range(0, len(loads) - 1, 2):
            s1 = roots[k] / sqrt(energy)
            s2 = roots[k + 1] / sqrt(max(energy + 0.5 * h * (mean * s1 - loads[k]), least))
            s3 = roots[k + 1] / sqrt(max(energy + 0.5 * h * (mean * s2 - loads[k + 1]), least))
            s4 = roots[k + 2] / sqrt(max(energy + h * (mean * s3 - loads[k + 1]), least))
            gone = h / 6.0 * (s1 + 2.0 * s2 + 2.0 * s3 + s4)
            taken = h / 6.0 * (loads[k] + 4.0 * loads[k + 1] + loads[k + 2])
            energy, angle = max(energy + mean * gone - taken, least), angle + gone
            energies.append(energy)
            angles.append(angle)
        return np.array(energies), np.array(angles)
