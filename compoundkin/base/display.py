"""Objects that show themselves: a registry of ways, filled by what comes after them, and who asks it."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from importlib import import_module
from typing import Any

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
