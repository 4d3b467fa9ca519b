"""The profile through given points."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from compoundkin.base.curves import Curve, Spline
from compoundkin.base.errors import InvalidMechanism, Problem
from compoundkin.model.fields import Key
from compoundkin.model.profiles.contract import Profile, place_of


@dataclass(frozen=True)
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


def profile(points: Any, *, closed: bool = True) -> Points:
    """The profile through points, complex or (x, y): closed as of a cam, or open as of a slot.

    Raises InvalidMechanism for what are not points; fewer than four are told when the mechanism is built.

    >>> profile([(2, 0), (0, 1), (-2, 0), (0, -1)]).points[1]
    1j
    """
    if not np.iterable(points):
        raise InvalidMechanism(Problem("profile.points", f"{points!r} is not a list of points", "write [(x, y), ...]"))
    return Points(tuple(place_of(point, f"profile.points[{k}]") for k, point in enumerate(points)), closed)
