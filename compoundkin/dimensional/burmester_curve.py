"""The centre-point and circle-point curves of four poses: where two quadrics in three dimensions meet.

Planes through a chord of the curve sweep it; what is found so is spaced evenly and made exact.
Sources are those of `dyad_equations`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.dimensional.dyad_equations import QUADRICS, REAL, RR, BodyScale, Dyad, common_points, real_ones

CURVE_POINTS = 1000


@dataclass(frozen=True, eq=False, repr=False)
class BurmesterCurve(ShortRepr):
    """The dyads through four poses, in order along the centre-point and circle-point curves.

    `centres` are fixed centres, `points` the moving points in the body's coordinates, `lengths` those of the cranks,
    arrays (n,). `loops` numbers the loops; a loop is closed. Where both go through infinity the dyad there is a slider:
    `breaks` are the places (indices) before which that happens.
    """

    centres: Number
    points: Number
    lengths: Number
    loops: Number
    breaks: tuple[int, ...]

    def __len__(self) -> int:
        return len(self.centres)

    def __getitem__(self, index: int) -> Dyad:
        """Return the dyad at a place of the curve."""
        numbers = self.centres[index], self.points[index], self.lengths[index]
        return Dyad(RR, complex(numbers[0]), complex(numbers[1]), None, float(numbers[2]))

    def pieces(self) -> Iterator[tuple[Number, bool]]:
        """Yield the indices of each piece between breaks, and whether it is closed."""
        for loop in range(int(self.loops[-1]) + 1 if len(self) else 0):
            indices = np.flatnonzero(self.loops == loop)
            cuts = [int(np.searchsorted(indices, k)) for k in self.breaks if indices[0] <= k <= indices[-1]]
            if not cuts:
                yield indices, True
                continue
            turned = np.roll(indices, -cuts[0])
            places = [(cut - cuts[0]) % len(indices) for cut in cuts] + [len(indices)]
            yield from ((turned[a:b], False) for a, b in pairwise(places) if b > a)


def curve_of(basis: Number, unit: BodyScale, count: int = CURVE_POINTS) -> BurmesterCurve:
    """Return the curve in which two quadrics of a space with four dimensions meet, some `count` points of it.

    Planes through a line that meets the curve twice meet it in two more points each: the roots of one quadratic. Where
    its discriminant, a quartic in the direction of the plane, is positive they are real.
    """
    forms = np.einsum("ji,njk,kl->nil", basis, QUADRICS, basis)
    chord = _chord(forms)
    part = np.einsum("ai,nij,bj->nab", chord, forms, chord)
    a, b = part.reshape(2, -1)
    # on the chord both quadrics are proportional: one of their combinations is zero on it, one is not
    axis = a if np.linalg.norm(a) >= np.linalg.norm(b) else b
    first, second = (float(v @ axis) / float(axis @ axis) for v in (a, b))
    flat, other = second * forms[0] - first * forms[1], first * forms[0] + second * forms[1]
    pencil = _Pencil(chord, np.linalg.svd(chord)[2][2:], flat, other)
    found = [loop for ends in pencil.arcs() for loop in pencil.loops(*ends, count)]
    if not found:
        return BurmesterCurve(np.zeros(0, complex), np.zeros(0, complex), np.zeros(0), np.zeros(0, int), ())
    share = [max(round(count * _length(w) / sum(map(_length, found))), 24) for w in found]
    evened = [pencil.evened(w, number) for w, number in zip(found, share, strict=True)]
    return _as_curve(evened, basis, unit)


def _chord(forms: Number) -> Number:
    """Return two vectors (2, 4) that span a real line through two points of the curve."""
    rng = np.random.default_rng(0)
    for _ in range(20):
        plane = np.linalg.qr(rng.normal(size=(4, 3)))[0]
        points = common_points(np.einsum("ai,nab,bj->nij", plane, forms, plane))
        if len(points) < 4:
            continue
        real = real_ones(points)
        if len(real) < 4:
            largest = np.argmax(np.abs(points), axis=-1)[:, None]
            turned = points / np.take_along_axis(points, largest, axis=-1)
            one = turned[int(np.argmax(np.max(np.abs(turned.imag), axis=-1)))]
            pair = np.stack([one.real, one.imag])
        else:
            pair = real[:2]
        return np.linalg.qr((pair @ plane.T).T)[0].T
    raise InvalidInput(Problem("poses", "their dyads form no curve", "move one of the poses a little"))


@dataclass(frozen=True)
class _Pencil:
    """The planes through a chord (2, 4) of the curve, with directions in its complement (2, 4).

    The quadric `flat` holds the chord, `other` does not.
    """

    chord: Number
    complement: Number
    flat: Number
    other: Number

    def forms(self, t: Number) -> tuple[Number, Number, Number]:
        """Return for planes: the direction (n, 4), the line in which `flat` meets it and the conic of `other`."""
        w = np.cos(t)[:, None] * self.complement[0] + np.sin(t)[:, None] * self.complement[1]
        flat = w @ self.flat
        line = np.concatenate([2.0 * flat @ self.chord.T, np.einsum("ni,ni->n", flat, w)[:, None]], axis=-1)
        conic = np.zeros((len(t), 3, 3))
        conic[:, :2, :2] = self.chord @ self.other @ self.chord.T
        conic[:, :2, 2] = conic[:, 2, :2] = w @ self.other @ self.chord.T
        conic[:, 2, 2] = np.einsum("ni,ij,nj->n", w, self.other, w)
        return w, line, conic

    def discriminant(self, t: Number) -> Number:
        """Return what is positive where the two points of a plane are real, a quartic form of cosine and sine."""
        _, line, conic = self.forms(t)
        rows = [np.cross(conic[:, (i + 1) % 3], conic[:, (i + 2) % 3]) for i in range(3)]
        adjugate = np.stack(rows, axis=-1)
        return -np.einsum("ni,nij,nj->n", line, adjugate, line)

    def arcs(self) -> Iterator[tuple[float, float]]:
        """Yield the ranges of directions with real points; a range of a half turn has no ends."""
        angles = np.arange(5) * np.pi / 5.0 + 0.1
        values = self.discriminant(angles)
        start = float(angles[int(np.argmax(np.abs(values)))])
        # the quartic in the tangent of the angle from there, where it is greatest: its first coefficient is not zero
        c, s = np.cos(angles - start), np.sin(angles - start)
        quartic = np.linalg.solve(np.stack([c**k * s ** (4 - k) for k in range(4, -1, -1)], axis=-1), values)
        roots = np.roots(quartic)
        cotangents = roots[np.abs(roots.imag) < REAL * (1.0 + np.abs(roots))].real
        real = np.sort(np.mod(start + np.arctan2(1.0, cotangents), np.pi))
        if not len(real):
            if values[0] > 0.0:
                yield 0.0, np.pi
            return
        for low, high in zip(real, [*real[1:], real[0] + np.pi], strict=True):
            if self.discriminant(np.array([(low + high) / 2.0]))[0] > 0.0:
                yield float(low), float(high)

    def points(self, t: Number, side: float) -> Number:
        """Return one of the two points of each plane, unit vectors (n, 4)."""
        w, line, conic = self.forms(t)
        zero = np.zeros(len(t))
        first = np.stack([line[:, 1], -line[:, 0], zero], axis=-1)
        square = line[:, 0] ** 2 + line[:, 1] ** 2
        second = np.stack([-line[:, 0] * line[:, 2], -line[:, 1] * line[:, 2], square], axis=-1)
        first, second = (v / np.linalg.norm(v, axis=-1, keepdims=True) for v in (first, second))
        ends = (first, first), (first, second), (second, second)
        a, b, c = (np.einsum("ni,nij,nj->n", left, conic, right) for left, right in ends)
        root = np.sqrt(np.maximum(b * b - a * c, 0.0)) * side
        # both forms of the solution of a quadratic, the one without cancellation
        one = np.where((b * side <= 0.0)[:, None], np.stack([-b + root, a], -1), np.stack([c, -b - root], -1))
        local = one[:, :1] * first + one[:, 1:] * second
        found = local[:, :1] * self.chord[0] + local[:, 1:2] * self.chord[1] + local[:, 2:] * w
        return found / np.linalg.norm(found, axis=-1, keepdims=True)

    def loops(self, low: float, high: float, count: int) -> Iterator[Number]:
        """Yield the closed loops over a range of directions: there on one side and back on the other.

        Over a half turn without ends each side is a loop of its own, or goes on as the other.
        """
        half = max(count // 2, 24)
        if high - low < np.pi:
            t = (low + high) / 2.0 - (high - low) / 2.0 * np.cos(np.linspace(0.0, np.pi, half))
            there, back = (self.points(t, side) for side in (1.0, -1.0))
            yield _signed(np.concatenate([there, back[::-1][1:-1]]))
            return
        t = np.linspace(low, high, half + 1)
        one, other = (self.points(t, side) for side in (1.0, -1.0))
        if abs(one[-1] @ one[0]) >= abs(one[-1] @ other[0]):
            yield from (_signed(side[:-1]) for side in (one, other))
        else:
            yield _signed(np.concatenate([one[:-1], other[:-1]]))

    def evened(self, loop: Number, count: int) -> Number:
        """Return a loop with points at even distances on the unit sphere, made exact on both quadrics."""
        closed = np.concatenate([loop, loop[:1] * np.sign(loop[0] @ loop[-1])])
        along = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(closed, axis=0), axis=-1)))
        places = np.linspace(0.0, along[-1], count, endpoint=False)
        points = np.stack([np.interp(places, along, column) for column in closed.T], axis=-1)
        for _ in range(5):
            points = points / np.linalg.norm(points, axis=-1, keepdims=True)
            points = points - _correction(points, np.stack([self.flat, self.other]))
        return points / np.linalg.norm(points, axis=-1, keepdims=True)


def _correction(points: Number, forms: Number) -> Number:
    """Return the shortest steps to two quadrics by Newton's method, (n, 4)."""
    slopes = 2.0 * np.einsum("nij,pj->pni", forms, points)
    values = np.einsum("pni,pi->pn", slopes, points) / 2.0
    gram = np.einsum("pni,pmi->pnm", slopes, slopes)
    determinant = gram[:, 0, 0] * gram[:, 1, 1] - gram[:, 0, 1] ** 2
    weights = np.stack([gram[:, 1, 1] * values[:, 0] - gram[:, 0, 1] * values[:, 1],
                        gram[:, 0, 0] * values[:, 1] - gram[:, 0, 1] * values[:, 0]], axis=-1)  # fmt: skip
    with np.errstate(all="ignore"):
        steps = np.einsum("pn,pni->pi", weights / determinant[:, None], slopes)
    return np.where(np.isfinite(steps), steps, 0.0)


