"""The loop equations of an assembly, linear in unit rotations: the form in which they are solved.

In isotropic coordinates a vector z is the pair (z, z*), z* its conjugate where it is real geometry. Every
loop is an equation f = c + sum_k C_k X_k = 0 with its conjugate f* = c* + sum_k C*_k X*_k = 0. The unknowns X
are the rotations (X X* = 1 each), then the displacements of slides turned with their guides: X = s Theta, X* =
s / Theta. Bodies joined by a slide have one rotation up to a known angle.

Source: C. W. Wampler, Solving the kinematics of planar mechanisms by Dixon determinant and a complex-plane
formulation, J. Mech. Des. 123 (2001) 382, section 2.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from compoundkin.base.series import Number


@dataclass(frozen=True)
class Turning:
    """Which rotation each body has: `rotation[b]` an index or None for a known one, and the bodies' factors.

    `factors` (..., n, 2) are the isotropic unit numbers by which a body is turned from its rotation.
    """

    rotation: tuple[int | None, ...]
    factors: Number


@dataclass(frozen=True)
class Loops:
    """Loop equations: `constant` (..., l, 2), `columns` (..., unknowns, l, 2), the last axis f and f*.

    The first `rotations` unknowns are rotations; unknown `rotations` + i is the displacement of a slide whose
    guide has the rotation `guides[i]` (None for a known one). `origins` (..., n, 1 + unknowns, 2) give every
    body's origin, linear in 1 and the unknowns.
    """

    constant: Number
    columns: Number
    guides: tuple[int | None, ...]
    turning: Turning
    origins: Number

    @property
    def count(self) -> int:
        """The number of independent loops."""
        return int(self.constant.shape[-2])

    @property
    def rotations(self) -> int:
        """The number of unknown rotations."""
        return int(self.columns.shape[-3]) - len(self.guides)

    @property
    def batch(self) -> tuple[int, ...]:
        """The shape of the poses."""
        return np.broadcast_shapes(self.constant.shape[:-2], self.columns.shape[:-3])

    @cached_property
    def flat(self) -> Loops:
        """With all poses on one axis."""
        return self.select(np.arange(int(np.prod(self.batch))))

    def select(self, which: Number) -> Loops:
        """Some of the poses, counted over all axes of the batch."""

        def taken(array: Number, own: int) -> Number:
            wide = np.broadcast_to(array, (*self.batch, *array.shape[-own:])).reshape(-1, *array.shape[-own:])
            return wide[which]

        turning = Turning(self.turning.rotation, taken(self.turning.factors, 2))
        return Loops(taken(self.constant, 2), taken(self.columns, 3), self.guides, turning, taken(self.origins, 3))

    def changed(self, other: Loops, part: float) -> Loops:
        """The same bodies with dimensions moved by a part of those of another instance of the structure."""
        return replace(
            self, constant=self.constant + part * other.constant, columns=self.columns + part * other.columns
        )

    def bodies(self, x: Number) -> tuple[Number, Number]:
        """The orientations and origins (poses, solutions, n) of all bodies, from unknowns (poses, solutions, ...)."""
        full = np.concatenate([np.where(np.isfinite(x[..., :1]), 1.0, np.nan), x], axis=-1)
        rows = [0 if k is None else 1 + k for k in self.turning.rotation]
        return full[..., rows] * self.turning.factors[:, None, :, 0], full @ np.swapaxes(self.origins[..., 0], -1, -2)


def isotropic(z: Number) -> Number:
    """A complex array with its conjugate on a new last axis.

    >>> isotropic(1 + 2j)
    array([1.+2.j, 1.-2.j])
    """
    z = np.asarray(z, dtype=complex)
    return np.stack([z, np.conj(z)], axis=-1)
