"""Pairs of dyads on one body that meet poses and points, all of them, by continuation.

Places of the body's origin are taken from the first one, its orientations from that there. A dyad has its fixed pivot
at a and its joint on the body at x; where the origin is at d and the body turned by u its length is what it was at
first:

    (d - a + u x) (d* - a* + x* / u) = (x - a) (x* - a*)

for a conjugate as an unknown of its own (isotropic coordinates), so that all solutions are followed, the complex ones
too. A pose gives such an equation for each dyad; a point has u as an unknown beside, and gives one. With m poses after
the first and n points 2 m + n = 8 equations determine x, a of one dyad and y, b of the other. Of 1 pose and 8 points
(nine points) the three cognates in both orders are one class. A fixed pivot that is given is worth two equations.

The unknowns u of points are eliminated in each of Newton's steps, which leaves eight linear equations. Solutions of a
generic complex instance were found by monodromy once for each family and are shipped (`monodromy`, `STARTS`); those of
any task follow from them as its positions are moved there, on straight roads from start positions that are turned by a
complex factor.

Sources: C. W. Wampler, A. P. Morgan, A. J. Sommese, Complete solution of the nine-point path synthesis problem for
four-bar linkages, J. Mech. Des. 114 (1992) 153-159; B. Roth, F. Freudenstein, Synthesis of path-generating mechanisms
by numerical methods, J. Eng. Ind. 85 (1963) 298-304; A. P. Morgan, C. W. Wampler, Solving a planar four-bar design
problem using continuation, J. Mech. Des. 112 (1990) 544-550 (five points and given pivots); D. A. Brake, J. D.
Hauenstein, A. P. Murray, D. H. Myszka, C. W. Wampler, The complete solution of Alt-Burmester synthesis problems for
four-bar linkages, J. Mech. Rob. 8 (2016) 041018; T. Duff et al., Solving polynomial systems via homotopy continuation
and monodromy, IMA J. Numer. Anal. 39 (2019) 1421-1446.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.continuation import Corrector, Homotopy, StepLengths, follow_paths
from compoundkin.base.linear import eliminated

# The numbers of a pair, each with its conjugate beside it: the joint and the fixed pivot of the one dyad, then of the
# other, from the first place.
X, A, Y, B = (slice(k, k + 2) for k in (0, 2, 4, 6))
NUMBERS = 8

# Steps along the roads, by parts of the numbers; smaller ones where paths were lost or came to one end.
LENGTHS = StepLengths(first=1e-3, longest=0.1, shortest=1e-10, easy=6000, most=6000)
# A number is measured against itself, or where it is nearly zero against this part of the positions.
SMALL = 1e-3
NEAR, GOAL, ACCURATE = 1e-3, 2e-4, 1e-6
CAREFUL = 1.0 / 50.0
# So many roads at most; none after one that leads to nothing new.
ROADS = 6
# Two pairs whose symmetric functions differ by less than this part are one.
ALIKE = 1e-6
# A pair is met where Newton's last step is below this part, real where its conjugates are so alike.
MET, REAL = 1e-7, 1e-6
SEED = 1


class Family(NamedTuple):
    """Poses after the first, points, and fixed pivots that are given."""

    poses: int
    points: int
    pivots: int

    @property
    def places(self) -> int:
        """How many places the origin takes after the first."""
        return self.poses + self.points

    @property
    def unknown(self) -> tuple[Number, Number]:
        """Which of the eight numbers are unknown: of the one dyad, of the other."""
        one = [0, 1] if self.pivots else [0, 1, 2, 3]
        return np.array(one), np.array([4, 5] if self.pivots > 1 else [4, 5, 6, 7])


# How many pairs of dyads each family has, with cognates and exchanged dyads as one: nine points (Wampler, Morgan and
# Sommese, 1992), poses and points (Brake et al., 2016), seven points and a given pivot, five points and both pivots
# (Morgan and Wampler, 1990); all found again by `monodromy`.
COUNTS: dict[Family, int] = {
    Family(0, 8, 0): 1442,
    Family(1, 6, 0): 1112,
    Family(2, 4, 0): 201,
    Family(3, 2, 0): 30,
    Family(0, 6, 1): 243,
    Family(0, 4, 2): 36,
}


class DesignPositions(NamedTuple):
    """Places `d` after the first with their conjugates `e`, poses before points, and the orientations `u` of poses.

    `ground` are the given fixed pivots with their conjugates beside them (2 pivots). All complex; scaled to about one.
    """

    d: Number
    e: Number
    u: Number
    ground: Number

    @property
    def family(self) -> Family:
        """The family of tasks that they belong to."""
        return Family(len(self.u), len(self.d) - len(self.u), len(self.ground) // 2)

    def turned(self, by: complex, conjugate: complex) -> DesignPositions:
        """Return them with all places multiplied by a number, their conjugates by another."""
        ground = self.ground.copy()
        ground[0::2] *= by
        ground[1::2] *= conjugate
        return DesignPositions(by * self.d, conjugate * self.e, self.u, ground)


@dataclass(frozen=True, eq=False)
class Pairs:
    """Pairs of dyads (numbers, pairs) with the orientations (points, pairs), complex ones too.

    `count` is how many there are for generic positions of this kind.
    """

    numbers: Number
    u: Number
    count: int

    def real(self) -> Pairs:
        """Return the pairs that exist."""
        n = self.numbers
        same = np.abs(n[0::2] - n[1::2].conj()) < REAL * (1.0 + np.abs(n[0::2]))
        good = same.all(axis=0) & (np.abs(np.abs(self.u) - 1.0) < REAL).all(axis=0)
        return Pairs(n[:, good], self.u[:, good], self.count)


class _Road:
    """Positions that move from some to others, straight; orientations on logarithmic spirals."""

    def __init__(self, start: DesignPositions, end: DesignPositions) -> None:
        self.family = start.family
        self._start = DesignPositions(*(part[:, None] for part in start))
        self._change = DesignPositions(*((b - a)[:, None] for a, b in zip(start, end, strict=True)))
        self._spin = np.log(end.u / start.u)[:, None]

    def at(self, t: Number) -> tuple[DesignPositions, DesignPositions]:
        """Return the positions at t (paths,) and their derivatives by it."""
        here = DesignPositions(*(a + t * b for a, b in zip(self._start, self._change, strict=True)))
        u = self._start.u * np.exp(t * self._spin)
        return here._replace(u=u), self._change._replace(u=self._spin * u)

    def homotopy(self) -> Homotopy:
        """Return Newton's steps and slopes of the unknown numbers and orientations."""

        def steps(_: Number, x: Number, t: Number) -> tuple[Number, Number]:
            return _newton(self.family, x, *self.at(t))

        return steps


