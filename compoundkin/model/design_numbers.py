"""One design of several: the numbers that belong to it, and the mechanism that it is by itself."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import fields, is_dataclass, replace
from math import prod
from typing import Any

import numpy as np

from compoundkin.base.series import Number
from compoundkin.model.mechanism import Mechanism


def number_of_design(value: Any, shape: tuple[int, ...], design: int) -> Any:
    """Return a design's part of numbers, arrays, or tables of them.

    Arrays broadcast with a motion's shape; those of one axis are the same for all designs.

    >>> number_of_design(np.array([[1.0], [2.0]]), (2, 73), 1), number_of_design(3.0, (2, 73), 1)
    (2.0, 3.0)
    """
    if isinstance(value, np.ndarray):
        return _row(value, shape, design) if value.ndim > 1 else value
    if isinstance(value, Mapping):
        return {key: number_of_design(one, shape, design) for key, one in value.items()}
    if type(value) is tuple:
        return tuple(number_of_design(one, shape, design) for one in value)
    return value


def mechanism_of_design(mechanism: Mechanism, shape: tuple[int, ...], design: int) -> Mechanism:
    """Return the mechanism that one of several designs is. The shape is that of its motion.

    >>> from compoundkin.model.elements import drive, link
    >>> lengths = np.array([[1.0], [2.0]])
    >>> cranks = Mechanism("m", link("frame", A=0), link("crank", A=0, B=lengths), drive("crank"))
    >>> mechanism_of_design(cranks, (2, 73), 1).links["crank"].points["B"]
    (2+0j)
    """
    with warnings.catch_warnings():
        # what there is to say was said of the whole
        warnings.simplefilter("ignore")
        return Mechanism(
            mechanism.title,
            *(_item(item, shape, design) for item in mechanism.items),
            source=mechanism.source,
            description=mechanism.description,
            outputs=mechanism.outputs,
            time=number_of_design(mechanism.time, shape, design),
            **mechanism.unit_words,
        )


def _item(item: Any, shape: tuple[int, ...], design: int) -> Any:
    """Return an item with the numbers of one design, itself where it has no others."""
    if not is_dataclass(item) or isinstance(item, type):
        return item
    held = {field.name: getattr(item, field.name) for field in fields(item) if field.init}
    own = {name: number_of_design(value, shape, design) for name, value in held.items()}
    changed = {name: value for name, value in own.items() if value is not held[name]}
    return replace(item, **changed) if changed else item


def _row(value: Number, shape: tuple[int, ...], design: int) -> Number:
    last = value.shape[-1]
    row = np.broadcast_to(value, (*shape[:-1], last)).reshape(prod(shape[:-1]), last)[design]
    return row.item() if last == 1 else row
