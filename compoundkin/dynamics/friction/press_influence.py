"""How friction presses pairs together: what the forces there are without it, and what a unit of each friction adds.

Reactions are linear in the loads, friction among them, at a given pose. So a reverse pass for each friction tells all
that iterations need, in either direction of motion; none of them walks through the mechanism again.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.linear import solve

# Powers of the gains that tell the largest entry of Perron's vector, with a shift against vectors that alternate.
ROUNDS, SHIFT = 50, 0.1


@dataclass(frozen=True)
class PressInfluence:
    """The forces that press rubbing pairs together. They are affine in the sizes of the frictions.

    `own` (presses, poses) are those without friction, complex; `by` (frictions, presses, poses) what a unit of each
    friction adds; `starts` (frictions) are the first press of each friction.
    """

    own: Number
    by: Number
    starts: Number

    def of(self, which: Number) -> PressInfluence:
        """Return those of some poses."""
        return PressInfluence(self.own[:, which], self.by[..., which], self.starts)

    def normal_forces(self, sizes: Number) -> Number:
        """Return the forces (presses, poses) under frictions of these sizes (frictions, poses)."""
        total = self.own
        for one, size in zip(self.by, sizes, strict=True):
            total = total + one * size
        return total

    def sums(self, values: Number) -> Number:
        """Return sums over the presses of each friction. The values are (..., presses, poses)."""
        if len(self.starts) == len(self.own):
            return values
        return np.add.reduceat(values, self.starts, axis=-2)

    def rounding(self, sizes: Number) -> Number:
        """Return how large the terms are that cancel in the presses. It is the largest at each pose."""
        total = np.abs(self.own)
        for one, size in zip(self.by, sizes, strict=True):
            total = total + np.abs(one) * np.abs(size)
        return total.max(axis=0)

    def gains(self, signs: Number) -> Number:
        """Return how much each friction presses each pair at most, (poses, pairs, frictions)."""
        return (self.sums(np.abs(self.by)) * np.abs(signs)[:, None]).transpose(2, 1, 0)

    def contracts(self, signs: Number) -> Number:
        """Tell where frictions have one solution for any load.

        There the matrix one minus the gains is an M-matrix. Then the iteration contracts in some weighted norm.
        Source: A. Berman and R. J. Plemmons, Nonnegative Matrices in the Mathematical Sciences, theorem 6.2.3.
        """
        gains = self.gains(signs)
        # the plain norm tells it of most mechanisms
        sure: Number = gains.sum(axis=-1).max(axis=-1) < 1.0
        asked = np.flatnonzero(~sure)
        if len(asked):
            weights = solve(np.eye(gains.shape[-1]) - gains[asked], np.ones((len(asked), gains.shape[-1])))
            sure[asked] = np.all(weights > 0.0, axis=-1)
        return sure

    def feeding(self, signs: Number) -> Number:
        """Return how much the frictions feed on each other, (poses, frictions).

        It is Perron's vector of the gains, with 1 for the greatest.
        """
        gains, vector = self.gains(signs), np.ones(signs.T.shape)
        for _ in range(ROUNDS):
            vector = np.einsum("pij,pj->pi", gains, vector) + SHIFT * vector
            vector = vector / vector.max(axis=-1, keepdims=True)
        return vector
