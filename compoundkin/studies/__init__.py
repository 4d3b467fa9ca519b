"""Studies of many designs: sweeps, tolerance analyses and optimisations of dimensions."""

from __future__ import annotations

from typing import Any

__all__ = ["load_study", "study_schema"]
# Names loaded on access, so that a part of the room does not import all of it.
_LATE = {"load_study": "study", "study_schema": "study_document"}


def __getattr__(name: str) -> Any:
    if name in _LATE:
        from importlib import import_module

        return getattr(import_module(f"{__name__}.{_LATE[name]}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
