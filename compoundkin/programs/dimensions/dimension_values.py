"""What a call gives for free dimensions: points and numbers, held against the names that are free."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from compoundkin.base.display import short
from compoundkin.base.errors import InvalidInput, InvalidMechanism, Problem, nearest
from compoundkin.base.given_numbers import real_numbers
from compoundkin.base.series import Number
from compoundkin.model.geometry import vector
from compoundkin.programs.dimensions.free_dimension import FreeDimension
from compoundkin.programs.dimensions.stated_dimensions import StatedDimensions


def dimension_values(
    stated: StatedDimensions, free: Sequence[FreeDimension], given: Mapping[str, Any] | None
) -> dict[FreeDimension, Number]:
    """Return the values of all free dimensions.

    They are those that are given, else the mechanism's own. Raises InvalidInput for dimensions that are not free, and
    for what is no finite number or point.
    """
    given = {} if given is None else given
    if not isinstance(given, Mapping):
        raise InvalidInput(Problem("dimensions", f"{short(given)} is no table by name", 'write {"crank.B": ...}'))
    names = [one.name for one in free]
    wrong = [Problem(f"dimensions.{name}", *_not_free(stated, name, names)) for name in given if name not in names]
    if wrong:
        raise InvalidInput(wrong)
    return {one: _value(one, given[one.name]) if one.name in given else stated.own(one) for one in free}


def hold_laws(free: Sequence[FreeDimension], given: Mapping[str, Any] | None, times: Number | None) -> None:
    """Raise InvalidInput where numbers of laws are given and no law moves."""
    asked = [one.name for one in free if one.is_of_law and one.name in (given or {})]
    if asked and times is None:
        what, remedy = "the drivers' values are given, and no law moves them", "leave the values out, and give time=..."
        raise InvalidInput([Problem(f"dimensions.{name}", what, remedy) for name in asked])


def _not_free(stated: StatedDimensions, name: object, names: Sequence[str]) -> tuple[str, str]:
    if name in stated.known:
        return "this dimension is not free", f"compile(..., free={[*names, name]!r})"
    return "there is no such free dimension", nearest(name, names)


def _value(one: FreeDimension, value: Any) -> Number:
    where = f"dimensions.{one.name}"
    try:
        found = vector(where, value) if one.is_vector else real_numbers(where, value)
    except InvalidMechanism as error:
        raise InvalidInput(error.problems) from None
    if not np.size(found) or not np.isfinite(found).all():
        raise InvalidInput(Problem(where, "the value is empty or not finite"))
    if one.is_of_law and np.shape(found)[-1:] > (1,):
        what = f"it holds {np.shape(found)[-1]} numbers along the motion, in which a law cannot change"
        raise InvalidInput(Problem(where, what, "give one number, or one for each design: [[1.0], [2.0]]"))
    return found
