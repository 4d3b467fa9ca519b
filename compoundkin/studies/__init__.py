"""Studies of many designs: what dimensions do to figures, tolerances, better dimensions."""

from __future__ import annotations

from typing import Any

__all__ = ["load_study", "study_schema"]
# Where each word is, loaded when it is asked for: whoever needs a part of this room needs not all of it.
_LATE = {"load_study": "study", "study_schema": "study_document"}


def __getattr__(name: str) -> Any:
    if name in _LATE:
        from importlib import import_module

        return getattr(import_module(f"{__name__}.{_LATE[name]}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
