"""Counterweights as masses: from moments of mass to masses at places, and mechanisms with them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from compoundkin.base.arrays import Number, first_entry
from compoundkin.base.errors import InvalidInput, Problem, UnknownName, suggestion
from compoundkin.dynamics.balance.pin_ways import PinWays
from compoundkin.dynamics.work.mass_motion import place_of
from compoundkin.kinematics.motion import Motion
from compoundkin.model.geometry import real
from compoundkin.model.loads import mass as mass_of
from compoundkin.model.mechanism import Mechanism

# The moments of floating links change with their masses: they are settled when they change by less than this part.
SETTLED, ROUNDS = 1e-13, 200
# A moment of mass below this part of mass times size is none.
NOTHING = 1e-12


@dataclass(frozen=True)
class Counterweight:
    """A mass added to a link, at a place in the link's frame.

    Its inertia is that about its own centre. `moment` is its mass times the way to it from the pin by which the link
    hangs on the frame.
    """

    link: str
    moment: complex
    mass: float
    at: complex
    inertia: float

    def text(self, mechanism: Mechanism) -> str:
        """Return it as a line of text."""
        units = mechanism.units
        mass, length = ("", "") if units is None else (f" {units.mass}", f" {units.length}")
        place = f"({self.at.real:.6g}, {self.at.imag:.6g}){length}"
        return f"  {self.link}: {self.mass:.6g}{mass} at {place}, moment of mass {abs(self.moment):.6g}{mass}{length}"


class FindsMoments(Protocol):
    """What finds moments of mass for links whose counterweights have certain masses."""

    def moments(self, links: Sequence[str], added: Mapping[str, float]) -> tuple[Number, float]:
        """Return the moments about the links' pivots, and what is left."""


class CounterweightSizes:
    """The masses, or the distances from the pivots, that counterweights are given."""

    def __init__(self, ways: PinWays, mass: Any, radius: Any, disc: Any) -> None:
        self.ways = ways
        if mass is not None and radius is not None:
            raise InvalidInput(Problem("mass", "mass and radius are both given", "give one of them: moments are found"))
        self.masses, self.radii = _by_link(ways, "mass", mass), _by_link(ways, "radius", radius)
        self.discs = _by_link(ways, "disc", disc, least_is_zero=True)

    def settled(self, solver: FindsMoments, links: tuple[str, ...]) -> tuple[tuple[Counterweight, ...], float]:
        """Return the counterweights of links, and what they leave."""
        added = dict.fromkeys(links, 0.0)
        for _ in range(ROUNDS):
            moments, rest = solver.moments(links, added)
            new = {name: self.mass(name, abs(moment)) for name, moment in zip(links, moments, strict=True)}
            change = max((abs(new[name] - added[name]) for name in links), default=0.0)
            added = new
            if change <= SETTLED * max(added.values(), default=0.0):
                return tuple(self.made(links, moments)), rest
        remedy = "give their masses: mass=..."
        raise InvalidInput(Problem("radius", "no masses at these radii balance the mechanism", remedy))

    def mass(self, link: str, moment: float) -> float:
        """Return the mass of a counterweight, by the length of its moment."""
        if moment <= NOTHING * self._heaviest * self.ways.motion.size:
            return 0.0
        return self.masses[link] if link in self.masses else moment / self._radius(link)

    @property
    def _heaviest(self) -> float:
        return max(float(first_entry(mass.mass)) for mass in self.ways.motion.mechanism.masses.values())

    def _radius(self, link: str) -> float:
        """Return how far a counterweight is from its pivot: without a number, as far as the link's farthest point."""
        if link in self.radii:
            return self.radii[link]
        points = self.ways.motion.mechanism.geometry.points[link].values()
        pivot = self.ways.reached[link].pivot
        return max((abs(complex(np.ravel(p)[0]) - pivot) for p in points), default=0.0) or self.ways.motion.size

    def made(self, links: Sequence[str], moments: Sequence[complex] | Number) -> Iterator[Counterweight]:
        """Yield the counterweights of moments; none where a moment is nothing."""
        for name, moment in zip(links, moments, strict=True):
            mass = self.mass(name, abs(moment))
            if mass:
                at = self.ways.reached[name].pivot + complex(moment) / mass
                yield Counterweight(name, complex(moment), mass, at, 0.5 * mass * self.discs.get(name, 0.0) ** 2)


def _by_link(ways: PinWays, where: str, given: Any, least_is_zero: bool = False) -> dict[str, float]:
    """Return numbers by link, from one for all or a mapping. Raises InvalidInput, UnknownName."""
    if given is None:
        return {}
    known = list(ways.reached)
    found = dict(given) if isinstance(given, Mapping) else dict.fromkeys(known, given)
    for name, value in found.items():
        if name not in ways.motion.links:
            raise UnknownName(Problem(where, f"there is no link {name!r}", suggestion(str(name), known)))
        number = np.empty(0) if value is None else np.ravel(real(where, value))
        if len(number) != 1 or number[0] < 0 or (number[0] == 0 and not least_is_zero):
            raise InvalidInput(Problem(where, f"{value!r} is no {where} of a counterweight", "a number above 0"))
        found[name] = float(number[0])
    return found


def with_counterweights(motion: Motion, counterweights: Sequence[Counterweight]) -> Mechanism:
    """Return the mechanism of a motion with counterweights on its links."""
    own, changed = motion.mechanism.masses, []
    for one in counterweights:
        mass, centre, inertia = 0.0, 0j, 0.0
        if one.link in own:
            known = own[one.link]
            mass, inertia = (float(first_entry(value)) for value in (known.mass, known.inertia))
            centre = complex(np.ravel(place_of(motion, known))[0])
        both = mass + one.mass
        at = (mass * centre + one.mass * one.at) / both
        # of one mass alone it is zero, not what rounding leaves
        spread = mass * one.mass / both * abs(centre - one.at) ** 2
        changed.append(mass_of(one.link, both, at=at, inertia=inertia + one.inertia + spread))
    return motion.mechanism.replace(*changed)
