"""The library of DXF files, which comes with an extra of the package and is imported when it is needed."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from typing import Any

from compoundkin.base.errors import InvalidInput, Problem


def ezdxf(where: str = "") -> Any:
    """Return `ezdxf`. Raises InvalidInput, which names a place, where it is not installed."""
    try:
        return import_module("ezdxf")
    except ImportError:
        raise InvalidInput(Problem(where, "DXF files need ezdxf", "pip install 'compoundkin[dxf]'")) from None


@contextmanager
def fixed_dates(library: Any) -> Iterator[None]:
    """Let it write fixed dates, so that the same drawing is the same bytes."""
    before = library.options.write_fixed_meta_data_for_testing
    library.options.write_fixed_meta_data_for_testing = True
    try:
        yield
    finally:
        library.options.write_fixed_meta_data_for_testing = before
