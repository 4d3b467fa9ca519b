"""Dyads that guide a body through poses: Burmester's theory by one linear fit.

A dyad holds a point of the body on a circle (RR) or a line (PR) of the frame, or a line of the body through a point of
the frame (RP). With the pose ``w = z + u p`` all three are one equation with eight coefficients,

    k |z|^2 + Re(alpha conj(z) u) + Re(conj(beta) z) + Re(gamma u) + delta = 0,    alpha conj(beta) = 2 k gamma,

linear but for the two real conditions on the right. So n poses leave a space of 8 - n dimensions cut by two quadrics:
five poses four points at most, four poses a curve of degree four (the centre-point and circle-point curves), three
poses a surface. A pose infinitely near is the derivative of its row.

Sources: L. Burmester, Lehrbuch der Kinematik, Leipzig 1888; J. M. McCarthy and G. S. Soh, Geometric Design of Linkages,
2nd ed., Springer 2011, chapters 3 and 5 (poles, centre-point curve); Q. J. Ge, P. Zhao, A. Purwar, X. Li, A novel
approach to algebraic fitting of a pencil of quadrics for planar 4R motion synthesis, J. Comput. Inf. Sci. Eng. 12
(2012) 041003 (eight coefficients).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from itertools import combinations, pairwise
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arguments import checked, planar_numbers
from compoundkin.base.arrays import Number
from compoundkin.base.display import DisplaysHtml, ShortRepr, count_phrase, display_function
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.linear import one_thread
from compoundkin.dimensional.tasks import PoseTask, extent, poses

RR, PR, RP = "RR", "PR", "RP"
KINDS = (RR, PR, RP)
# A dyad with k below this, of coefficients of unit length, is a slider: rounding leaves 1e-13 of a planted one, and a
# crank so long would be taken for a line at any workshop.
STRAIGHT = 1e-9
# Imaginary parts below this are rounding: a double solution is known to the root of it.
REAL = 1e-7
# A point of the body that moves by less than this part of the poses' extent rests.
RESTING = 1e-6
# Rows of poses are dependent where a singular value is below this part of the greatest.
DEPENDENT = 1e-10
# So many coefficients have dyads; three poses leave a surface, four a curve, five points.
COEFFICIENTS = 8
# Turns all poses are alike by if their angles differ by less.
ALIKE = 1e-9
CURVE_POINTS = 1000
# Points of a circle that rolls in one of twice its size run on its diameters (Cardan), lines through them likewise.
CARDAN = "Cardan motion: a slider in every direction takes these poses"


@dataclass(frozen=True, eq=False)
class Dyad:
    """A dyad between the frame and a body: RR, PR or RP.

    `fixed` is the fixed centre (RR, RP) or a place of the fixed line (PR), `moving` the point in the body's coordinates
    (RR, PR) or a point of the body's line (RP). `direction` is that of the line, a unit vector in the frame (PR) or the
    body (RP), None of RR. `length` is that of an RR dyad's crank, else 0.
    """

    kind: str
    fixed: complex
    moving: complex
    direction: complex | None = None
    length: float = 0.0

    def residual(self, z: Number, u: Number) -> Number:
        """Return by how much poses miss it: a length for each of the poses with origins `z`, orientations `u`."""
        if self.direction is None:
            return np.abs(z + u * self.moving - self.fixed) - self.length
        if self.kind == PR:
            return (np.conj(self.direction) * (z + u * self.moving - self.fixed)).imag
        return (np.conj(u * self.direction) * (self.fixed - z - u * self.moving)).imag

    def scaled(self, by: float) -> Dyad:
        """Return the dyad with all lengths and places so many times as far."""
        return Dyad(self.kind, by * self.fixed, by * self.moving, self.direction, by * self.length)

    def __repr__(self) -> str:
        line = "" if self.direction is None else f", line at {np.rad2deg(np.angle(self.direction)):.4g} degrees"
        length = f", length {self.length:.6g}" if self.length else ""
        return f"Dyad({self.kind}: fixed {self.fixed:.6g}, moving {self.moving:.6g}{line}{length})"


class _Unit(NamedTuple):
    """A body's point and a place of the frame that become origins, and the length that becomes one."""

    point: complex
    place: complex
    length: float

    @classmethod
    def of(cls, z: Number, u: Number) -> _Unit:
        """Choose the body's point that moves least: least squares of its distances from one place."""
        columns = np.stack([u, -np.ones_like(u)], axis=-1)
        if np.ptp(np.abs(u - u[0])) < ALIKE and abs(np.mean(u) - u[0]) < ALIKE:
            point, place = 0j, complex(np.mean(z))
        else:
            point, place = (complex(v) for v in np.linalg.lstsq(columns, -z, rcond=None)[0])
        length, whole = extent(z + u * point), extent(z)
        # two poses have a point that rests
        return cls(point, place, length if length > RESTING * whole else whole)


