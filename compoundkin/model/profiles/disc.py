"""The round disc, an eccentric where its middle is not the axis of its link."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from compoundkin.base.curves import Analytic, Curve
from compoundkin.base.errors import Problem
from compoundkin.model.fields import Key
from compoundkin.model.profiles.contract import Profile, number_of, place_of


@dataclass(frozen=True)
class Disc(Profile):
    """A round disc, an eccentric if its `middle` is not the axis of its link."""

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
        """A radius that is none, a middle that is nowhere."""
        if not (np.isfinite(self.radius) and self.radius > 0):
            yield Problem(f"{where}.radius", f"{self.radius!r} is not a positive length")
        if not np.isfinite(self.middle):
            yield Problem(f"{where}.middle", f"{self.middle!r} is not a finite point")


def disc(radius: float, middle: Any = 0j) -> Disc:
    """The profile of a round disc of a radius about a point of its link, (x, y) or complex.

    Raises InvalidMechanism for what is no number or no point.

    >>> disc(20, (5, 0)).circle
    ((5+0j), 20.0)
    """
    return Disc(number_of(radius, "profile.radius"), place_of(middle, "profile.middle"))
