"""Copies, pickles and comparison: dataclasses by their fields without caches, functions, nested values."""

from __future__ import annotations

import pickle
from collections.abc import Callable, Mapping
from dataclasses import fields
from typing import Any, ClassVar, Self, TypeVar

import numpy as np

from compoundkin.base.errors import InvalidInput, Problem

Copied = TypeVar("Copied")


class CopiesFields:
    """A dataclass that is copied and pickled by its fields alone."""

    def __getstate__(self) -> dict[str, Any]:
        own: Any = self
        return {field.name: getattr(self, field.name) for field in fields(own)}


class CopiesFunction(CopiesFields):
    """A frozen dataclass with a Python function, which perhaps cannot be pickled."""

    function_field: ClassVar[str]  # the field with the function

    def __getstate__(self) -> dict[str, Any]:
        function: Callable[..., Any] = getattr(self, self.function_field)
        try:
            pickle.dumps(function)
        except (pickle.PicklingError, AttributeError, TypeError):
            name = getattr(function, "__qualname__", repr(function))
            what = f"the function {name!r} cannot be pickled"
            raise InvalidInput(
                Problem(self.function_field, what, "define it with def, not in another function")
            ) from None
        return super().__getstate__()

    def __copy__(self) -> Self:
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> Self:
        return self


def unchecked(item: Copied, **changes: Any) -> Copied:
    """Return a copy of a frozen dataclass with other fields, unchecked and without cached properties."""
    own: Any = item
    copied = object.__new__(type(item))
    copied.__dict__.update({field.name: getattr(item, field.name) for field in fields(own)}, **changes)
    return copied


def nested_equal(a: Any, b: Any) -> bool:
    """Return whether two nested values are equal, arrays element by element."""
    if isinstance(a, np.ndarray) or isinstance(b, np.ndarray):
        return np.shape(a) == np.shape(b) and bool(np.array_equal(a, b))
    if isinstance(a, Mapping) and isinstance(b, Mapping):
        return list(a) == list(b) and all(nested_equal(a[k], b[k]) for k in a)
    if isinstance(a, tuple | list) and isinstance(b, tuple | list):
        return len(a) == len(b) and all(nested_equal(x, y) for x, y in zip(a, b, strict=True))
    return bool(a == b)
