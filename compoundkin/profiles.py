"""Profiles of cams and curved slots as they are written: a round disc, given points, a formula, or made for a motion.

Coordinates are those of the link that carries the profile. What they have in common is their `curve`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from compoundkin.curves import Analytic, Curve, Function, Spline
from compoundkin.errors import InvalidMechanism, Problem
from compoundkin.keys import Key
from compoundkin.series import Number


class Profile(ABC):
    """A profile; kinds are frozen dataclasses with the keys that a file holds for them."""

    kind: ClassVar[str]  # what it is called in a file
    keys: ClassVar[tuple[Key, ...]]

    @cached_property
    def curve(self) -> Curve:
        """The curve, in the coordinates of its link. Raises InvalidMechanism for what is no curve."""
        return self._made()

    @abstractmethod
    def _made(self) -> Curve: ...

    @property
    def circle(self) -> tuple[complex, float] | None:
        """Middle and radius where the profile is a circle all round, for which there are exact formulas."""
        return None

    def problems(self, where: str) -> Iterator[Problem]:
        """What makes it no profile: points too few, a curve that crosses itself."""
        try:
            found = self.curve.crosses_itself()
        except InvalidMechanism as error:
            yield from (Problem(f"{where}.{p.where}" if p.where else where, p.what, p.remedy) for p in error.problems)
            return
        if found:
            place = found[0].point
            what = f"the profile crosses itself at ({place.real:.6g}, {place.imag:.6g})"
            yield Problem(where, what, "change the points that make the loop")


@dataclass(frozen=True, eq=False)
class Disc(Profile):
    """A round disc, an eccentric if its `middle` is not the axis of its link."""

    radius: float
    middle: complex = 0j

    kind: ClassVar[str] = "disc"
    keys: ClassVar[tuple[Key, ...]] = (
        Key("radius", "length", "Its radius.", required=True),
        Key("middle", "point", "Its middle.", default=0j),
    )

    @property
    def circle(self) -> tuple[complex, float]:
        """Its middle and radius."""
        return self.middle, self.radius

    def _made(self) -> Curve:
        return Analytic(lambda s: s.turn() * self.radius + self.middle, 0.0, 2.0 * np.pi, closed=True)

    def problems(self, where: str) -> Iterator[Problem]:
        """A radius that is none."""
        if not (np.isfinite(self.radius) and self.radius > 0):
            yield Problem(f"{where}.radius", f"{self.radius!r} is not a positive length")


@dataclass(frozen=True, eq=False)
class Points(Profile):
    """A smooth curve through given points, closed or open."""

    points: tuple[complex, ...]
    closed: bool = True

    kind: ClassVar[str] = "points"
    keys: ClassVar[tuple[Key, ...]] = (
        Key("points", "places", "The points in order, four or more.", required=True),
        Key("closed", "flag", "Whether the last point is followed by the first.", default=True),
    )

    def _made(self) -> Curve:
        return Spline(self.points, self.closed)


@dataclass(frozen=True, eq=False)
class Formula(Profile):
    """A curve by a Python function of a parameter from `low` to `high`: complex points for an array of parameters."""

    function: Callable[[Any], Any]
    low: float
    high: float
    closed: bool = True

    kind: ClassVar[str] = "formula"
    keys: ClassVar[tuple[Key, ...]] = ()

    def _made(self) -> Curve:
        return Function(self.function, self.low, self.high, self.closed)


def disc(radius: float, middle: Any = 0j) -> Disc:
    """The profile of a round disc of a radius about a point of its link, (x, y) or complex.

    >>> disc(20, (5, 0)).circle
    ((5+0j), 20.0)
    """
    return Disc(float(radius), _place(middle))


def profile(points: Any, *, closed: bool = True) -> Points:
    """The profile through points, complex or (x, y): closed as of a cam, or open as of a slot.

    Raises InvalidMechanism for what are not points; fewer than four are told when the mechanism is built.

    >>> profile([(2, 0), (0, 1), (-2, 0), (0, -1)]).points[1]
    1j
    """
    return Points(tuple(_place(point) for point in points), closed)


def formula(function: Callable[[Any], Any], low: float, high: float, *, closed: bool = True) -> Formula:
    """The profile that a Python function traces: complex points for an array of parameters.

    >>> formula(lambda s: 2 * np.cos(s) + 1j * np.sin(s), 0, 2 * np.pi).curve.closed
    True
    """
    return Formula(function, float(low), float(high), closed)


def _place(value: Any) -> complex:
    try:
        return complex(value) if np.ndim(value) == 0 else complex(*(float(v) for v in value))
    except (TypeError, ValueError):
        raise InvalidMechanism(Problem("profile", f"{value!r} is not a point", "write (x, y)")) from None


def side_of(curve: Curve) -> Number:
    """+1 where the normal of a closed curve points outward, -1 where inward; of an open one +1."""
    return 1.0 if not curve.closed or curve.is_counterclockwise else -1.0
