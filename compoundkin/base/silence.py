"""Warnings that a study tells as columns of its rows, kept still while several threads compute."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from threading import Lock

from compoundkin.base.errors import FewDigits, UnassembledPoses

_lock = Lock()
# Filters of warnings belong to the whole process: who comes first puts them up, who goes last takes them away.
_inside: list[ExitStack] = []
_count = [0]


@contextmanager
def silence() -> Iterator[None]:
    """Keep warnings of unassembled poses and few digits still. Threads may do so side by side."""
    with _lock:
        _count[0] += 1
        if _count[0] == 1:
            _inside.append(ExitStack())
            _inside[0].enter_context(warnings.catch_warnings())
            for told in (UnassembledPoses, FewDigits):
                warnings.simplefilter("ignore", told)
    try:
        yield
    finally:
        with _lock:
            _count[0] -= 1
            if not _count[0]:
                _inside.pop().close()
