"""Masses of links, and the gravity that gives them weight."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from compoundkin.base.arguments import checked
from compoundkin.base.display import PrintsShort
from compoundkin.base.series import Number
from compoundkin.model.geometry import real, vector


@dataclass(frozen=True, eq=False, repr=False)
class Mass(PrintsShort):
    """The mass of a link, its mass centre `at`, its inertia about that.

    The mass centre is a place in the link's frame, or a letter.
    """

    link: str
    mass: Number
    at: Number | str
    inertia: Number

    @property
    def name(self) -> str:
        """The name of its link."""
        return self.link

    @property
    def link_keys(self) -> tuple[str, ...]:
        """The fields that name links."""
        return ("link",)


@checked
def mass(link: str, mass: Any, *, at: Any = 0j, inertia: Any = 0.0) -> Mass:
    """Return the mass of a link, in the mechanism's units.

    >>> mass("bar", 0.06, at=(27.5, 0), inertia=20).inertia
    20.0
    """
    where = f"masses.{link}"
    place = at if isinstance(at, str) else vector(f"{where}.at", at)
    return Mass(link, real(f"{where}.mass", mass), place, real(f"{where}.inertia", inertia))


@dataclass(frozen=True, eq=False, repr=False)
class Gravity(PrintsShort):
    """The acceleration of free fall, m/s^2 whatever the unit of length."""

    vector: Number
    name: str = ""


@checked
def gravity(x: Any, y: Any) -> Gravity:
    """Return gravity as a vector, m/s^2 whatever the unit of length.

    >>> gravity(0, -9.81).vector
    -9.81j
    """
    return Gravity(vector("gravity", (x, y)))
