"""Dimensions of overconstrained mechanisms, of which few can be changed alone: the others open redundant pairs."""

from __future__ import annotations

import warnings
from collections.abc import Sequence

import numpy as np

from compoundkin.base.errors import CompoundkinError, InvalidInput, Problem
from compoundkin.base.series import Number
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.solution import solve
from compoundkin.programs.dimensions.designed_mechanism import designed
from compoundkin.programs.dimensions.free_dimension import FreeDimension
from compoundkin.programs.dimensions.stated_dimensions import StatedDimensions

# By which part of the size, or of itself, a dimension is changed: redundant pairs open by far more than by rounding.
CHANGE = 1e-3
ASIDE = 0.6 + 0.8j


def hold_consistent(motion: Motion, stated: StatedDimensions, free: Sequence[FreeDimension]) -> None:
    """Raise InvalidInput for a dimension that opens redundant pairs where it changes alone.

    Nothing is asked of a mechanism that is not overconstrained.
    """
    redundant = motion.structure.redundant
    for one in (each for each in free if redundant and not each.is_of_law):
        value = stated.own(one)
        step = CHANGE * (motion.size * ASIDE if one.is_vector else motion.size if one.is_of_link else _scale(value))
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                solve(designed(stated, {one: value + step}), {name: v[0] for name, v in motion.inputs.drives.items()})
        except CompoundkinError:
            pairs = ", ".join(pair.name for pair in redundant)
            what = f"the mechanism is overconstrained, it moves by its special dimensions only: {pairs} would open"
            raise InvalidInput(
                Problem(f"free.{one.name}", what, "leave it fixed, or take out what is redundant")
            ) from None


def _scale(value: Number) -> float:
    return float(np.max(np.abs(value))) or 1.0
