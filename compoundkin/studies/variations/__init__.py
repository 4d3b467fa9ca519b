"""What dimensions may be in a study: one file for each kind; of this registry the first that fits is taken."""

from __future__ import annotations

from typing import Any

from compoundkin.base.display import short
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.studies.variations.contract import Variation
from compoundkin.studies.variations.value_range import ValueRange


def variation_of(where: str, given: Any) -> Variation:
    """Return what is given for a dimension as a variation.

    Raises InvalidInput for what is none.
    """
    if isinstance(given, Variation):
        return given
    if isinstance(given, tuple) and len(given) == 2:
        return ValueRange(float(given[0]), float(given[1]))
    raise InvalidInput(Problem(where, f"{short(given)} is nothing that a dimension can be", "give a range (40, 60)"))