class _DyadEquations(NamedTuple):
    """The equations of one dyad at all places (places, paths): residuals, derivatives by x, x*, a, a*, by t, by u."""

    value: Number
    by_numbers: Number
    by_t: Number
    by_u: Number


def _dyad(numbers: Number, u: Number, at: DesignPositions, change: DesignPositions) -> _DyadEquations:
    x, xc, a, ac = numbers
    w = 1.0 / u
    forth, back = u * x + (at.d - a), w * xc + (at.e - ac)
    arm, arm_back = x - a, xc - ac
    by_numbers = np.stack([u * back - arm_back, w * forth - arm, arm_back - back, arm - forth], axis=1)
    by_t = change.d * back + change.e * forth
    by_u = x * back - w * w * (xc * forth)
    by_t[: len(change.u)] += by_u[: len(change.u)] * change.u
    return _DyadEquations(forth * back - arm * arm_back, by_numbers, by_t, by_u)


def _newton(family: Family, unknowns: Number, at: DesignPositions, change: DesignPositions) -> tuple[Number, Number]:
    """Return Newton's steps and slopes (unknowns, paths) at positions that change so."""
    m, (first, second) = family.poses, family.unknown
    size = len(first) + len(second)
    numbers = _whole(family, unknowns[:size], at.ground)
    u = np.concatenate([at.u, unknowns[size:]])
    one, other = _dyad(numbers[:4], u, at, change), _dyad(numbers[4:], u, at, change)
    for k in range(family.pivots):
        dyad = (one, other)[k]
        dyad.by_t[:] += np.einsum("kcp,cp->kp", dyad.by_numbers[:, 2:], change.ground[2 * k : 2 * k + 2])
    left, right = one.by_numbers[:, first], other.by_numbers[:, second - 4]
    sides = (one.value, other.value), (one.by_t, other.by_t)
    found = _without_orientations(family, (left, right), (one.by_u[m:], other.by_u[m:]), sides)
    # of both dyads' equations for an orientation the one that depends on it more
    vc, wc = one.by_u[m:].conj(), other.by_u[m:].conj()
    scale = 1.0 / (vc * one.by_u[m:] + wc * other.by_u[m:]).real
    out = []
    for c, (p, q) in enumerate(sides):
        of_one = p[m:] - np.einsum("kcp,cp->kp", left[m:], found[: len(first), c])
        of_other = q[m:] - np.einsum("kcp,cp->kp", right[m:], found[len(first) :, c])
        out.append(-np.concatenate([found[:, c], (vc * of_one + wc * of_other) * scale]))
    return out[0], out[1]


