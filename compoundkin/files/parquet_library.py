"""The library of Parquet files, which comes with an extra of the package and is imported when it is needed."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from compoundkin.base.errors import missing_extra


def parquet(where: str = "") -> Any:
    """Return `pyarrow.parquet`. Raises InvalidInput, which names a place, where it is not installed."""
    try:
        import_module("pyarrow")
        return import_module("pyarrow.parquet")
    except ImportError:
        raise missing_extra(where, "this needs pyarrow", "parquet") from None