def rows_of(task: PoseTask, unit: _Unit) -> Number:
    """Return the equations of dyads: a row of eight coefficients for each pose, then for those infinitely near."""
    found = [_row(*_normed(complex(z), complex(u), unit)) for z, u in zip(task.z, task.u, strict=True)]
    for index, (v, w) in task.velocities.items():
        z, u = _normed(complex(task.z[index]), complex(task.u[index]), unit)
        # the twist of the body's point that is the origin here
        first = (v + 1j * w * task.u[index] * unit.point) / unit.length
        scale = float(np.hypot(abs(first), w)) or 1.0
        first, w = complex(first / scale), w / scale
        found.append(_row_rate(z, u, first, 1j * w * u))
        if index in task.accelerations:
            a, b = task.accelerations[index]
            turn = 1j * b / scale**2 - w**2
            second = (a / scale**2 + turn * task.u[index] * unit.point) / unit.length
            found.append(_row_second(z, u, first, 1j * w * u, complex(second), turn * u))
    return np.array(found)


def _normed(z: complex, u: complex, unit: _Unit) -> tuple[complex, complex]:
    return (z + u * unit.point - unit.place) / unit.length, u


def _row(z: complex, u: complex) -> list[float]:
    return _reals(abs(z) ** 2, z.conjugate() * u, z, u, 1.0)


def _row_rate(z: complex, u: complex, dz: complex, du: complex) -> list[float]:
    return _reals(2.0 * (z.conjugate() * dz).real, dz.conjugate() * u + z.conjugate() * du, dz, du, 0.0)


def _row_second(z: complex, u: complex, dz: complex, du: complex, ddz: complex, ddu: complex) -> list[float]:
    square = 2.0 * (abs(dz) ** 2 + (z.conjugate() * ddz).real)
    return _reals(square, ddz.conjugate() * u + 2.0 * dz.conjugate() * du + z.conjugate() * ddu, ddz, ddu, 0.0)


def _reals(square: float, product: complex, z: complex, u: complex, one: float) -> list[float]:
    return [square, product.real, -product.imag, z.real, z.imag, u.real, -u.imag, one]


def _quadrics() -> Number:
    """Return the two quadrics alpha conj(beta) - 2 k gamma = 0, real and imaginary part, symmetric (2, 8, 8)."""
    forms = np.zeros((2, COEFFICIENTS, COEFFICIENTS))
    real = (0, 1, 3, 1.0), (0, 2, 4, 1.0), (0, 0, 5, -2.0)
    imaginary = (1, 2, 3, 1.0), (1, 1, 4, -1.0), (1, 0, 6, -2.0)
    for form, i, j, value in (*real, *imaginary):
        forms[form, i, j] += value / 2.0
        forms[form, j, i] += value / 2.0
    return forms


QUADRICS = _quadrics()


def dyad_of(q: Number, unit: _Unit) -> Dyad | None:
    """Return the dyad of eight coefficients, None for those of a body that only shifts."""
    q = q / np.linalg.norm(q)
    k, alpha, beta, gamma, delta = q[0], complex(q[1], q[2]), complex(q[3], q[4]), complex(q[5], q[6]), q[7]
    if abs(k) > STRAIGHT:
        moving, centre = alpha / (2.0 * k), -beta / (2.0 * k)
        square = abs(moving) ** 2 + abs(centre) ** 2 - delta / k
        length = float(np.sqrt(max(square, 0.0))) * unit.length
        return Dyad(RR, unit.place + unit.length * centre, unit.point + unit.length * moving, None, length)
    if max(abs(alpha), abs(beta)) < STRAIGHT:
        return None
    if abs(beta) >= abs(alpha):
        foot, moving = -delta * beta / abs(beta) ** 2, gamma / beta.conjugate()
        return Dyad(PR, unit.place + unit.length * foot, unit.point + unit.length * moving, 1j * beta / abs(beta))
    foot, centre = delta * alpha / abs(alpha) ** 2, -(gamma / alpha).conjugate()
    return Dyad(RP, unit.place + unit.length * centre, unit.point + unit.length * foot, 1j * alpha / abs(alpha))


