"""Numbers of an item by name: what it states under its keys, and fields with others in their place."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

# Kinds of keys that are one real number, or two; arrays of them for several designs.
_ONE, _TWO = ("length", "angle", "number", "turn", "coordinate", "rate", "span"), ("two", "reach", "sweep")


def numbers_of(item: Any) -> dict[str, Any]:
    """Return the numbers that an item states: "offset", or "radii.0" of two.

    >>> from compoundkin.model.pairs import gear
    >>> sorted(numbers_of(gear("sun", "planet", carrier="arm", teeth=(20, 40))))
    ['pressure_angle', 'teeth.0', 'teeth.1']
    """
    found: dict[str, Any] = {}
    for key in item.keys:
        value = getattr(item, key.name)
        if key.kind in _ONE:
            found[key.name] = value
        elif key.kind in _TWO and value is not None:
            found |= {f"{key.name}.{index}": one for index, one in enumerate(value)}
    return {name: value for name, value in found.items() if value is not None and not isinstance(value, str)}


def fields_with(item: Any, numbers: Mapping[str, Any]) -> dict[str, Any]:
    """Return the fields of an item that these numbers change.

    They are named as `numbers_of` does.

    >>> from compoundkin.model.pairs import gear
    >>> fields_with(gear("sun", "planet", carrier="arm", teeth=(20, 40)), {"teeth.1": 30})
    {'teeth': (20.0, 30)}
    """
    found: dict[str, Any] = {}
    for name, value in numbers.items():
        field, _, index = name.partition(".")
        if index:
            two = found.get(field, getattr(item, field))
            found[field] = (value, two[1]) if index == "0" else (two[0], value)
        else:
            found[field] = value
    return found
