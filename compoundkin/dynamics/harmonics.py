"""Harmonics over a closed cycle: of shaking forces, shaking moments, drivers' efforts, or any other quantity."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import TURN, Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.dynamics.driver_course import Line, driver_named, texts_of_designs
from compoundkin.dynamics.forces import Forces, motion_of
from compoundkin.kinematics.extremes import between, closed_cycles
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.quantities import quantity
from compoundkin.model.attributes import SHAKING_FORCE
from compoundkin.model.geometry import FRAME
from compoundkin.model.units import customary_unit

SHAKING = f"{FRAME}.{SHAKING_FORCE}"
# Travel within so many radians of a full turn is one: rounding of sums of steps.
FULL_TURN_ERROR = 1e-9
# A cycle is sampled at twice as many places until no coefficient changes by more than this part of the largest.
CONVERGED, FEWEST, MOST = 1e-12, 64, 4096
# In a text, coefficients below this part of the largest are rounding: they converge to CONVERGED only.
ROUNDING = 1e-10
# A phase of -180 degrees but for six digits is one of 180.
SAME_AS_HALF_TURN = -179.9999


@dataclass(frozen=True, eq=False, repr=False)
class Harmonics(ShortRepr):
    """The harmonics of a quantity; arrays (designs, orders + 1).

    The mean is first. A number is the sum of amplitude x cos(order x angle + phase). A vector is the sum of `forward` x
    exp(i order angle) and `backward` x exp(-i order angle), vectors that turn with the cycle and against it. The angle
    is the driver's where the cycle is its full turn, else a full turn from the beginning to the end of the cycle.
    """

    name: str
    unit: str
    is_vector: bool
    forward: Number
    backward: Number

    @property
    def orders(self) -> Number:
        """The orders, from 0."""
        return np.arange(self.forward.shape[-1])

    def text(self) -> str:
        """Return them as text, a block for each design: of a number amplitudes and phases, of a vector both parts.

        Phases are in degrees, torques in N m as well.
        """
        return texts_of_designs(len(self.forward), self._lines)

    def _lines(self, k: int) -> Iterator[Line]:
        words = ("forward", "at", "backward", "at") if self.is_vector else ("amplitude", "phase")
        own = self.amplitude[k] * np.exp(1j * self.phase[k]) if not self.is_vector else self.forward[k]
        columns = (own, self.backward[k]) if self.is_vector else (own,)
        other = customary_unit(self.unit)
        units = [(self.unit, 1.0), *([other] if other and not self.is_vector else [])]
        yield (f"{self.name} [{', '.join(unit for unit, _ in units)}, °]",)
        yield "order", *words[:1], *[""] * (len(units) - 1), *words[1:]
        least = ROUNDING * max(float(np.max(np.abs(one))) for one in columns)
        for order in range(len(columns[0])):
            cells = [(*(abs(one[order]) * size for _, size in units), _phase(one[order])) if abs(one[order]) > least
                     else (*[0.0] * len(units), 0.0) for one in columns]  # fmt: skip
            yield str(order), *(float(value) for cell in cells for value in cell)

    def part(self, component: str) -> Harmonics:
        """Return the harmonics of a component of a vector, "x" or "y"."""
        if not self.is_vector or component not in ("x", "y"):
            raise InvalidInput(Problem(self.name, f"it has no component {component!r}", 'take "x" or "y" of a vector'))
        other = np.conj(self.backward) if component == "x" else -np.conj(self.backward)
        half = (self.forward + other) / (2.0 if component == "x" else 2j)
        return Harmonics(f"{self.name}.{component}", self.unit, False, half, np.conj(half))

    @property
    def amplitude(self) -> Number:
        """The amplitudes of a number. The first is the mean's size. Raises InvalidInput for a vector."""
        self._hold()
        return np.abs(self.forward) * np.where(self.orders > 0, 2.0, 1.0)

    @property
    def phase(self) -> Number:
        """The phases of a number, radians. Raises InvalidInput for a vector."""
        self._hold()
        return np.angle(self.forward)

    def _hold(self) -> None:
        if self.is_vector:
            raise InvalidInput(Problem(self.name, "a vector has no amplitude", 'take .part("x"), .forward, .backward'))


