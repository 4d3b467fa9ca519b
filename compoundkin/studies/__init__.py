"""Studies of many designs: sweeps, tolerance analyses and optimisations of dimensions.

A study has three independent parts: variations of dimensions and samples of designs (`samples/`: any rows alone, with
the same bits as in bulk), and responses (`responses/`: values and exact slopes of a quantity, a figure, a sum). Figures
are extremes of the compiled course, found where its slope by the driver changes sign; their slopes are those of the
course there. Studies, tolerances and goals use responses, not compiled paths. Rows are computed in blocks that begin at
fixed rows, so that chunks, threads, workers and restarts change no bit; a folder knows its rows by the names of its
parts, and every task is a range of rows that may be done twice.

A goal has residuals or one number for each trial design, a constraint margins, both with slopes. Many starts descend
together, because a call costs the same for one design and for hundreds; SciPy then refines the best distinct ends,
several searches side by side, with one call for each round of their requests. A design that does not assemble is NaN
and shortens a step. The result is verified.
"""

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
