"""A line on the terminal for work that takes long."""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from time import monotonic

# Work done before this many seconds needs no comment.
PATIENCE = 2.0
REFRESH = 0.5


@contextmanager
def working(what: str, patience: float = PATIENCE) -> Iterator[None]:
    """Say what is being done and for how long, on stderr. It says so once it takes long and if that is a terminal.

    >>> with working("counting"):
    ...     sum(range(3))
    3
    """
    if not _is_seen():
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


def _is_seen() -> bool:
    """Tell whether somebody sees stderr: it is a terminal, and not closed."""
    return sys.stderr is not None and sys.stderr.isatty()


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


@contextmanager
def counting(what: str, things: str, patience: float = PATIENCE) -> Iterator[Callable[[int, int], None]]:
    """Yield a function to be told how much is done, of how much. It shows a bar on stderr as `working` shows a line.

    >>> with counting("drawing", "frames") as progress:
    ...     progress(1, 2)
    """
    start, shown = monotonic(), ExitStack()
    update: list[Callable[[int, int], None]] = []

    def told(done: int, total: int) -> None:
        if not update and monotonic() - start >= patience and _is_seen():
            update.append(shown.enter_context(_bar(what, things)))
        for tell in update:
            tell(done, total)

    with shown:
        yield told


@contextmanager
def _bar(what: str, things: str) -> Iterator[Callable[[int, int], None]]:
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = TextColumn(what), BarColumn(), MofNCompleteColumn(), TextColumn(things), TimeRemainingColumn()
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(what)
        yield lambda done, total: bar.update(task, completed=done, total=total)
