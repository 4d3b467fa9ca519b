"""Conditions of full force balance: which moments of mass on links keep the mechanism's mass centre at rest.

A link reached from the frame through pins has its origin at a sum of constants times the unit vectors of links; every
further pin closes a sum of them. Links that slides join turn alike. The mass centre is such a sum, too; it rests where
the sum is one of those that the loops keep constant: complex linear equations in the moments of mass.

Source: R. S. Berkof and G. G. Lowen, A new method for completely force balancing simple linkages, J. Engineering for
Industry 91, 1969, 21-26; F. R. Tepper and G. G. Lowen, General theorems concerning full force balancing of planar
linkages by internal mass redistribution, J. Engineering for Industry 94, 1972, 789-796.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from compoundkin.base.arrays import Number, first_entry
from compoundkin.base.display import ShortRepr
from compoundkin.dynamics.mass_motion import mass_centre_place
from compoundkin.kinematics.motion import Motion
from compoundkin.model.geometry import FRAME
from compoundkin.model.pairs import Pair
from compoundkin.structure.cycles import find

# The mass centre rests where its remaining travel is below this part of the masses' travel.
BALANCED = 1e-9


class BalanceConditions:
    """The conditions of full force balance of one design; residuals are relative to `scale`."""

    def __init__(self, ways: PinDirections, closed: bool) -> None:
        self.ways = ways
        self.masses = {name: complex(first_entry(mass.mass)) for name, mass in ways.motion.mechanism.masses.items()}
        # a motion shorter than a cycle may seem to have more dependent rows, as its vectors move little
        rows = [dependent_rows(ways)] if closed else []
        # the null space of loops and dependent rows; a row of zeros where there are none
        rows += [ways.loops / ways.motion.size, np.zeros((1, ways.count))]
        _, sizes, right = np.linalg.svd(np.vstack(rows), full_matrices=True)
        rank = int(np.count_nonzero(sizes > BALANCED * max(sizes, default=0.0)))
        self._left = right[rank:]
        self.total = self._total()
        self.scale = sum(abs(mass) for mass in self.masses.values()) * ways.motion.size

    @property
    def unreached(self) -> tuple[str, ...]:
        """The links with mass that no chain of pins joins to the frame."""
        return tuple(name for name, mass in self.masses.items() if name not in self.ways.origins and mass != 0)

    def _total(self) -> Number:
        """Return the row of the mass centre of all links that pins join to the frame."""
        motion, found = self.ways.motion, np.zeros(self.ways.count, dtype=complex)
        for name, mass in motion.mechanism.masses.items():
            if name in self.ways.origins:
                place = complex(np.ravel(mass_centre_place(motion, mass))[0])
                found = found + self.masses[name] * self.ways.row(name, place)
        return found

    def pivot_row(self, link: str) -> Number:
        """Return the row of the pin through which a link is reached. Zero for a link pinned to the frame."""
        return self.ways.row(link, self.ways.reached[link].pivot)

    def left(self, row: Number) -> Number:
        """Return a row projected to the null space of the loops."""
        return np.conj(self._left) @ row

    def moments(self, links: Sequence[str], added: Mapping[str, float]) -> tuple[Number, float]:
        """Return the moments of mass about their pivots that counterweights on links must have.

        `added` are the masses of the counterweights. Also returns the unbalanced rest, relative to the scale.
        """
        total = self.total + sum((added[name] * self.pivot_row(name) for name in links), 0j)
        columns = self._columns(links)
        wanted = -self.left(total)
        found = np.linalg.lstsq(columns, wanted, rcond=None)[0] if len(links) else np.empty(0, dtype=complex)
        rest = float(np.max(np.abs(columns @ found - wanted), initial=0.0))
        return found, rest / self.scale if self.scale else 0.0

    def chosen(self) -> tuple[str, ...]:
        """Return links whose counterweights balance, those nearest to the frame first."""
        order = sorted(self.ways.reached, key=lambda name: self.ways.reached[name].depth)
        links: list[str] = []
        for name in (name for name in order if name != FRAME and name in self.ways.turning):
            nothing = dict.fromkeys([*links, name], 0.0)
            if self.moments(links, nothing)[1] <= BALANCED:
                break
            if np.linalg.matrix_rank(self._columns([*links, name]), tol=BALANCED) > len(links):
                links.append(name)
        return tuple(links)

    def _columns(self, links: Sequence[str]) -> Number:
        rows = [self.left(self.ways.unit(name)) for name in links]
        return np.array(rows, dtype=complex).reshape(len(links), len(self._left)).T

    @property
    def pinned(self) -> tuple[str, ...]:
        """The links pinned to the frame that turn."""
        return tuple(name for name, one in self.ways.reached.items() if one.depth == 1 and name in self.ways.turning)


# Unit vectors of links over a closed cycle are dependent where a combination of them is below this part of the largest.
DEPENDENT = 1e-9


@dataclass(frozen=True)
class ReachedLink:
    """The chain of pins from the frame to a link: parent, place `pivot` of the pin on it, number of pins."""

    parent: str
    pivot: complex
    depth: int


@dataclass(frozen=True, eq=False, repr=False)
class PinDirections(ShortRepr):
    """Places on links as sums of unit vectors along chains of pins, of one design of a motion.

    Rows are over `turning`, classes of links that turn alike: a row times their unit vectors is a place, except for
    constants. `origins` has the row of every link that pins join to the frame.
    """

    motion: Motion
    turning: dict[str, int]  # the class of every moving link that turns
    factors: dict[str, complex]  # the constant turn of a link in its class; of one that does not turn, in the frame
    reached: dict[str, ReachedLink]
    origins: dict[str, Number]

    @property
    def count(self) -> int:
        """How many classes there are."""
        return len(set(self.turning.values()))

    def row(self, link: str, place: complex) -> Number:
        """Return the row of a place on a link."""
        return self.origins[link] + self.unit(link) * place

    def unit(self, link: str) -> Number:
        """Return the row of a link's unit vector. Zero for a link that does not turn."""
        found = np.zeros(self.count, dtype=complex)
        if link in self.turning:
            found[self.turning[link]] = self.factors[link]
        return found

    @cached_property
    def loops(self) -> Number:
        """The rows that further pins keep constant, (loops, classes)."""
        rows = [self.row(a, p) - self.row(b, q) for a, p, b, q in _pins(self.motion)
                if a in self.origins and b in self.origins]  # fmt: skip
        return np.array(rows, dtype=complex).reshape(len(rows), self.count)

    @cached_property
    def vectors(self) -> Number:
        """The unit vectors of the classes at all poses, (classes, poses)."""
        first = {number: link for link, number in reversed(self.turning.items())}
        poses = self.motion.inputs.poses
        return np.array([np.broadcast_to(self.motion.poses[first[k]].u.c[0], (1, poses))[0] / self.factors[first[k]]
                         for k in range(self.count)])  # fmt: skip


