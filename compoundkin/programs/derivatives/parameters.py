"""What is given with the call of an objective besides drivers and dimensions, by name."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.given_numbers import planar_numbers, real_numbers
from compoundkin.base.series import Number
from compoundkin.kinematics.inputs import fit
from compoundkin.programs.calls.call_numbers import CallNumbers
from compoundkin.programs.derivatives.recorded_objective import parts


def with_parameters(numbers: CallNumbers, given: Mapping[str, Any]) -> tuple[CallNumbers, dict[str, bool]]:
    """Return the numbers of a call with those given by name.

    It tells of each name whether it is complex. Raises InvalidInput for what is no number, not finite, or does not
    broadcast.
    """
    arrays = {name: _array(name, value) for name, value in sorted(given.items())}
    shape = numbers.shape
    for name, array in arrays.items():
        try:
            shape = np.broadcast_shapes(shape, array.shape)
        except ValueError:
            what = f"shape {array.shape} does not broadcast with {shape}"
            raise InvalidInput(Problem(name, what, "the last axis is the motion")) from None
    found = numbers.reshaped(shape)
    more = dict(found.given)
    for name, array in arrays.items():
        whole = np.atleast_2d(fit(shape)(array))
        for part, number in zip(parts(name, np.iscomplexobj(array)), (whole.real, whole.imag), strict=False):
            more[part] = np.asarray(number, float)
    return replace(found, given=more), {name: np.iscomplexobj(array) for name, array in arrays.items()}


def _array(name: str, value: Any) -> Number:
    planar = planar_numbers(name, value)
    array = planar if np.iscomplexobj(value) else real_numbers(name, value)
    if array.size == 0 or not np.isfinite(array).all():
        raise InvalidInput(Problem(name, "the value is empty or not finite"))
    return array