@checked
def harmonics(of: Forces | Motion, name: str = SHAKING, *, orders: int = 6, driver: str | None = None) -> Harmonics:
    """Return the harmonics of a quantity over a closed cycle.

    The default quantity is the shaking force, the default driver the only one. The cycle is solved at places equally
    spaced in time, or by the driver, whose number doubles until the coefficients converge. Names are those of
    `quantity`. Raises InvalidInput for a motion that is no closed cycle and for a driver that does not move
    monotonically, UnknownName for unknown names.

    Source: e.g. J. P. Den Hartog, Mechanical Vibrations, 4th ed., McGraw-Hill 1956, chapter 5.

    >>> from compoundkin.kinematics import solve
    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.model.mechanism import Mechanism
    >>> crank = Mechanism("m", link("frame", A=(3, 0)), link("crank", A=0, B=2), drive("crank"))
    >>> harmonics(solve(crank), "B.x", orders=2).amplitude.round(12).tolist()         # 3 + 2 cos
    [[3.0, 2.0, 0.0]]
    >>> print(harmonics(solve(crank), "B.x", orders=1).text())
    B.x [length, °]
    order  amplitude  phase
    0              3      0
    1              2      0
    """
    motion = motion_of(of)
    _check_closed(motion, orders)
    course = _Cycle(motion, driver_named(motion, driver) if motion.time is None else None)
    count, found = max(FEWEST, 4 * orders), None
    while True:
        coefficients = course.coefficients(name, orders, count)
        if (found is not None and _change(coefficients, found) <= CONVERGED) or count >= MOST:
            break
        count, found = 2 * count, coefficients
    known = quantity(motion, name)
    return Harmonics(name, known.unit, known.is_vector, *coefficients)


def _phase(value: complex) -> float:
    """Return the angle of a coefficient in degrees, above -180."""
    found = round(float(np.rad2deg(np.angle(value))), 9)
    return 180.0 if found <= SAME_AS_HALF_TURN else found


def _change(new: tuple[Number, Number], old: tuple[Number, Number]) -> float:
    scale = max(float(np.max(np.abs(one))) for one in new) or 1.0
    return max(float(np.max(np.abs(a - b))) for a, b in zip(new, old, strict=True)) / scale


def _check_closed(motion: Motion, orders: int) -> None:
    if orders < 1:
        raise InvalidInput(Problem("orders", f"{orders} is no number of orders", "1 or more"))
    if motion.inputs.poses < 2 or not closed_cycles(motion).all() or np.any(motion.failed):
        raise InvalidInput(Problem("motion", "it is no closed cycle", "solve it over a full turn of its driver"))


class _Cycle:
    """A closed cycle of a motion by the time, or by a driver."""

    def __init__(self, motion: Motion, driver: str | None) -> None:
        self.motion = motion
        along: Number = motion.time if driver is None else motion.drives[driver].value
        self.along = np.broadcast_to(along, motion.shape).reshape(motion.failed.shape)
        steps = np.diff(self.along, axis=1)
        if not (np.all(steps > 0) or np.all(steps < 0)):
            raise InvalidInput(
                Problem(driver or "time", "it is not monotonic over the cycle", "name a driver that does")
            )
        span = self.along[:, -1] - self.along[:, 0]
        is_turn = driver is not None and motion.drives[driver].is_angle
        self.start = np.where(
            is_turn & (np.abs(np.abs(span) - TURN) < FULL_TURN_ERROR), self.along[:, 0] * np.sign(span), 0.0
        )

    def coefficients(self, name: str, orders: int, count: int) -> tuple[Number, Number]:
        """Return the forward and backward coefficients, (designs, orders + 1)."""
        designs, poses = self.along.shape
        part = np.arange(count) / count
        places = np.array([_places(row, part) for row in self.along])
        at = between(self.motion, np.repeat(np.arange(designs), count), np.clip(places, 0, poses - 1).ravel())
        values = np.reshape(quantity(at, name).values, (designs, count))
        whole = np.fft.fft(values, axis=1) / count
        k = np.arange(orders + 1)
        turned = np.exp(-1j * k * self.start[:, None])
        return whole[:, k] * turned, whole[:, -k] * np.conj(turned)


def _places(row: Number, part: Number) -> Number:
    """Return the places at which a monotonic row of values has covered the given parts of its range."""
    gone = (row - row[0]) / (row[-1] - row[0])
    found: Number = np.interp(part, gone, np.arange(len(row)))
    return found