def _without_orientations(
    family: Family,
    by_numbers: tuple[Number, Number],
    by_u: tuple[Number, Number],
    sides: tuple[tuple[Number, Number], tuple[Number, Number]],
) -> Number:
    """Solve the equations for the numbers alone: (numbers, right sides, paths).

    A point's two equations are added so that its orientation drops out; those of poses have none.
    """
    m, (left, right), (w, v) = family.poses, by_numbers, (-by_u[0], by_u[1])
    n, size, count = left.shape[1], left.shape[1] + right.shape[1], left.shape[2]
    matrix, wanted = np.zeros((size, size, count), dtype=complex), np.empty((size, 2, count), dtype=complex)
    # first so many equations as the one dyad has unknowns: no pivot is zero then
    h = n - m
    poses, points = (slice(m), slice(n, n + m)), (slice(m, n), slice(n + m, size))
    matrix[poses[0], :n], matrix[poses[1], n:] = left[:m], right[:m]
    for rows, some in zip(points, (slice(h), slice(h, None)), strict=True):
        np.multiply(v[some, None], left[m:][some], out=matrix[rows, :n])
        np.multiply(w[some, None], right[m:][some], out=matrix[rows, n:])
    for c, (p, q) in enumerate(sides):
        wanted[poses[0], c], wanted[poses[1], c] = p[:m], q[:m]
        mixed = v * p[m:] + w * q[m:]
        wanted[points[0], c], wanted[points[1], c] = mixed[:h], mixed[h:]
    return eliminated(matrix, wanted)


def _whole(family: Family, unknown: Number, ground: Number) -> Number:
    """Return all eight numbers (8, paths) of the unknown and the given ones."""
    if not family.pivots:
        return unknown
    numbers = np.empty((NUMBERS, unknown.shape[1]), dtype=complex)
    numbers[np.concatenate(family.unknown)] = unknown
    numbers[2:4] = ground[:2]
    if family.pivots > 1:
        numbers[6:] = ground[2:]
    return numbers


def orientations(numbers: Number, d: Number, e: Number) -> Number:
    """Return the orientations (places, pairs) of a body on pairs of dyads at places; both are linear in u, 1/u."""
    parts = []
    for x, xc, a, ac in (numbers[:4], numbers[4:]):
        g, gc = d[:, None] - a, e[:, None] - ac
        parts.append((x * gc, xc * g, g * gc + x * xc - (x - a) * (xc - ac)))
    (p, q, r), (s, t, v) = parts
    with np.errstate(all="ignore"):
        rough = (q * v - t * r) / (p * t - s * q)
        # near a singularity of both together one dyad alone, p u^2 + r u + q = 0, keeps the digits
        found, clear = rough, np.zeros(rough.shape)
        for f, g, h in parts:
            root = np.sqrt(h * h - 4.0 * f * g)
            ends = [(-h + root) / (2.0 * f), (-h - root) / (2.0 * f)]
            near = np.where(np.abs(ends[0] - rough) < np.abs(ends[1] - rough), *ends)
            apart = np.abs(root) / (np.abs(h) + np.abs(root))
            found, clear = np.where(apart > clear, near, found), np.maximum(apart, clear)
    return found


def third_pivot(numbers: Number) -> tuple[Number, Number]:
    """Return the third fixed pivot of a pair and its cognates, and its conjugate."""
    (x, xc), (a, ac), (y, yc), (b, bc) = (numbers[part] for part in (X, A, Y, B))
    return (b * x - a * y) / (x - y), (bc * xc - ac * yc) / (xc - yc)


def _signs(family: Family, numbers: Number) -> Number:
    """Return numbers (5, pairs) that are equal for equal pairs, whatever their order; for cognates too of points."""
    (x, xc), (a, ac), (y, yc), (b, bc) = (numbers[part] for part in (X, A, Y, B))
    if family.poses or family.pivots > 1:
        swapped = (x + y, a + b, x * y + a * b, xc + yc, ac + bc)
        return np.stack(swapped if family.pivots == 0 else (x, y, a + b, xc, yc))
    c, cc = third_pivot(numbers)
    if family.pivots:
        return np.stack([b + c, bc + cc, b * c, bc * cc, a])
    return np.stack([a + b + c, ac + bc + cc, a * b + b * c + c * a, a * b * c, ac * bc + bc * cc + cc * ac])


