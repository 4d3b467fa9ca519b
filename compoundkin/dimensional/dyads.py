"""Dyads that guide a body through poses: all of five, a curve of them through four, those of a chosen place.

Equations and sources are those of `dyad_equations`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from itertools import combinations
from typing import Any

import numpy as np

from compoundkin.base.arguments import checked, planar_numbers
from compoundkin.base.arrays import Number
from compoundkin.base.display import DisplaysHtml, count_phrase, display_function
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.linear import one_thread
from compoundkin.dimensional.burmester_curve import BurmesterCurve, curve_of
from compoundkin.dimensional.dyad_equations import (
    ALIKE,
    COEFFICIENTS,
    PR,
    QUADRICS,
    REAL,
    RP,
    RR,
    BodyScale,
    Dyad,
    common_points,
    dyad_of,
    real_ones,
    rows_of,
)
from compoundkin.dimensional.task_words import poses
from compoundkin.dimensional.tasks import PoseTask, extent

KINDS = (RR, PR, RP)
# Rows of poses are dependent where a singular value is below this part of the greatest.
DEPENDENT = 1e-10
# Points of a circle that rolls in one of twice its size run on its diameters (Cardan), lines through them likewise.
CARDAN = "Cardan motion: a slider in every direction takes these poses"


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
    unit: BodyScale = field(default=BodyScale(0j, 0j, 1.0), repr=False)

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
    unit = BodyScale.of(task.z, task.u)
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


def _cardan_sliders(basis: Number, unit: BodyScale) -> tuple[Dyad, ...]:
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


def _sliders(basis: Number, unit: BodyScale) -> tuple[Dyad, ...]:
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


def _special(task: PoseTask, unit: BodyScale) -> Dyads | None:
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
