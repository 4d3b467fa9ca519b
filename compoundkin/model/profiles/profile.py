"""The contract of a profile, and profiles of given shape: a disc, a curve through points, a function."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.copies import CopiesFields, CopiesFunction
from compoundkin.base.curves import Analytic, Curve, Function, Spline
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidMechanism, Problem
from compoundkin.model.fields import Key
from compoundkin.model.geometry import single_number, single_point

# A closed profile with less area than this part of its size squared is a line but for rounding.
NO_AREA = 1e-9


class Profile(CopiesFields, ABC):
    """A profile. Kinds are frozen dataclasses with the keys that a file holds for them."""

    kind: ClassVar[str]  # what it is called in a file
    keys: ClassVar[tuple[Key, ...]]  # none: it cannot be written to a file

    @property
    def oscillates(self) -> bool:
        """Whether its follower oscillates, so that its numbers are angles."""
        return False

    @cached_property
    def curve(self) -> Curve:
        """The curve, in the frame of its link. Raises InvalidMechanism for an invalid one."""
        return self._built_curve()

    @abstractmethod
    def _built_curve(self) -> Curve: ...

    @property
    def circle(self) -> tuple[complex, float] | None:
        """Centre and radius of a circular profile, or None."""
        return None

    def problems(self, where: str) -> Iterator[Problem]:
        """Find problems of the profile, such as too few points or a curve that crosses itself."""
        try:
            found = self.curve.crosses_itself()
        except InvalidMechanism as error:
            yield from (replace(p, where=".".join(filter(None, (where, p.where)))) for p in error.problems)
            return
        if found:
            place = found[0].point
            what = f"the profile crosses itself at ({place.real:.6g}, {place.imag:.6g})"
            yield Problem(where, what, self._loop_remedy())
        elif self.curve.closed and abs(self.curve.samples.area) <= NO_AREA * self.curve.size**2:
            yield Problem(where, "the profile encloses no area: it runs back over itself", "say it is open")

    def _loop_remedy(self) -> str:
        """Return the remedy for a loop."""
        return "change the points that make the loop"


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

    def _built_curve(self) -> Curve:
        return Analytic(lambda s: s.turn() * self.radius + self.middle, 0.0, 2.0 * np.pi, closed=True)

    def problems(self, where: str) -> Iterator[Problem]:
        """Find an invalid radius, and a centre that is not finite."""
        if not (np.isfinite(self.radius) and self.radius > 0):
            yield Problem(f"{where}.radius", f"{self.radius!r} is not a positive length")
        if not np.isfinite(self.middle):
            yield Problem(f"{where}.middle", f"{self.middle!r} is not a finite point")


@checked
def disc(radius: float, middle: Any = 0j) -> DiscProfile:
    """Return the profile of a round disc about a point of its link.

    Raises InvalidMechanism for an invalid number or point.

    >>> disc(20, (5, 0)).circle
    ((5+0j), 20.0)
    """
    return DiscProfile(single_number(radius, "profile.radius"), single_point(middle, "profile.middle"))


@dataclass(frozen=True, repr=False)
class PointsProfile(ShortRepr, Profile):
    """A smooth curve through given points, closed or open."""

    points: tuple[complex, ...]
    closed: bool = True

    kind: ClassVar[str] = "points"
    keys: ClassVar[tuple[Key, ...]] = (
        Key("points", "places", "The points in order, four or more.", required=True),
        Key("closed", "flag", "Whether the last point is followed by the first.", default=True),
    )

    def _built_curve(self) -> Curve:
        return Spline(self.points, self.closed)


@checked
def profile(points: Any, *, closed: bool = True) -> PointsProfile:
    """Return the profile through points, complex or (x, y). Closed as of a cam, or open as of a slot.

    Raises InvalidMechanism for invalid points; the mechanism reports fewer than four.

    >>> profile([(2, 0), (0, 1), (-2, 0), (0, -1)]).points[1]
    1j
    """
    if not np.iterable(points):
        raise InvalidMechanism(Problem("profile.points", f"{points!r} is not a list of points", "write [(x, y), ...]"))
    return PointsProfile(tuple(single_point(point, f"profile.points[{k}]") for k, point in enumerate(points)), closed)


@dataclass(frozen=True)
class FormulaProfile(CopiesFunction, Profile):
    """A curve by a Python function of a parameter from `low` to `high`. Complex points for an array of parameters."""

    function_field: ClassVar[str] = "function"

    function: Callable[[Any], Any]
    low: float
    high: float
    closed: bool = True

    kind: ClassVar[str] = "formula"
    keys: ClassVar[tuple[Key, ...]] = ()

    def _built_curve(self) -> Curve:
        return Function(self.function, self.low, self.high, self.closed)


@checked
def formula(function: Callable[[Any], Any], low: float, high: float, *, closed: bool = True) -> FormulaProfile:
    """Return the profile that a Python function traces. Complex points for an array of parameters.

    >>> import numpy as np
    >>> formula(lambda s: 2 * np.cos(s) + 1j * np.sin(s), 0, 2 * np.pi).curve.closed
    True
    """
    return FormulaProfile(function, single_number(low, "profile.low"), single_number(high, "profile.high"), closed)
