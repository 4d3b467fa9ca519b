"""The ways of followers past a cam, and the profiles that they envelop.

Everything is in the cam's frame, its origin on the cam's axis, by the cam's angle s: a carrier's point P is there
``exp(-1j s) P``. As s grows, the cam's side of every curve is on its right.

Source: R. L. Norton, Cam Design and Manufacturing Handbook, 2nd ed., Industrial Press 2009, chapter 13 (envelopes);
E. Soylemez, Mechanisms, sections 8.4 and 8.5.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from math import acos, asin, hypot, sqrt

import numpy as np

from compoundkin.base.arrays import TURN, dot
from compoundkin.base.composition import composed, differentiated
from compoundkin.base.curves import Analytic
from compoundkin.base.series import Number, Series, constant
from compoundkin.model.laws.motion_programs import Program


@dataclass(frozen=True)
class Lift:
    """How far the follower has risen from the base circle, by the cam's angle. A motion program laid round the cam."""

    program: Program
    start: float
    clockwise: bool

    def at(self, s: Series) -> Series:
        """Return the lift and its derivatives."""
        turned = self.start - s if self.clockwise else s - self.start
        return self.program.at(turned, repeat=True)

    @property
    def breaks(self) -> tuple[float, ...]:
        """The cam's angles at which a law begins and derivatives may jump."""
        sense = -1.0 if self.clockwise else 1.0
        return tuple((self.start + sense * piece.start) % TURN for piece in self.program.pieces)


class FollowerGuide(ABC):
    """How a follower moves by its coordinate; see `Translating` and `Oscillating`."""

    @property
    @abstractmethod
    def home(self) -> float:
        """The coordinate on the base circle."""

    @property
    def sense(self) -> float:
        """+1 where the coordinate grows as the follower rises, else -1."""
        return 1.0

    @abstractmethod
    def middle(self, coordinate: Series) -> Series:
        """Return the knife edge or the middle of the roller, in the carrier's frame."""

    @abstractmethod
    def facing(self, coordinate: Series) -> tuple[Series, Series]:
        """Return a flat face in the carrier's frame.

        Its normal, away from the cam, and its distance from the cam's axis.
        """


@dataclass(frozen=True)
class Translating(FollowerGuide):
    """Along a guide in a direction, `offset` to its left. `prime` is the distance of the edge or face at home."""

    prime: float
    angle: float
    offset: float
    flat: bool

    @property
    def home(self) -> float:
        """The displacement along the guide from the foot of the cam's axis."""
        return self.prime if self.flat else sqrt(self.prime**2 - self.offset**2)

    def middle(self, coordinate: Series) -> Series:
        """Return a place on the guide."""
        return (coordinate + 1j * self.offset) * self._along

    def facing(self, coordinate: Series) -> tuple[Series, Series]:
        """Return a face square to the guide."""
        return constant(self._along), coordinate

    @property
    def _along(self) -> complex:
        return complex(np.cos(self.angle), np.sin(self.angle))


@dataclass(frozen=True)
class Oscillating(FollowerGuide):
    """About a pivot; the coordinate is the angle of the arm or face. `face` is how far the face is beyond the pivot.

    `side` +1: the arm rises counterclockwise, so that it is on the left of the line from the pivot to the cam.
    """

    prime: float
    pivot: complex
    arm: float
    face: float
    side: int
    flat: bool

    @property
    def opening(self) -> float:
        """The angle at home between arm and line from pivot to cam's axis."""
        apart = abs(self.pivot)
        if self.flat:
            return asin((self.prime - self.face) / apart)
        return acos((self.arm**2 + apart**2 - self.prime**2) / (2.0 * self.arm * apart))

    @property
    def home(self) -> float:
        """The angle of the arm or the face."""
        return float(np.angle(-self.pivot)) + self.side * self.opening

    @property
    def sense(self) -> float:
        """By the side."""
        return float(self.side)

    def middle(self, coordinate: Series) -> Series:
        """Return the end of the arm."""
        return coordinate.turn() * self.arm + self.pivot

    def facing(self, coordinate: Series) -> tuple[Series, Series]:
        """Return a face square to the arm."""
        normal = coordinate.turn() * (1j * self.side)
        return normal, normal.dot(self.pivot) + self.face


@dataclass(frozen=True)
class Envelope:
    """What a follower that is carried round a cam leaves of it."""

    lift: Lift
    guide: FollowerGuide
    roller: float

    def coordinate(self, s: Series) -> Series:
        """Return the follower's coordinate by the cam's angle."""
        return self.lift.at(s) * self.guide.sense + self.guide.home

    def pitch(self) -> Analytic:
        """Return the path of the knife edge or roller's middle, in the cam's frame."""
        return self._curve(lambda s: self.guide.middle(self.coordinate(s)) * (-s).turn())

    def rolled(self) -> Analytic:
        """Return what the roller leaves: the parallel curve on the cam's side."""
        return self.pitch().offset(self.roller) if self.roller else self.pitch()

    def faced(self) -> Analytic:
        """Return what the face leaves.

        With the face at n . C = h, the envelope has n' . C = h' too: C = n (h + i h' / w), w the rate at which n turns.
        """
        return self._curve(self._touched)

    def turning(self, s: Number) -> Number:
        """Return the rate at which the face turns in the cam's frame. It must be negative throughout."""
        return self._facing(_along(s, 1))[0].turning().c[0]

    def radius(self, s: Number) -> Number:
        """Return the radius of curvature that a flat face leaves. Where it is negative the envelope turns back."""
        normal = self._facing(_along(s, 1))[0]
        along = self.faced().derivatives(s, 1)[1]
        return dot(along, -1j * normal.c[0]) / np.abs(normal.turning().c[0])

    def _curve(self, function: Callable[[Series], Series]) -> Analytic:
        return Analytic(function, 0.0, TURN, True, self.lift.breaks)

    def _facing(self, s: Series) -> tuple[Series, Series]:
        normal, distance = self.guide.facing(self.coordinate(s))
        return normal * (-s).turn(), distance

    def _touched(self, s: Series) -> Series:
        normal, distance = self._facing(_along(s.c[0], s.order + 1))
        aside = Series(differentiated(distance.c)) / normal.turning()
        place = Series(normal.c[:-1]) * (Series(distance.c[:-1]) + aside * 1j)
        return composed(place.c, s)


def _along(s: Number, order: int) -> Series:
    """Return the parameter itself as a series."""
    return Series((s, 1.0, *[0.0] * (order - 1)))


def reach(pivot: complex, arm: float) -> tuple[float, float]:
    """Return the least and greatest distance of an arm's end from the cam's axis.

    >>> reach(4j, 3.0)
    (1.0, 7.0)
    """
    apart = hypot(pivot.real, pivot.imag)
    return abs(apart - arm), apart + arm