def common_points(forms: Number) -> Number:
    """Return the four complex points of two conics, unit vectors (4, 3); `forms` are symmetric (2, 3, 3).

    A resultant in a turned basis gives them, Newton's method makes them exact. None where both have a common line.
    """
    points = np.zeros((0, 3), complex)
    for turn in _TURNS:
        a, b = np.einsum("ji,njk,kl->nil", turn, forms, turn)
        # a quadratic in y with polynomials in x, highest power first
        (a2, a1, a0), (b2, b1, b0) = (
            (m[1, 1], np.array([2 * m[0, 1], 2 * m[1, 2]]), np.array([m[0, 0], 2 * m[0, 2], m[2, 2]])) for m in (a, b)
        )
        first, second = a2 * b0 - a0 * b2, a2 * b1 - a1 * b2
        third: Number = np.polysub(np.polymul(a1, b0), np.polymul(a0, b1))
        quartic = np.polysub(np.polymul(first, first), np.polymul(second, third))
        x = np.roots(quartic)
        with np.errstate(all="ignore"):
            y = -np.polyval(first, x) / np.polyval(second, x)
        if len(x) == 4 and np.isfinite(y).all():
            points = np.stack([x, y, np.ones(4)], axis=-1) @ turn.T
            points = _exact(points / np.linalg.norm(points, axis=-1, keepdims=True), forms)
            if _apart(points):
                break
    return points


def _turned(angles: tuple[float, float, float]) -> Number:
    turn = np.eye(3)
    for (i, j), angle in zip(combinations(range(3), 2), angles, strict=True):
        plane = np.eye(3)
        plane[[i, j], [i, j]], plane[i, j], plane[j, i] = np.cos(angle), -np.sin(angle), np.sin(angle)
        turn = turn @ plane
    return turn


# Bases in which no task is likely to be special.
_TURNS = tuple(_turned(angles) for angles in ((0.7, 1.9, 0.4), (2.1, 0.3, 1.2), (1.3, 2.6, 2.2)))


def _exact(points: Number, forms: Number) -> Number:
    """Return common points made exact by Newton's method on the unit sphere."""
    for _ in range(4):
        slopes = 2.0 * np.einsum("nij,pj->pni", forms, points)
        values = np.einsum("pni,pi->pn", slopes, points) / 2.0
        matrix = np.concatenate([slopes, np.conj(points)[:, None]], axis=1)
        right = np.concatenate([values, np.zeros((len(points), 1))], axis=1)
        try:
            points = points - np.linalg.solve(matrix, right[..., None])[..., 0]
        except np.linalg.LinAlgError:
            break
        points = points / np.linalg.norm(points, axis=-1, keepdims=True)
    return points


def _apart(points: Number) -> bool:
    """Return whether no two points are one, so that none was missed."""
    cosines = np.abs(np.conj(points) @ points.T) - np.eye(len(points))
    return bool(np.max(cosines) < 1.0 - 1e-12)


def real_ones(points: Number) -> Number:
    """Return the real ones among complex projective points, as real unit vectors."""
    largest = np.argmax(np.abs(points), axis=-1)[:, None]
    turned = points / np.take_along_axis(points, largest, axis=-1)
    real = np.max(np.abs(turned.imag), axis=-1) < REAL
    found = turned[real].real
    return found / np.linalg.norm(found, axis=-1, keepdims=True)


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


def curve_of(basis: Number, unit: _Unit, count: int = CURVE_POINTS) -> BurmesterCurve:
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


def _as_curve(loops: list[Number], basis: Number, unit: _Unit) -> BurmesterCurve:
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


@dataclass(frozen=True)
class RotationPole:
    """The pole of two poses: the place of the frame, and the point of the body, that are one in both.

    `poses` are their indices. Of a pose with a velocity it is the pole of that motion, both indices are the pose's.
    """

    poses: tuple[int, int]
    place: complex
    point: complex


