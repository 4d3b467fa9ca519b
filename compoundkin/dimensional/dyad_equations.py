"""The equations of dyads that guide a body through poses: Burmester's theory by one linear fit.

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

from dataclasses import dataclass
from itertools import combinations
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.dimensional.tasks import PoseTask, extent

RR, PR, RP = "RR", "PR", "RP"
# A dyad with k below this, of coefficients of unit length, is a slider: rounding leaves 1e-13 of a planted one, and a
# crank so long would be taken for a line at any workshop.
STRAIGHT = 1e-9
# Imaginary parts below this are rounding: a double solution is known to the root of it.
REAL = 1e-7
# A point of the body that moves by less than this part of the poses' extent rests.
RESTING = 1e-6
# So many coefficients have dyads; three poses leave a surface, four a curve, five points.
COEFFICIENTS = 8
# Turns all poses are alike by if their angles differ by less.
ALIKE = 1e-9


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


class BodyScale(NamedTuple):
    """A body's point and a place of the frame that become origins, and the length that becomes one."""

    point: complex
    place: complex
    length: float

    @classmethod
    def of(cls, z: Number, u: Number) -> BodyScale:
        """Choose the body's point that moves least: least squares of its distances from one place."""
        columns = np.stack([u, -np.ones_like(u)], axis=-1)
        if np.ptp(np.abs(u - u[0])) < ALIKE and abs(np.mean(u) - u[0]) < ALIKE:
            point, place = 0j, complex(np.mean(z))
        else:
            point, place = (complex(v) for v in np.linalg.lstsq(columns, -z, rcond=None)[0])
        length, whole = extent(z + u * point), extent(z)
        # two poses have a point that rests
        return cls(point, place, length if length > RESTING * whole else whole)


def rows_of(task: PoseTask, unit: BodyScale) -> Number:
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


def _normed(z: complex, u: complex, unit: BodyScale) -> tuple[complex, complex]:
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


def dyad_of(q: Number, unit: BodyScale) -> Dyad | None:
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
