"""Masses of links."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, Self

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.display import PrintsShort
from compoundkin.base.errors import Problem
from compoundkin.base.series import Number
from compoundkin.model.fields import DeclaredKeys, NameWording, link_key, name_problems, spot_key, value_key
from compoundkin.model.geometry import FRAME, real, vector
from compoundkin.model.loads.contract import NO_NAMES, WrittenNames
from compoundkin.model.loads.uniform_bodies import uniform_body


@dataclass(frozen=True, eq=False, repr=False)
class Mass(PrintsShort):
    """The mass of a link, its mass centre `at`, its inertia about that.

    The mass centre is a letter, or a place in the link's frame. What is left out is that of a uniform bar or plate
    through the link's points, and `assumed` says so; the masses of a mechanism hold them all.
    """

    link: str = field(metadata=link_key("The link whose mass it is."))
    mass: Number = field(default=None, metadata=value_key("length", "The mass."))
    at: Any = field(
        default=None,
        metadata=spot_key(
            "link", "The mass centre: a point, or a place in the link's frame; of a uniform bar or plate."
        ),
    )
    inertia: Number = field(
        default=None, metadata=value_key("length", "Inertia about the mass centre; that of a uniform bar or plate.")
    )
    density: Number | None = field(
        default=None, metadata=value_key("length", "Mass for each length of a bar, each area of a plate, in its place.")
    )
    assumed: str = field(default="", kw_only=True)

    title: ClassVar[str] = "mass"
    table: ClassVar[str] = "masses"
    keys = DeclaredKeys()

    @property
    def name(self) -> str:
        """The name of its link."""
        return self.link

    @property
    def link_keys(self) -> tuple[str, ...]:
        """The fields that name links."""
        return ("link",)

    def renamed(self, links: Mapping[str, str], coordinates: Mapping[str, str] = NO_NAMES) -> Self:
        """Return it on a link of another name."""
        return replace(self, link=links.get(self.link, self.link))

    @property
    def is_complete(self) -> bool:
        """Whether nothing of it is left out."""
        return self.mass is not None and self.at is not None and self.inertia is not None

    def completed(self, points: Mapping[str, Number]) -> Mass:
        """Return it with what is left out, as of a uniform body."""
        if self.is_complete:
            return self
        body = uniform_body(list(points.values()))
        mass = self.mass if self.density is None else self.density * body.extent
        told = [("mass", self.mass), ("mass centre", self.at), ("inertia", self.inertia)]
        left_out = " and ".join(name for name, value in told if value is None)
        return replace(
            self,
            mass=mass,
            at=body.centre if self.at is None else self.at,
            inertia=mass * body.inertia if self.inertia is None else self.inertia,
            density=None,
            assumed=f"{left_out} of a {body.kind} {'-'.join(points)}",
        )

    def problems(self, written: WrittenNames, where: str) -> Iterator[Problem]:
        """Find unknown links and points, and numbers that no mass has."""
        if self.link == FRAME:
            yield Problem(f"{where}.link", "the frame does not move: its mass does nothing", "name a link that moves")
            return
        yield from name_problems(self, written.letters, where, NameWording(verb="weigh"))
        if (self.mass is None) == (self.density is None):
            what = "neither mass nor density is given" if self.mass is None else "mass and density are both given"
            yield Problem(where, what, "give one of them")
        if self.density is not None and len(written.letters.get(self.link, ())) == 1:
            yield Problem(f"{where}.density", "a link of one point has no length", "give its mass")
        for key, value in (("mass", self.mass), ("density", self.density)):
            if value is not None and not np.all(np.asarray(value) > 0.0):
                yield Problem(f"{where}.{key}", f"a {key} is above zero, not {_least(value):g}")
        if self.inertia is not None and not np.all(np.asarray(self.inertia) >= 0.0):
            yield Problem(f"{where}.inertia", f"an inertia is not negative, as {_least(self.inertia):g}")


def _least(value: Number) -> float:
    return float(np.min(value))


@checked
def mass(link: str, mass: Any = None, *, at: Any = None, inertia: Any = None, density: Any = None) -> Mass:
    """Return the mass of a link with its mass centre and inertia.

    The mass is in the mechanism's unit. `at` is a letter of the link, or a place in its frame; the inertia is in
    units of mass times length squared. Left out, they are those of a uniform bar through the link's points, if these
    are in line, else of the uniform plate in their convex hull; a link of one point is a point mass. ``density=`` in
    place of a mass is for each unit of length of the bar, or of area of the plate. Numbers, or arrays for designs,
    (designs, 1). What was assumed is told by `assumed` of ``mechanism.masses[link]``.

    Raises InvalidMechanism for what is no number.

    >>> mass("bar", 0.06, at=(27.5, 0), inertia=20).inertia
    20.0
    """
    where = f"masses.{link}"
    place = at if at is None or isinstance(at, str) else vector(f"{where}.at", at)
    numbers = {"mass": mass, "inertia": inertia, "density": density}
    return Mass(link, at=place, **{key: real(f"{where}.{key}", value) for key, value in numbers.items()})
