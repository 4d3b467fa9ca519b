"""Masses of links, and uniform bars and plates through points."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, NamedTuple, Self

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number, cross, dot
from compoundkin.base.errors import Problem
from compoundkin.model.fields import NameWording, link_key, name_problems, spot_key, value_key
from compoundkin.model.geometry import FRAME, real, vector
from compoundkin.model.loads.contract import NO_RENAMING, ListedLoad, NamedParts


@dataclass(frozen=True, eq=False, repr=False)
class Mass(ListedLoad):
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
    is_steady: ClassVar[bool] = True

    @property
    def name(self) -> str:
        """The name of its link."""
        return self.link

    @property
    def link_keys(self) -> tuple[str, ...]:
        """The fields that name links."""
        return ("link",)

    def renamed(self, links: Mapping[str, str], coordinates: Mapping[str, str] = NO_RENAMING) -> Self:
        """Return the mass of a link of another name."""
        return replace(self, link=links.get(self.link, self.link))

    @property
    def is_complete(self) -> bool:
        """Whether all of its values are given."""
        return self.mass is not None and self.at is not None and self.inertia is not None

    @property
    def is_uniform_bar(self) -> bool:
        """Whether its mass centre and inertia are assumed to be those of a uniform bar."""
        return "mass centre and inertia of a uniform bar" in self.assumed

    def completed(self, points: Mapping[str, Number]) -> Mass:
        """Return the mass with omitted values of a uniform body."""
        if self.is_complete:
            return self
        body = uniform_body(list(points.values()))
        mass = self.mass if self.density is None else self.density * body.extent
        values = [("mass", self.mass), ("mass centre", self.at), ("inertia", self.inertia)]
        left_out = " and ".join(name for name, value in values if value is None)
        return replace(
            self,
            mass=mass,
            at=body.centre if self.at is None else self.at,
            inertia=mass * body.inertia if self.inertia is None else self.inertia,
            density=None,
            assumed=f"{left_out} of a {body.kind} {'-'.join(points)}",
        )

    def problems(self, written: NamedParts, where: str) -> Iterator[Problem]:
        """Find unknown links and points, and invalid numbers."""
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
    (designs, 1). ``mechanism.masses[link].assumed`` lists what was assumed.

    Raises InvalidMechanism for what is no number.

    >>> mass("bar", 0.06, at=(27.5, 0), inertia=20).inertia
    20.0
    """
    where = f"masses.{link}"
    place = at if at is None or isinstance(at, str) else vector(f"{where}.at", at)
    numbers = {"mass": mass, "inertia": inertia, "density": density}
    return Mass(link, at=place, **{key: real(f"{where}.{key}", value) for key, value in numbers.items()})


# A plate with less area than this part of its length squared is a bar: its points are in line but for rounding.
IN_LINE = 1e-9


class UniformBody(NamedTuple):
    """A uniform body: its length or area, its mass centre, and its inertia about that for a unit of mass."""

    kind: str  # "point mass", "uniform bar", "uniform plate"
    extent: Number
    centre: Number
    inertia: Number


def uniform_body(points: list[Number]) -> UniformBody:
    """Return the uniform body through points of a link.

    It is a bar through two points or more in line, else a plate. The plate is the convex hull of its points, in
    whichever order they are written.

    >>> uniform_body([0j, 3 + 0j])
    UniformBody(kind='uniform bar', extent=3.0, centre=(1.5+0j), inertia=0.75)
    >>> uniform_body([0j, 6 + 0j, 3j])[2:]
    ((2+1j), 2.5)
    """
    if len(points) == 1:
        return UniformBody("point mass", 0.0, points[0], 0.0)
    given = np.array(np.broadcast_arrays(*points), dtype=complex)
    bar, plate = _bar(given), _plate(given)
    flat = plate.extent <= IN_LINE * bar.extent**2
    if np.all(flat):
        return UniformBody(bar.kind, *map(_as_number, bar[1:]))
    found = (np.where(flat, one, other) for one, other in zip(bar[2:], plate[2:], strict=True))
    return UniformBody(plate.kind, _as_number(plate.extent), *map(_as_number, found))


def _as_number(value: Number) -> Number:
    return value.item() if np.ndim(value) == 0 else value


def _bar(points: Number) -> UniformBody:
    """Return the bar between the two points that are farthest from each other."""
    first, second = np.triu_indices(len(points), 1)
    gaps = np.abs(points[second] - points[first])
    k = np.argmax(gaps, axis=0)[None]
    length = np.take_along_axis(gaps, k, axis=0)[0]
    centre = np.take_along_axis((points[first] + points[second]) / 2.0, k, axis=0)[0]
    return UniformBody("uniform bar", length, centre, length**2 / 12.0)


def _plate(points: Number) -> UniformBody:
    """Return the plate in the convex hull of points.

    Source: Green's theorem, triangle by triangle from one point: I. N. Bronshtein et al., Handbook of Mathematics.
    """
    middle = np.mean(points, axis=0)
    here, there = _hull_edges(points - middle)
    double = cross(here, there)
    area = np.sum(double, axis=0) / 2.0
    with np.errstate(all="ignore"):
        centre = np.sum((here + there) * double, axis=0) / (6.0 * area)
        a, b = here - centre, there - centre
        polar = np.sum(cross(a, b) * (dot(a, a) + dot(a, b) + dot(b, b)), axis=0) / 12.0
        return UniformBody("uniform plate", area, middle + centre, polar / area)


def _hull_edges(points: Number) -> tuple[Number, Number]:
    """Return the edges of the convex hull, counterclockwise; further edges have zero length.

    Source: R. A. Jarvis, On the identification of the convex hull of a finite set of points in the plane,
    Information Processing Letters 2 (1973) 18-21.
    """
    lowest = np.lexsort((points.real, points.imag), axis=0)[:1]
    start = here = np.take_along_axis(points, lowest, axis=0)[0]
    closed = np.zeros(np.shape(start), dtype=bool)
    edges = []
    for _ in points:
        there = start
        for point in points:
            turn = cross(there - here, point - here)
            farther = (turn == 0) & (np.abs(point - here) > np.abs(there - here))
            there = np.where((turn < 0) | farther, point, there)
        there = np.where(closed, here, there)
        edges.append((here, there))
        here, closed = there, closed | (there == start)
    return np.array([edge[0] for edge in edges]), np.array([edge[1] for edge in edges])