@dataclass(frozen=True, eq=False, repr=False)
class Dyads(DisplaysHtml):
    """The dyads that guide a body through poses.

    `freedom` is 0 where they are finitely many, 1 where they form a curve, 2 or more where a surface or all of the
    plane. `found` are those that stand alone: all of five poses, the sliders of four, whose PR has Ball's point. `note`
    says what is special.
    """

    task: PoseTask
    freedom: int
    found: tuple[Dyad, ...]
    note: str = ""
    basis: Number = field(default=None, repr=False)
    unit: _Unit = field(default=_Unit(0j, 0j, 1.0), repr=False)

    @cached_property
    def curve(self) -> BurmesterCurve:
        """The curves of centre and circle points of four poses; raises InvalidInput where there is none."""
        if self.freedom != 1:
            what = f"the dyads through these poses are {_FREEDOMS[min(self.freedom, 2)]}"
            raise InvalidInput(Problem("curve", what, "four poses have one; of three, choose a centre or a point"))
        return curve_of(self.basis, self.unit)

    @cached_property
    def poles(self) -> tuple[RotationPole, ...]:
        """The poles of all pairs of poses that differ in their angle, then those of velocities."""
        z, u = self.task.z, self.task.u
        found = []
        for i, j in combinations(range(len(z)), 2):
            if abs(u[i] - u[j]) > ALIKE:
                point = (z[j] - z[i]) / (u[i] - u[j])
                found.append(RotationPole((i, j), complex(z[i] + u[i] * point), complex(point)))
        for i, (v, w) in self.task.velocities.items():
            if abs(w) > ALIKE * abs(v):
                arm = 1j * v / w
                found.append(RotationPole((i, i), complex(z[i] + arm), complex(arm * np.conj(u[i]))))
        return tuple(found)

    def with_centre(self, place: Any) -> Dyad:
        """Return the dyad with a fixed centre, (x, y) or complex: RR, or RP. Raises InvalidInput where there is none.

        Of three poses every centre has one; of four only the centres on the curve have.
        """
        c = (_place("place", place) - self.unit.place) / self.unit.length
        # beta = -2 k c and gamma = -conj(c) alpha
        rows = np.zeros((4, COEFFICIENTS))
        rows[0, [0, 3]], rows[1, [0, 4]] = (2.0 * c.real, 1.0), (2.0 * c.imag, 1.0)
        rows[2, [1, 2, 5]], rows[3, [1, 2, 6]] = (c.real, c.imag, 1.0), (-c.imag, c.real, 1.0)
        return self._with(rows, "centre", f"({place})")

    def with_point(self, point: Any) -> Dyad:
        """Return the dyad with a moving point of the body, (x, y) or complex: RR, or PR. Raises InvalidInput."""
        p = (_place("point", point) - self.unit.point) / self.unit.length
        # alpha = 2 k p and gamma = conj(beta) p
        rows = np.zeros((4, COEFFICIENTS))
        rows[0, [0, 1]], rows[1, [0, 2]] = (2.0 * p.real, -1.0), (2.0 * p.imag, -1.0)
        rows[2, [3, 4, 5]], rows[3, [3, 4, 6]] = (p.real, p.imag, -1.0), (p.imag, -p.real, -1.0)
        return self._with(rows, "point", f"({point})")

    def with_line(self, angle: float, kind: str = PR) -> Dyad:
        """Return the slider of a direction (radians): of its line in the frame (PR) or in the body (RP)."""
        if kind not in (PR, RP):
            raise InvalidInput(Problem("kind", f"{kind!r} is no slider", "PR or RP"))
        normal = 1j * np.exp(1j * angle)
        rows = np.zeros((4, COEFFICIENTS))
        here, none = ((3, 4), (1, 2)) if kind == PR else ((1, 2), (3, 4))
        rows[0, 0], rows[1, none[0]], rows[2, none[1]] = 1.0, 1.0, 1.0
        rows[3, here] = -normal.imag, normal.real
        return self._with(rows, "angle", f"{angle:g}")

    def _with(self, rows: Number, name: str, given: str) -> Dyad:
        """Return the one dyad of the space that fulfils further linear equations."""
        matrix = rows / np.linalg.norm(rows, axis=-1, keepdims=True) @ self.basis
        _, sizes, right = np.linalg.svd(matrix)
        many = matrix.shape[1] > 1 and len(sizes) > matrix.shape[1] - 2 and sizes[matrix.shape[1] - 2] < REAL
        if matrix.shape[1] > 5 or many:
            what = f"infinitely many dyads with the {name} {given} take these poses"
            raise InvalidInput(Problem(name, what, "give a further pose, or both places"))
        least = sizes[matrix.shape[1] - 1] if len(sizes) >= matrix.shape[1] else 0.0
        found = dyad_of(self.basis @ right[-1], self.unit) if least < REAL else None
        if found is None:
            raise InvalidInput(Problem(name, f"no dyad with the {name} {given} takes these poses"))
        return found

    def draw(self, **options: Any) -> Any:
        """Return the picture of poses, poles, curves and dyads."""
        return display_function("dyads_picture")(self, **options)

    def __iter__(self) -> Iterator[Dyad]:
        return iter(self.found)

    def __len__(self) -> int:
        return len(self.found)

    def __getitem__(self, index: int) -> Dyad:
        return self.found[index]

    def __repr__(self) -> str:
        kinds = ", ".join(dyad.kind for dyad in self.found) or "none alone"
        note = f"; {self.note}" if self.note else ""
        return f"Dyads({self.task.in_words}: {kinds}; {_FREEDOMS[min(self.freedom, 2)]}{note})"


