"""What a pair adds to vector-loop equations: unknowns, sums of them, vectors, and equations of its own."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from compoundkin.base.arrays import wrapped
from compoundkin.base.poses import Pose
from compoundkin.base.series import Number, Series, as_series
from compoundkin.model.pairs.loop_vectors import Sum, Term, Unknown, Values, Vector, angle_of, turned


@dataclass(frozen=True, eq=False)
class Auxiliary:
    """An equation of angles and displacements that a pair adds: ``sum = 0``.

    With a direction `along` the part of a vector sum in that direction is added: the `path` from the first of the
    pair's points to the second, through other pairs, as where a rack is held to its pinion. Angles count whole turns
    only where the pair does (`counts_turns`).
    """

    pair: str
    sum: Sum
    path: tuple[Term, ...] = ()
    along: Sum | None = None
    counts_turns: bool = False

    def at(self, values: Values) -> Number:
        """Return what is to be zero."""
        total = self.sum.at(values)
        if self.along is not None:
            vector = sum((term.at(values) for term in self.path), 0j)
            total = total + (vector * np.exp(-1j * self.along.at(values))).real
        return total if self.counts_turns else wrapped(total)


@dataclass(frozen=True, eq=False)
class Implicit:
    """An equation of a pair of which only the value is known. A `function` of its members' poses is zero.

    The pose of a member follows from its angle and from the way, by the terms of `ways`, from the pair's side on the
    first member (the first of `points`) to that on it. With a `result` the function has this unknown's value.
    `number` tells the equations of one pair from each other. What is to be zero is a length, or an angle.
    """

    pair: str
    number: int
    members: tuple[str, ...]
    points: tuple[Number, ...]
    function: Callable[[tuple[Pose, ...]], Series]
    ways: tuple[tuple[Term, ...], ...] = ()
    result: Unknown | None = None
    is_angle: bool = False
    counts_turns: ClassVar[bool] = True

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """The unknowns of the function: angles of links, and what ways leave free."""
        sums = [angle_of(name) for name in self.members]
        for term in (term for way in self.ways for term in way):
            sums += [term.angle, term.length if isinstance(term, Vector) else term.argument]
        return tuple(dict.fromkeys(unknown for own in sums for _, unknown in own.parts))

    def series(self, values: Values) -> Series:
        """Return what is to be zero, where unknowns move in time."""
        places = (0j, *(sum((term.at(values) for term in way), 0j) for way in self.ways))
        angles = (angle_of(name).at(values) for name in self.members)
        found = self.function(tuple(map(_pose, places, self.points, angles)))
        return found if self.result is None else found - values[self.result.key]

    def at(self, values: Values) -> Number:
        """Return what is to be zero."""
        return self.series(values).c[0]


def _pose(at: Number, point: Number, angle: Number) -> Pose:
    """The pose of a link turned by an angle, whose point is at a place."""
    u = turned(angle, 1.0)
    return Pose(as_series(at - u * point), as_series(u), as_series(angle))


@dataclass(frozen=True, eq=False)
class LoopTerms:
    """The terms that a pair adds to vector loops. How a loop crosses it, and equations of its own.

    A loop runs from the point on its first member to that on its second one, along `arms`; a `label` names each
    point. `unknowns` are what the pair leaves free, its coordinate first; none for a pin. No loop runs through a pair
    that does not join its members for themselves (`is_crossed`), such as a gear pair.
    """

    points: tuple[Number, Number]
    labels: tuple[str, str]
    arms: tuple[Term, ...] = ()
    unknowns: tuple[Unknown, ...] = ()
    equations: tuple[Auxiliary | Implicit, ...] = ()
    is_crossed: bool = True
