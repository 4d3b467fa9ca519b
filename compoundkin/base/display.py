"""Objects that show themselves: a registry of ways, filled by what comes after them, and who asks it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields
from functools import cached_property
from importlib import import_module
from typing import Any

import numpy as np

# What can be asked for, and the function that answers, as "module:function": loaded when it is asked for.
_WAYS: dict[str, str] = {}


def register(**ways: str) -> None:
    """Enter functions that show objects, each as ``module:function``."""
    _WAYS.update(ways)


def way(name: str) -> Callable[..., Any]:
    """Return a registered function; its module is loaded now."""
    module, function = _WAYS[name].split(":")
    found: Callable[..., Any] = getattr(import_module(module), function)
    return found


class Shows:
    """What a notebook shows of an object: tables and pictures as HTML."""

    def _repr_html_(self) -> str | None:
        """As HTML; None where the text says it better, or where it would take long."""
        made: str | None = way("html")(self)
        return made


class ShowsPicture(Shows):
    """An object that has a picture too, drawn once."""

    def _repr_svg_(self) -> str | None:
        """As SVG; None where there is no picture, or where it would take long."""
        return self._picture

    @cached_property
    def _picture(self) -> str | None:
        made: str | None = way("svg")(self)
        return made


# So many entries of a mapping or a tuple are printed; of more, their number.
_PRINTED = 4


class PrintsShort:
    """A dataclass that prints its arrays as their shapes, and long mappings and tuples as their lengths."""

    def __repr__(self) -> str:
        told = (f"{field.name}={short(getattr(self, field.name))}" for field in fields(self))  # type: ignore[arg-type]
        return f"{type(self).__name__}({', '.join(told)})"


def short(value: Any) -> str:
    """Print a value in a few words.

    >>> short(np.zeros((2, 360))), short((1, 2)), short(range(9)), short(tuple(range(9)))
    ('array (2, 360)', '(1, 2)', 'range(0, 9)', '9 values')
    """
    if isinstance(value, np.ndarray):
        return f"array {value.shape}"
    if isinstance(value, Mapping):
        inside = ", ".join(f"{key}: {short(one)}" for key, one in value.items())
        return f"{{{inside}}}" if len(value) <= _PRINTED else f"{len(value)} entries"
    if type(value) is tuple:
        inside = ", ".join(map(short, value)) + ("," if len(value) == 1 else "")
        return f"({inside})" if len(value) <= _PRINTED else f"{len(value)} values"
    return repr(value)