_FREEDOMS = ("finitely many", "a curve of them", "a surface of them")


def _place(where: str, given: Any) -> complex:
    """Return one place of the plane."""
    found = planar_numbers(where, given)
    if found.shape == (2,) and not found.imag.any():
        found = np.asarray(complex(found[0].real, found[1].real))
    if found.ndim or not np.isfinite(found):
        raise InvalidInput(Problem(where, "it is no place", "give (x, y) or a complex number"))
    return complex(found)


@checked
@one_thread
def dyads(poses: Any, *, velocities: Any = None, accelerations: Any = None) -> Dyads:
    """Return the dyads RR, PR and RP that guide a body through poses (n, 3): x, y and the angle in radians.

    Five poses have four dyads at most, `found`; four have a `curve` of them and two sliders; three have one for each
    fixed centre, `with_centre`, and each moving point, `with_point`. `velocities` and `accelerations` are those of
    `tasks.poses`. Raises InvalidInput for equal poses.

    >>> angles = np.array([0.0, 0.4, 0.9, 1.3, 1.8])
    >>> crank = np.exp(1j * np.array([0.2, 0.9, 1.7, 2.2, 3.1]))  # a body on a crank of length 1 about zero
    >>> plate = np.stack([crank.real, crank.imag, angles], axis=1)
    >>> for dyad in dyads(plate):
    ...     print(dyad.kind, round(dyad.length, 6))
    RR 0.248484
    RR 0.455318
    RR 1.0
    RR 3.568724
    >>> round(dyads(plate[:3]).with_centre(0).length, 6)
    1.0
    """
    return dyads_of(poses_task(poses, velocities, accelerations))


def poses_task(given: Any, velocities: Any, accelerations: Any) -> PoseTask:
    """Return the task of poses of a body without a name."""
    if isinstance(given, PoseTask):
        return given
    return poses("body", given, velocities=velocities, accelerations=accelerations)


def dyads_of(task: PoseTask) -> Dyads:
    """Return the dyads of a task of poses."""
    unit = _Unit.of(task.z, task.u)
    special = _special(task, unit)
    if special is not None:
        return special
    rows = rows_of(task, unit)
    _, sizes, right = np.linalg.svd(rows)
    rank = int(np.sum(sizes > DEPENDENT * sizes[0]))
    basis = right[rank:].T
    freedom = basis.shape[1] - 3
    note = "" if rank == task.count or freedom < 0 else "the poses depend on each other"
    if freedom < 0:
        return Dyads(task, 0, (), f"{count_phrase(task.count, 'pose')} are more than a dyad can meet", basis, unit)
    if freedom == 0:
        forms = np.einsum("ji,njk,kl->nil", basis, QUADRICS, basis)
        found = (dyad_of(basis @ point, unit) for point in real_ones(common_points(forms)))
        dyads, sliders = [dyad for dyad in found if dyad is not None], _cardan_sliders(basis, unit)
        if sliders:
            cranks = [
                dyad for dyad in dyads if dyad.kind == RR and np.max(np.abs(dyad.residual(task.z, task.u))) < REAL
            ]
            return Dyads(task, 1, (*cranks, *sliders), CARDAN, basis, unit)
        return Dyads(task, 0, tuple(sorted(dyads, key=_order)), note, basis, unit)
    sliders = _sliders(basis, unit) if freedom == 1 else ()
    return Dyads(task, freedom, sliders, note, basis, unit)