def pin_directions(motion: Motion) -> PinDirections:
    """Return the chains of pins of a motion of one design."""
    classes, factors = _classes(motion)
    ways = PinDirections(motion, classes, factors, {}, {FRAME: np.zeros(len(set(classes.values())), dtype=complex)})
    pins, depth = list(_pins(motion)), 0
    while True:
        depth += 1
        new: dict[str, ReachedLink] = {}
        for a, _, b, q in (*pins, *((b, q, a, p) for a, p, b, q in pins)):
            if a in ways.origins and b not in ways.origins and b not in new:
                new[b] = ReachedLink(a, q, depth)
        if not new:
            return ways
        origins = {b: _origin(ways, pins, one, b) for b, one in new.items()}
        ways.reached.update(new)
        ways.origins.update(origins)


def _origin(ways: PinDirections, pins: list[tuple[str, complex, str, complex]], one: ReachedLink, link: str) -> Number:
    both = (*pins, *((b, q, a, p) for a, p, b, q in pins))
    at = next(p for a, p, b, q in both if (a, b, q) == (one.parent, link, one.pivot))
    return ways.row(one.parent, at) - ways.unit(link) * one.pivot


def _pins(motion: Motion) -> Iterator[tuple[str, complex, str, complex]]:
    """Yield the pins: a link, the place on it, the other link, the place on that."""
    for pair in motion.structure.pairs:
        if pair.is_simple and pair.free_is_angle:
            (a, b), ends = pair.members, motion.inputs.ends[pair.name]
            yield a, _number(ends[0].point), b, _number(ends[1].point)


def _number(value: Number) -> complex:
    return complex(np.ravel(value)[0])


def _classes(motion: Motion) -> tuple[dict[str, int], dict[str, complex]]:
    """Return the classes of links that turn alike, without that of the frame, and each link's turn in its class."""
    leader = {name: name for name in motion.links}
    for pair in motion.structure.pairs:
        if turns_alike(pair):
            one, other = (find(leader, name) for name in pair.members)
            leader[other if one == FRAME else one] = one if one == FRAME else other
    leaders = {name: find(leader, name) for name in motion.links}
    numbers = {name: k for k, name in enumerate(dict.fromkeys(v for v in leaders.values() if v != FRAME))}
    units = {name: _number(motion.poses[name].u.c[0]) for name in leaders}
    factors = {name: units[name] / units[leaders[name]] for name in leaders}
    return {name: numbers[v] for name, v in leaders.items() if v != FRAME}, factors


def turns_alike(pair: Pair) -> bool:
    """Return whether a pair keeps the angle between its two links constant."""
    return pair.is_simple and not pair.free_is_angle


def dependent_rows(ways: PinDirections) -> Number:
    """Return the rows that are constant over the poses, (rows, classes)."""
    vectors = np.vstack([np.ones(ways.vectors.shape[1]), ways.vectors])
    _, sizes, right = np.linalg.svd(vectors.T, full_matrices=False)
    return np.conj(right[sizes <= DEPENDENT * sizes[0]])[:, 1:]
