"""Kinds of equilibrium: by the definiteness of the stiffness, or by the sign of the effort beside."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr

STABLE, UNSTABLE, SADDLE, INDIFFERENT = "stable", "unstable", "saddle", "indifferent"
# To one side it returns, to the other it goes on.
HALF_STABLE = "half-stable"
# A stiffness below this part of what a load asks over a radian, or the mechanism's size, is none: what differences
# leave of one.
NONE = 1e-8


@dataclass(frozen=True, eq=False, repr=False)
class EquilibriumPosition(ShortRepr):
    """An equilibrium position: the drivers' values and its kind.

    It is "stable", "unstable", of several drivers a "saddle", "indifferent" where it stays beside as well, or
    "half-stable". `stiffness` (free drivers, free drivers) are the derivatives of the holding efforts by the values.
    """

    values: Mapping[str, float]
    stability: str
    stiffness: Number

    @property
    def is_stable(self) -> bool:
        """Whether it returns from all sides."""
        return self.stability == STABLE


def kind_of(stiffness: Number, scales: Number, sense: float = 0.0, stays: bool = False) -> str:
    """Return the kind of an equilibrium.

    `scales` are the stiffnesses that rounding is relative to, `sense` tells whether one driver's effort grows.
    """
    if stays:
        return INDIFFERENT
    root = np.sqrt(np.where(scales > 0.0, scales, 1.0))
    own = stiffness / np.outer(root, root)
    sizes = np.linalg.eigvalsh(own) if np.all(np.isfinite(own)) else np.zeros(1)
    if np.all(np.abs(sizes) > NONE):
        return STABLE if np.all(sizes > 0) else UNSTABLE if np.all(sizes < 0) else SADDLE
    if len(scales) == 1:
        return {1.0: STABLE, -1.0: UNSTABLE}.get(float(np.sign(sense)), HALF_STABLE)
    return SADDLE if np.any(sizes < -NONE) and np.any(sizes > NONE) else INDIFFERENT
