"""The centres known in a derivation, on a generic instance of the diagram."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from compoundkin.analysis.centres.circle_diagram import Couple, Diagram, couple
from compoundkin.analysis.centres.twist_loops import null_twists
from compoundkin.base.errors import NotDetermined, Problem

# At random coordinates of order one, what is not zero by the graph itself is far above this, rounding far below.
GENERIC = 1e-7

Vector = tuple[float, float, float]


class KnownCentres:
    """The centres found so far, each with the round in which it was found.

    Whether two lines coincide for the graph's own reasons (three links on one pin, loops of slides) is asked at
    random coordinates, where the links' true twists are known from the loop equations. Links that do not move
    relative to each other are one body, known by its first link.

    Raises NotDetermined where the links' motion is not given by the drivers.
    """

    def __init__(self, diagram: Diagram) -> None:
        self.diagram = diagram
        self.generic = [tuple(map(float, p)) for p in diagram.generic()]
        self.rates = np.random.default_rng(1).uniform(0.5, 2.0, max(len(diagram.drives), 1))
        twists, gap = null_twists(diagram, diagram.generic(), [r[()] for r in self.rates])
        if not gap > GENERIC or not diagram.drives:
            what = "the instant centres do not follow from pairs and drivers"
            raise NotDetermined(Problem("links", what, "a locked mechanism, or one with too few drivers, has none"))
        self.twists = twists
        self.body = tuple(next(j for j in range(i + 1) if self._still(j, i)) for i in range(len(diagram.links)))
        self.rounds: dict[Couple, int] = {}
        self.places: dict[Couple, Vector] = {c: self._place(c) for c in self.couples}
        self.own_lines: dict[Couple, list[int]] = {}

    @property
    def bodies(self) -> tuple[int, ...]:
        """The bodies, each by its first link."""
        return tuple(dict.fromkeys(self.body))

    @property
    def couples(self) -> tuple[Couple, ...]:
        """Every two bodies."""
        bodies = self.bodies
        return tuple((i, j) for n, i in enumerate(bodies) for j in bodies[n + 1 :])

    @property
    def unknown(self) -> list[Couple]:
        """The couples whose centre is not found yet."""
        return [c for c in self.couples if c not in self.rounds]

    def knows(self, i: int, j: int) -> bool:
        """Return whether the centre of two bodies is found."""
        return couple(i, j) in self.rounds

    def place(self, i: int, j: int) -> Vector:
        """Return the centre at the generic instance, a unit vector."""
        return self.places[couple(i, j)]

    def line(self, i: int, j: int, via: int) -> Vector | None:
        """Return a line that holds the centre of i and j, a unit vector. None where its two centres are always one."""
        if via < 0:
            return self.generic[-1 - via]  # type: ignore[return-value]
        a = _cross(self.place(i, via), self.place(via, j))
        length = _length(a)
        return (a[0] / length, a[1] / length, a[2] / length) if length > GENERIC else None

    def vias(self, i: int, j: int) -> Iterator[int]:
        """Yield the lines known to hold a centre. Those of the simplest centres first, a pair's own line before all."""
        yield from (-1 - p for p in self.own_lines.get(couple(i, j), ()))
        through = [k for k in self.bodies if k not in (i, j) and self.knows(i, k) and self.knows(k, j)]
        yield from sorted(through, key=lambda k: self._rank(i, k, j))

    def _rank(self, i: int, k: int, j: int) -> tuple[int, int, int]:
        one, other = self.rounds[couple(i, k)], self.rounds[couple(k, j)]
        return max(one, other), one + other, k

    def crossing(self, i: int, j: int) -> tuple[int, int] | None:
        """Return the first two known lines of a centre that differ, or None."""
        lines = [(via, line) for via in self.vias(i, j) if (line := self.line(i, j, via)) is not None]
        for second in range(1, len(lines)):
            for first in range(second):
                if sine(lines[first][1], lines[second][1]) > GENERIC:
                    return lines[first][0], lines[second][0]
        return None

    def _still(self, i: int, j: int) -> bool:
        return bool(np.linalg.norm(self.twists[j] - self.twists[i]) < GENERIC)

    def _place(self, c: Couple) -> Vector:
        relative = self.twists[c[1]] - self.twists[c[0]]
        x, y, w = (relative / np.linalg.norm(relative)).tolist()
        return x, y, w


def sine(a: Vector, b: Vector) -> float:
    """Return the sine of the angle between two unit vectors.

    >>> sine((1.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    1.0
    """
    return _length(_cross(a, b))


def _cross(a: Vector, b: Vector) -> Vector:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def _length(a: Vector) -> float:
    return float((a[0] * a[0] + a[1] * a[1] + a[2] * a[2]) ** 0.5)
