"""Profiles of a given shape. A round disc, a smooth curve through points, the curve of a Python function."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.copies import HoldsFunction
from compoundkin.base.curves import Analytic, Curve, Function, Spline
from compoundkin.base.display import PrintsShort
from compoundkin.base.errors import InvalidMechanism, Problem
from compoundkin.model.fields import Key
from compoundkin.model.geometry import number_of, place_of
from compoundkin.model.profiles.contract import Profile


@dataclass(frozen=True)
class DiscProfile(Profile):
    """A round disc, an eccentric if its `middle` is not its link's axis."""

    radius: float
    middle: complex = 0j

    kind: ClassVar[str] = "disc"
    keys: ClassVar[tuple[Key, ...]] = (
        Key("radius", "number", "Its radius.", required=True),
        Key("middle", "place", "Its middle.", default=0j),
    )

    @property
    def circle(self) -> tuple[complex, float]:
        """Its middle and radius."""
        return self.middle, self.radius

    def _made(self) -> Curve:
        return Analytic(lambda s: s.turn() * self.radius + self.middle, 0.0, 2.0 * np.pi, closed=True)

    def problems(self, where: str) -> Iterator[Problem]:
        """Find a radius that is none, a middle that is nowhere."""
        if not (np.isfinite(self.radius) and self.radius > 0):
            yield Problem(f"{where}.radius", f"{self.radius!r} is not a positive length")
        if not np.isfinite(self.middle):
            yield Problem(f"{where}.middle", f"{self.middle!r} is not a finite point")


@checked
def disc(radius: float, middle: Any = 0j) -> DiscProfile:
    """Return the profile of a round disc about a point of its link.

    Raises InvalidMechanism for what is no number or no point.

    >>> disc(20, (5, 0)).circle
    ((5+0j), 20.0)
    """
    return DiscProfile(number_of(radius, "profile.radius"), place_of(middle, "profile.middle"))


@dataclass(frozen=True, repr=False)
class PointsProfile(PrintsShort, Profile):
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


@checked
def profile(points: Any, *, closed: bool = True) -> PointsProfile:
    """Return the profile through points, complex or (x, y). Closed as of a cam, or open as of a slot.

    Raises InvalidMechanism for what are not points; fewer than four are told when the mechanism is built.

    >>> profile([(2, 0), (0, 1), (-2, 0), (0, -1)]).points[1]
    1j
    """
    if not np.iterable(points):
        raise InvalidMechanism(Problem("profile.points", f"{points!r} is not a list of points", "write [(x, y), ...]"))
    return PointsProfile(tuple(place_of(point, f"profile.points[{k}]") for k, point in enumerate(points)), closed)


@dataclass(frozen=True)
class FormulaProfile(HoldsFunction, Profile):
    """A curve by a Python function of a parameter from `low` to `high`. Complex points for an array of parameters."""

    held: ClassVar[str] = "function"

    function: Callable[[Any], Any]
    low: float
    high: float
    closed: bool = True

    kind: ClassVar[str] = "formula"
    keys: ClassVar[tuple[Key, ...]] = ()

    def _made(self) -> Curve:
        return Function(self.function, self.low, self.high, self.closed)


@checked
def formula(function: Callable[[Any], Any], low: float, high: float, *, closed: bool = True) -> FormulaProfile:
    """Return the profile that a Python function traces. Complex points for an array of parameters.

    >>> import numpy as np
    >>> formula(lambda s: 2 * np.cos(s) + 1j * np.sin(s), 0, 2 * np.pi).curve.closed
    True
    """
    return FormulaProfile(function, number_of(low, "profile.low"), number_of(high, "profile.high"), closed)
