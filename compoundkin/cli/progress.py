"""A line on the terminal for work that takes long."""

from __future__ import annotations

import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from time import monotonic

# Work done before this many seconds needs no comment.
PATIENCE = 2.0
REFRESH = 0.5


@contextmanager
def working(what: str, patience: float = PATIENCE) -> Iterator[None]:
    """Say what is being done and for how long, on stderr, once it takes long and if that is a terminal.

    >>> with working("counting"):
    ...     sum(range(3))
    3
    """
    if not sys.stderr.isatty():
        yield
        return
    done = threading.Event()
    ticker = threading.Thread(target=_tick, args=(what, patience, done), daemon=True)
    ticker.start()
    try:
        yield
    finally:
        done.set()
        ticker.join()


def _tick(what: str, patience: float, done: threading.Event) -> None:
    start = monotonic()
    if done.wait(patience):
        return
    while True:
        line = f"{what} ... {monotonic() - start:.0f} s"
        sys.stderr.write(f"\r{line}")
        sys.stderr.flush()
        if done.wait(REFRESH):
            sys.stderr.write(f"\r{' ' * len(line)}\r")
            sys.stderr.flush()
            return