def _signed(points: Number) -> Number:
    """Return unit vectors with the signs with which each follows the one before."""
    signs = np.sign(np.einsum("ni,ni->n", points[1:], points[:-1]))
    return points * np.append(1.0, np.cumprod(np.where(signs == 0.0, 1.0, signs)))[:, None]


def _length(points: Number) -> float:
    return float(np.sum(np.linalg.norm(np.diff(points, axis=0), axis=-1)))


def _as_curve(loops: list[Number], basis: Number, unit: BodyScale) -> BurmesterCurve:
    q = np.concatenate(loops) @ basis.T
    number = np.concatenate([np.full(len(w), k) for k, w in enumerate(loops)])
    with np.errstate(all="ignore"):
        moving = (q[:, 1] + 1j * q[:, 2]) / (2.0 * q[:, 0])
        centre = -(q[:, 3] + 1j * q[:, 4]) / (2.0 * q[:, 0])
        square = np.abs(moving) ** 2 + np.abs(centre) ** 2 - q[:, 7] / q[:, 0]
        lengths = np.sqrt(np.maximum(square, 0.0)) * unit.length
    breaks, start = [], 0
    for w in loops:
        k = (w @ basis[0]) * np.append(1.0, np.cumprod(np.sign(np.einsum("ni,ni->n", w[1:], w[:-1]))))
        breaks += (start + 1 + np.flatnonzero(k[1:] * k[:-1] <= 0.0)).tolist()
        end = k[-1] * np.sign(w[0] @ w[-1] * k[0])
        breaks += [start] if end * abs(k[0]) <= 0.0 and k[-1] != 0.0 else []
        start += len(w)
    places = unit.place + unit.length * centre, unit.point + unit.length * moving
    return BurmesterCurve(*places, lengths, number, tuple(sorted(breaks)))
