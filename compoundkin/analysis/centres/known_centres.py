"""The centres known in a derivation, on a generic instance of the diagram whose twists solve the loop equations.

This is an independent route to the centres. Around every loop the relative twists add up to zero: sum of
``omega (x, y, 1)`` over its pairs, a slide's (x, y, 0) at infinity. The null vector of these equations gives every
link's twist but for one factor. A twist (x, y, w) is the homogeneous instant centre with its length:
``velocity(p) = 1j (w p - (x + 1j y))``.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from compoundkin.analysis.centres.circle_diagram import Couple, Diagram, couple
from compoundkin.analysis.centres.homogeneous import norm
from compoundkin.base.arrays import Number
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


Path = dict[int, int]  # edge of the diagram -> +1 or -1 as it is run through


@dataclass(frozen=True)
class TwistLoops:
    """Independent loops, and the way to every link, as signed edges. The way is from the first link of its part."""

    loops: tuple[Path, ...]
    paths: tuple[Path, ...]
    connected: bool


def loops_of(diagram: Diagram) -> TwistLoops:
    """Return the fundamental loops of a breadth-first tree."""
    paths: dict[int, Path] = {0: {}}
    tree: set[int] = set()
    for link in (queue := [0]):
        for e, (first, second, _) in enumerate(diagram.edges):
            for here, there, sign in ((first, second, 1), (second, first, -1)):
                if here == link and there not in paths:
                    paths[there] = {**paths[here], e: sign}
                    tree.add(e)
                    queue.append(there)
    reached = [(e, a, b) for e, (a, b, _) in enumerate(diagram.edges) if e not in tree and a in paths and b in paths]
    loops = tuple(_sum({**paths[a]}, {e: 1}, paths[b]) for e, a, b in reached)
    return TwistLoops(
        loops, tuple(paths.get(k, {}) for k in range(len(diagram.links))), len(paths) == len(diagram.links)
    )


def _sum(there: Path, across: Path, back: Path) -> Path:
    total = {**there, **across}
    for e, sign in back.items():
        total[e] = total.get(e, 0) - sign
    return {e: sign for e, sign in total.items() if sign}


def null_twists(diagram: Diagram, places: Sequence[Number], rates: Sequence[Number]) -> tuple[Number, Number]:
    """Return every link's twist relative to the first, but for a common factor.

    Of shape (links, 3, poses). And the gap.
    `places` are the primaries' unit coordinates (3, poses), `rates` the amplitudes of the drivers on them. With
    one driver the rate does not matter. The gap is the second smallest singular value over the largest: where
    it is near zero the pose is singular and the twists say nothing.
    """
    loops = loops_of(diagram)
    bases = [_basis(places[k], diagram.primaries[k].kind) for _, _, k in diagram.edges]
    starts = np.cumsum([0, *[len(basis) for basis in bases]])
    poses = np.broadcast_shapes(*[place.shape[1:] for place in places])
    columns, rows = int(starts[-1]), 3 * len(loops.loops)
    extra = _driver_rows(diagram, starts, rates)
    matrix = np.zeros((*poses, rows + len(extra), columns))
    for row, path in enumerate(loops.loops):
        for e, sign in path.items():
            for b, vector in enumerate(bases[e]):
                for axis in range(3):
                    matrix[..., 3 * row + axis, starts[e] + b] = sign * vector[axis]
    for row, entries in enumerate(extra):
        for column, value in entries.items():
            matrix[..., rows + row, column] = value
    omega, gap = _null_vector(matrix)
    return _along(loops, bases, starts, omega), gap


def _basis(place: Number, kind: str) -> list[Number]:
    """Return the directions a relative twist may have. The centre itself, two points of its line, or none."""
    if kind == "weld":
        return []
    if kind != "line":
        return [place]
    # Householder: the reflection that takes the line's vector to the third axis takes the plane to the other two
    v = place.copy()
    v[2] += np.where(place[2] < 0.0, -1.0, 1.0)
    scale = 2.0 / norm(v) ** 2
    unit = np.eye(3)
    return [unit[k].reshape(3, *[1] * (place.ndim - 1)) - scale * v[k] * v for k in range(2)]


def _driver_rows(diagram: Diagram, starts: Number, rates: Sequence[Number]) -> list[dict[int, Number]]:
    """Return one row for every two drivers. Their amplitudes are in the ratio of their rates."""
    shares = [_amplitude(diagram, starts, k) for k in range(len(diagram.drives))]
    found = []
    for a in range(len(shares)):
        for b in range(a):
            row = {c: sign * rates[a] for c, sign in shares[b].items()}
            for c, sign in shares[a].items():
                row[c] = row.get(c, 0.0) - sign * rates[b]
            found.append(row)
    return found


def _amplitude(diagram: Diagram, starts: Number, k: int) -> dict[int, int]:
    """Return the columns whose amplitudes add up to a driver's."""
    drive = diagram.drives[k]
    share = {}
    for e, (_, second, primary) in enumerate(diagram.edges):
        if primary == drive.primary and second in (drive.first, drive.second):
            share[int(starts[e])] = 1 if second == drive.second else -1
    return share


def _null_vector(matrix: Number) -> tuple[Number, Number]:
    good = np.isfinite(matrix).all(axis=(-2, -1))
    columns = matrix.shape[-1]
    _, s, vh = np.linalg.svd(np.where(good[..., None, None], matrix, 0.0))
    padded = np.zeros((*s.shape[:-1], max(columns, s.shape[-1])))
    padded[..., : s.shape[-1]] = s
    second = padded[..., columns - 2] if columns > 1 else np.ones(s.shape[:-1])
    largest = padded[..., 0] if s.shape[-1] else np.ones(s.shape[:-1])
    gap = np.where(good, second / np.where(largest > 0.0, largest, 1.0), np.nan)
    # a frame alone has no twists
    vector = vh[..., -1, :] if columns else np.zeros((*good.shape, 0))
    return np.where(good[..., None], vector, np.nan), gap


def _along(loops: TwistLoops, bases: list[list[Number]], starts: Number, omega: Number) -> Number:
    twists = np.zeros((len(loops.paths), 3, *omega.shape[:-1]))
    for link, path in enumerate(loops.paths):
        for e, sign in path.items():
            for b, vector in enumerate(bases[e]):
                twists[link] += sign * omega[..., starts[e] + b] * vector
    return twists
