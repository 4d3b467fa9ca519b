"""Copies and pickles: of what an object was made, not of what was found since; functions that cannot be pickled."""

from __future__ import annotations

import pickle
from collections.abc import Callable
from dataclasses import fields
from typing import Any, ClassVar, Self, TypeVar

from compoundkin.base.errors import InvalidInput, Problem

Made = TypeVar("Made")


class CopiesFields:
    """A dataclass that is copied and pickled by its fields alone."""

    def __getstate__(self) -> dict[str, Any]:
        own: Any = self
        return {field.name: getattr(self, field.name) for field in fields(own)}


class HoldsFunction(CopiesFields):
    """A frozen dataclass with a Python function, which perhaps cannot be pickled."""

    held: ClassVar[str]  # the field with the function

    def __getstate__(self) -> dict[str, Any]:
        function: Callable[..., Any] = getattr(self, self.held)
        try:
            pickle.dumps(function)
        except (pickle.PicklingError, AttributeError, TypeError):
            name = getattr(function, "__qualname__", repr(function))
            what = f"the function {name!r} cannot be pickled"
            raise InvalidInput(Problem(self.held, what, "define it with def, not in another function")) from None
        return super().__getstate__()

    def __copy__(self) -> Self:
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> Self:
        return self


def unchecked(item: Made, **changes: Any) -> Made:
    """Return a copy of a frozen dataclass with other fields, unchecked.

    What was found of it since is found again.
    """
    own: Any = item
    copied = object.__new__(type(item))
    copied.__dict__.update({field.name: getattr(item, field.name) for field in fields(own)}, **changes)
    return copied
