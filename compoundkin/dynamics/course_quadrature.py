"""Integrals of functions along a motion, between its poses too: Gauss's rule on smooth pieces."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.kinematics.extremes import Places
from compoundkin.kinematics.extremes.stretches import stretches_of
from compoundkin.kinematics.motion import Motion

# Values (functions, n) at places (n,) of designs (n,).
Integrand: TypeAlias = Callable[[Number, Number], Number]
# Gauss's points on a piece: exact for polynomials of degree 15.
POINTS, WEIGHTS = np.polynomial.legendre.leggauss(8)
# A piece is halved where both halves together differ from it by more than this part of the sum of all pieces' sizes.
TRUSTED = 1e-13
# So often at most: next to a limit position integrands grow without limit.
HALVINGS = 12


@dataclass(frozen=True, eq=False, repr=False)
class Pieces(ShortRepr):
    """Smooth pieces of a motion, in order along each design, between the places `low` and `high`; arrays (n,)."""

    design: Number
    low: Number
    high: Number

    def __len__(self) -> int:
        return len(self.low)


def smooth_pieces(motion: Motion, cuts: Places | None = None) -> Pieces:
    """Return the smooth pieces of a motion between its poses, cut at further places."""
    s = stretches_of(motion)
    pieces = Pieces(s.design, s.low, s.high)
    return pieces if cuts is None else _cut(pieces, cuts.design, cuts.place)


def _cut(pieces: Pieces, designs: Number, places: Number) -> Pieces:
    rows = np.stack([pieces.design, pieces.low, pieces.high], axis=-1).astype(float)
    for design, place in zip(designs.tolist(), places.tolist(), strict=True):
        inside = np.flatnonzero((rows[:, 0] == design) & (rows[:, 1] < place) & (place < rows[:, 2]))
        after = rows[inside].copy()
        rows[inside, 2], after[:, 1] = place, place
        rows = np.concatenate([rows, after])
    rows = rows[np.lexsort((rows[:, 1], rows[:, 0]))]
    return Pieces(rows[:, 0].astype(int), rows[:, 1], rows[:, 2])


def integrals(of: Integrand, pieces: Pieces) -> Number:
    """Return the integrals of functions over places, (functions, pieces)."""
    total = _gauss(of, pieces)
    index = np.arange(len(pieces))
    going, known = pieces, total
    for _ in range(HALVINGS):
        middle = 0.5 * (going.low + going.high)
        halves = Pieces(np.repeat(going.design, 2), _two(going.low, middle), _two(middle, going.high))
        parts = _gauss(of, halves)
        change = parts[:, ::2] + parts[:, 1::2] - known
        np.add.at(total.T, index, change.T)
        size = np.sum(np.abs(total), axis=1, keepdims=True)
        off = np.flatnonzero(np.any(np.abs(change) > TRUSTED * size, axis=0))
        if not len(off):
            break
        both_halves = np.repeat(2 * off, 2) + np.tile([0, 1], len(off))
        going = Pieces(*(v[both_halves] for v in (halves.design, halves.low, halves.high)))
        known, index = parts[:, both_halves], np.repeat(index[off], 2)
    return total


def _two(one: Number, other: Number) -> Number:
    return np.stack([one, other], axis=-1).ravel()


def nodes(pieces: Pieces) -> tuple[Number, Number, Number]:
    """Return designs, places and weights of Gauss's rule."""
    half = 0.5 * (pieces.high - pieces.low)[:, None]
    places = 0.5 * (pieces.low + pieces.high)[:, None] + half * POINTS
    return np.repeat(pieces.design, len(POINTS)), places.ravel(), (half * WEIGHTS).ravel()


def _gauss(of: Integrand, pieces: Pieces) -> Number:
    designs, places, weights = nodes(pieces)
    values = of(designs, places) * weights
    found: Number = values.reshape(len(values), len(pieces), len(POINTS)).sum(axis=-1)
    return found
