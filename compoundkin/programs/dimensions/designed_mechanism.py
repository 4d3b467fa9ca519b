"""The mechanism itself with other values of its free dimensions; all else of it is kept."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from compoundkin.base.given_numbers import plain
from compoundkin.base.series import Number
from compoundkin.model.elements import Drive, Link
from compoundkin.model.field_numbers import fields_with
from compoundkin.model.laws.law_numbers import law_with
from compoundkin.model.mechanism import Mechanism
from compoundkin.programs.dimensions.free_dimension import FreeDimension
from compoundkin.programs.dimensions.moved_drives import moved_drives
from compoundkin.programs.dimensions.stated_dimensions import StatedDimensions


def designed(stated: StatedDimensions, values: Mapping[FreeDimension, Number]) -> Mechanism:
    """Return the mechanism with these dimensions, several designs where they are arrays.

    What its pairs read off the drawing stays as it was. Raises InvalidMechanism for dimensions that
    no such mechanism can have.
    """
    links: dict[str, dict[str, Number]] = {}
    numbers: dict[str, dict[str, Number]] = {}
    for one, value in values.items():
        if one.is_of_link:
            points = links.setdefault(one.owner, dict(stated.mechanism.geometry.points[one.owner]))
            points[one.word] = plain(value if one.is_vector else _with_part(points[one.word], one.part, value))
        elif not one.is_of_law:
            numbers.setdefault(one.owner, {})[one.number] = plain(value)
    items: list[Any] = [Link(name, points) for name, points in links.items()]
    for name, item in stated.items.items():
        changes = {**stated.read_off.get(name, {}), **fields_with(item, numbers.get(name, {}))}
        if changes:
            items.append(replace(item, **changes))
    own = [item for item in stated.mechanism.items if isinstance(item, Drive)]
    drives = moved_drives(own, values, law_with)
    if any(np.shape(value)[-1:] > (1,) for value in values.values()):
        # a motion of its own, which is perhaps not as long as that along which dimensions vary
        drives = [replace(one, values=None) if isinstance(one.values, np.ndarray) else one for one in drives]
    items += [one for one, before in zip(drives, own, strict=True) if one is not before]
    return stated.mechanism.replace(*items) if items else stated.mechanism


def _with_part(point: Number, part: str, value: Number) -> Number:
    return value + 1j * np.imag(point) if part == "x" else np.real(point) + 1j * value