def _cardan_sliders(basis: Number, unit: _Unit) -> tuple[Dyad, ...]:
    """Return four of the sliders of five poses that have one in every direction; none of any others."""
    for zero, normal in (([0, 1, 2], [3, 4]), ([0, 3, 4], [1, 2])):
        _, sizes, right = np.linalg.svd(basis[zero])
        space = basis @ right[1:].T
        if sizes[1] < DEPENDENT < np.linalg.svd(space[normal], compute_uv=False)[-1]:
            found = []
            for t in np.arange(4) * np.pi / 4.0:
                q = space @ np.linalg.solve(space[normal], [np.cos(t), np.sin(t)])
                q[zero] = 0.0
                found.append(dyad_of(q, unit))
            return tuple(filter(None, found))
    return ()


def _sliders(basis: Number, unit: _Unit) -> tuple[Dyad, ...]:
    """Return the PR and the RP dyad of four poses: k and alpha, or k and beta, are zero."""
    found = []
    for zero in ([0, 1, 2], [0, 3, 4]):
        _, sizes, right = np.linalg.svd(basis[zero])
        if sizes[-1] > DEPENDENT:
            # exactly zero, so that rounding makes no crank of it
            q = basis @ right[-1]
            q[zero] = 0.0
            found.append(dyad_of(q, unit))
    return tuple(filter(None, found))


def _special(task: PoseTask, unit: _Unit) -> Dyads | None:
    """Return what a body that only turns or only shifts needs, None for any other."""
    z, u = task.z, task.u
    turning = any(abs(w) > ALIKE * abs(v) for v, w in task.velocities.values())
    if len(z) > 1 and np.max(np.abs(u - u[0])) < ALIKE and not turning:
        return Dyads(task, 2, (), f"the body only shifts: {_shifting(z)}", np.eye(COEFFICIENTS), unit)
    moved = z + u * unit.point
    if (
        len(z) > 1
        and np.max(np.abs(moved - unit.place)) < ALIKE * max(extent(z), abs(unit.point), 1e-300)
        and not task.velocities
    ):
        x, y = (round(v, 12) + 0.0 for v in (unit.place.real, unit.place.imag))
        note = f"the body only turns: a pin at ({x:.6g}, {y:.6g}) takes it through all poses"
        return Dyads(task, 2, (), note, np.eye(COEFFICIENTS), unit)
    return None


def _shifting(z: Number) -> str:
    found = circle_through(z)
    if found is None:
        return "all places are on a line, so that a slide does"
    _, radius, off = found
    if off > DEPENDENT**0.5 * radius:
        return "its places are on no circle, so that no dyad takes it there"
    return f"parallel cranks of length {radius:.6g} do, at any two of its points"


def circle_through(z: Number) -> tuple[complex, float, float] | None:
    """Return centre, radius and greatest deviation of the circle that fits places best, None where they are in line.

    >>> round(circle_through(np.array([1, 1j, -1]))[1], 12)
    1.0
    """
    middle, size = complex(np.mean(z)), extent(z)
    w = (z - middle) / size
    matrix = np.stack([2.0 * w.real, 2.0 * w.imag, np.ones(len(w))], axis=-1)
    (x, y, c), _, rank, _ = np.linalg.lstsq(matrix, np.abs(w) ** 2, rcond=DEPENDENT)
    if rank < 3:
        return None
    centre = complex(x, y)
    radius = float(np.sqrt(max(c + abs(centre) ** 2, 0.0)))
    off = float(np.max(np.abs(np.abs(w - centre) - radius)))
    return middle + size * centre, size * radius, size * off


def _order(dyad: Dyad) -> tuple[int, float, float, float]:
    """Order dyads by their kind, then by their length and fixed centre."""
    return KINDS.index(dyad.kind), round(dyad.length, 9), round(dyad.fixed.real, 9), round(dyad.fixed.imag, 9)