def distinct(family: Family, numbers: Number) -> Number:
    """Return the indices of pairs (8, pairs) that are finite, each once."""
    with np.errstate(all="ignore"):
        signs = _signs(family, numbers)
        finite = np.isfinite(signs).all(axis=0)
        rank = np.where(finite, signs[0].real / (1.0 + np.abs(signs[0])), np.inf)
    order = np.argsort(rank, kind="stable")[: int(finite.sum())]
    kept: list[int] = []
    for i in order:
        close = (k for k in reversed(kept[-NUMBERS * NUMBERS :]) if rank[i] - rank[k] < ALIKE)
        if not any(np.all(np.abs(signs[:, i] - signs[:, k]) < ALIKE * (1.0 + np.abs(signs[:, i]))) for k in close):
            kept.append(int(i))
    return np.array(sorted(kept), dtype=int)


def _measure(step: Number, x: Number) -> Number:
    return (np.abs(step) / (np.abs(x) + SMALL)).max(axis=0)


def _followed(road: _Road, start: Number, care: float = 1.0) -> Number:
    corrector = Corrector(ACCURATE, care * NEAR, care * GOAL, _measure)
    return follow_paths(road.homotopy(), start, LENGTHS, corrector)


def _arrived(road: _Road, start: Number) -> Number:
    """Return the ends (unknowns, pairs), each once.

    Paths that were lost, or came to the same end as another, are followed again with smaller steps.
    """
    ends = _followed(road, start)
    there = _kept(road, ends)
    again = np.setdiff1d(np.arange(start.shape[1]), there)
    twice = [np.flatnonzero(_same(road, ends, i)) for i in again if np.isfinite(ends[0, i])]
    again = np.union1d(again, np.concatenate(twice)) if twice else again
    if len(again):
        ends[:, again] = _followed(road, start[:, again], CAREFUL)
        there = _kept(road, ends)
    ends = ends[:, there]
    at, change = road.at(np.ones(ends.shape[1]))
    with np.errstate(all="ignore"):
        for _ in range(2):
            step, _slope = _newton(road.family, ends, at, change)
            ends = ends + step
    return ends[:, _measure(step, ends) < MET]


def _numbers_at_end(road: _Road, ends: Number) -> Number:
    unknown = sum(len(part) for part in road.family.unknown)
    return _whole(road.family, ends[:unknown], road.at(np.ones(1))[0].ground)


def _kept(road: _Road, ends: Number) -> Number:
    return distinct(road.family, _numbers_at_end(road, ends))


def _same(road: _Road, ends: Number, i: int) -> Number:
    with np.errstate(all="ignore"):
        signs = _signs(road.family, _numbers_at_end(road, ends))
        return (np.abs(signs - signs[:, [i]]) < ALIKE * (1.0 + np.abs(signs[:, [i]]))).all(axis=0)


def pairs_through(positions: DesignPositions, roads: int = ROADS) -> Pairs:
    """Return all pairs of dyads that meet positions, as many as there are.

    Positions in general have `count` of them. Where some are missing the start is taken on other roads too, until one
    leads to nothing new: special positions have fewer.
    """
    start, unknowns = shipped(positions.family)
    count, rng = unknowns.shape[1], np.random.default_rng(SEED)
    size = sum(len(part) for part in positions.family.unknown)
    found = np.empty((len(unknowns), 0), dtype=complex)
    for _ in range(roads):
        by, conjugate = np.exp(2j * np.pi * rng.random(2))
        road = _Road(start.turned(by, conjugate), positions)
        turned = unknowns.copy()
        turned[0:size:2] *= by
        turned[1:size:2] *= conjugate
        both = np.concatenate([found, _arrived(road, turned)], axis=1)
        before, found = found.shape[1], both[:, _kept(road, both)]
        if found.shape[1] in (before, count):
            break
    return Pairs(_numbers_at_end(road, found), found[size:], count)


# --- start systems ------------------------------------------------------------------------------------------------

# Where the solutions of generic instances are kept: for each family its positions, then the numbers of its pairs. The
# orientations follow, and Newton's method gives back the digits that single precision leaves out.
STARTS = Path(__file__).with_name("dyad_pairs.npz")


