"""The library of planar geometry, which comes with an extra of the package and is imported when it is needed."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from compoundkin.base.errors import InvalidInput, Problem


def shapely(where: str = "interference") -> Any:
    """Return `shapely`. Raises InvalidInput, which names a place, where it is not installed."""
    try:
        return import_module("shapely")
    except ImportError:
        raise InvalidInput(Problem(where, "this needs shapely", "pip install 'compoundkin[interference]'")) from None
