"""Drivers whose laws have other numbers: a program is given their values and rates, not the numbers themselves."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from compoundkin.base.errors import InvalidInput, InvalidMechanism
from compoundkin.base.given_numbers import plain
from compoundkin.base.series import Number
from compoundkin.model.elements import Drive
from compoundkin.model.laws.laws_of_designs import moved_law
from compoundkin.programs.dimensions.free_dimension import FreeDimension


def moved_drives(
    drives: Sequence[Drive],
    values: Mapping[FreeDimension, Number],
    how: Callable[[Any, Mapping[str, Number]], Any] = moved_law,
) -> list[Drive]:
    """Return drivers with other numbers of their laws. Raises InvalidMechanism for those that no law can have.

    What is no number of a law is passed over. Arrays are those of designs, `how` makes a law with them.
    """
    numbers: dict[str, dict[str, Number]] = {}
    for one, value in values.items():
        if one.is_of_law:
            numbers.setdefault(one.owner, {})[one.part] = plain(value)
    return [replace(one, law=how(one.law, numbers[one.name])) if one.name in numbers else one for one in drives]


def moved_by_call(drives: Sequence[Drive], values: Mapping[FreeDimension, Number]) -> list[Drive]:
    """Return drivers as `moved_drives` does; raises InvalidInput for numbers that no law can have."""
    try:
        return moved_drives(drives, values)
    except InvalidMechanism as error:
        raise InvalidInput([replace(one, where=f"dimensions: {one.where}") for one in error.problems]) from None
