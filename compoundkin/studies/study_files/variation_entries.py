"""What files say of a dimension, from the plain numbers of its variation and back: angles in degrees."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from compoundkin.base.errors import InvalidMechanism
from compoundkin.files import exact_numbers
from compoundkin.files.recovery import Recovery
from compoundkin.files.single_values import numbers, wrong
from compoundkin.files.written_quantities import coordinate, place
from compoundkin.studies.study_files.study_keys import WITH_UNIT

_HOW = "write { low = 40, high = 60 }, { centre = 50, within = 0.1 } or { values = [40, 50, 60] }"


def variation_data(raw: Any, where: str, is_angle: bool | None, log: Recovery) -> dict[str, Any] | None:
    """Return the plain numbers of a variation, radians. None where the entry is broken, which is reported.

    `is_angle` is None where it is not known, for the mechanism is broken.
    """
    if not isinstance(raw, dict):
        log.report(wrong(where, raw, "a table", _HOW))
        return None
    before = len(log.problems)
    found = {}
    for key, value in raw.items():
        try:
            found[key] = _plain(value, f"{where}.{key}", is_angle) if key in WITH_UNIT else value
        except InvalidMechanism as error:
            log.report(error)
    return found if len(log.problems) == before else None


def variation_entry(data: Mapping[str, Any], is_angle: bool) -> dict[str, Any]:
    """Return what a file says of a variation.

    >>> variation_entry({"low": 0.0, "high": np.deg2rad(30.0)}, True)
    {'low': 0, 'high': 30}
    """
    return {key: _shown(value, is_angle and key in WITH_UNIT) for key, value in data.items()}


def _plain(value: Any, where: str, is_angle: bool | None) -> Any:
    """Return numbers and points as plain lists."""
    if isinstance(value, dict) and "polar" in value:
        found = place(value, where)
        return [found.real, found.imag]
    if isinstance(value, list) and any(isinstance(one, dict) for one in value):
        whole = [_plain(one, f"{where}[{index}]", is_angle) for index, one in enumerate(value)]
        return np.asarray(numbers(whole, where)).tolist()
    return np.asarray(coordinate(value, where, is_angle)).tolist()


def _shown(value: Any, is_angle: bool) -> Any:
    if is_angle:
        return exact_numbers.degrees(np.asarray(value, dtype=float))
    if isinstance(value, list | tuple):
        return [_shown(one, False) for one in value]
    return exact_numbers.plain(value) if isinstance(value, float) else value