@lru_cache(maxsize=16)
def shipped(family: Family) -> tuple[DesignPositions, Number]:
    """Return the generic instance of a family, and all its solutions (unknowns, pairs)."""
    with np.load(STARTS) as kept:
        numbers = kept[_name(family)].astype(complex)
        parts = np.split(kept[f"{_name(family)} at"], np.cumsum([family.places, family.places, family.poses]))
    start = DesignPositions(*parts)
    return start, _refined(family, start, numbers)[0]


def _refined(family: Family, start: DesignPositions, numbers: Number) -> tuple[Number, Number]:
    """Return the unknowns (unknowns, pairs) of pairs that are known in part, and the last of Newton's steps."""
    unknowns = np.concatenate(
        [numbers[np.concatenate(family.unknown)], orientations(numbers, start.d, start.e)[family.poses :]]
    )
    at, change = _Road(start, start).at(np.ones(numbers.shape[1]))
    step = unknowns
    for _ in range(4):
        step, _slope = _newton(family, unknowns, at, change)
        unknowns = unknowns + step
    return unknowns, _measure(step, unknowns)


def _name(family: Family) -> str:
    return "{}+{}+{}".format(*family)


def monodromy(family: Family, seed: int = SEED, still: int = 6) -> Iterator[tuple[DesignPositions, Number]]:
    """Yield a generic instance with ever more of its solutions (8, pairs), as its positions go round loops.

    It ends after so many loops that lead to nothing new.
    """
    rng = np.random.default_rng(seed)
    home, found = _instance(family, rng)
    idle = 0
    while idle < still:
        away = [_random_positions(family, rng) for _ in range(2)]
        ends = found
        for start, end in ((home, away[0]), (away[0], away[1]), (away[1], home)):
            road = _Road(start, end)
            ends = _arrived(road, ends)
        both = np.concatenate([found, ends], axis=1)
        before, found = found.shape[1], both[:, _kept(road, both)]
        idle = 0 if found.shape[1] > before else idle + 1
        yield home, _numbers_at_end(road, found)


def _random(rng: np.random.Generator, count: int) -> Number:
    return rng.standard_normal(count) + 1j * rng.standard_normal(count)


def _random_positions(family: Family, rng: np.random.Generator) -> DesignPositions:
    places = family.places
    u = np.exp(0.7j * _random(rng, family.poses))
    return DesignPositions(_random(rng, places), _random(rng, places), u, _random(rng, 2 * family.pivots))


def _instance(family: Family, rng: np.random.Generator) -> tuple[DesignPositions, Number]:
    """Draw a pair of dyads and positions that it meets. With u given, both equations are bilinear in d and d*."""
    numbers, u = _random(rng, NUMBERS), np.exp(0.7j * _random(rng, family.places))
    w, parts = 1.0 / u, []
    for x, xc, a, ac in (numbers[:4], numbers[4:]):
        p, q = w * xc - ac, u * x - a
        parts.append((p, q, p * q - (x - a) * (xc - ac)))
    (p, q, k), (p2, q2, k2) = parts
    # the difference of both is linear: e = -(m + r d) / s
    r, s, m = p - p2, q - q2, k - k2
    half = (p * s - m - q * r) / (2.0 * r)
    d = half + np.sqrt(half**2 + (k * s - q * m) / r)
    e = -(m + r * d) / s
    ground = np.concatenate([numbers[A], numbers[B]])[: 2 * family.pivots]
    unknowns = np.concatenate([numbers[np.concatenate(family.unknown)], u[family.poses :]])
    return DesignPositions(d, e, u[: family.poses], ground), unknowns[:, None]


def save_starts(path: Path = STARTS, families: tuple[Family, ...] = tuple(COUNTS)) -> None:
    """Solve a generic instance of every family by monodromy and write them all: some minutes.

    Raises AssertionError where one has not as many solutions as it should.
    """
    kept = dict[str, Number]()
    for family in families:
        *_, (start, numbers) = monodromy(family)
        assert numbers.shape[1] == COUNTS[family], (family, numbers.shape[1])
        kept[f"{_name(family)} at"] = np.concatenate([start.d, start.e, start.u, start.ground])
        short = numbers.astype(np.complex64)
        comes_back = np.all(_refined(family, start, short.astype(complex))[1] < MET)
        kept[_name(family)] = short if comes_back else numbers
    np.savez_compressed(path, allow_pickle=False, **kept)


if __name__ == "__main__":
    save_starts()
