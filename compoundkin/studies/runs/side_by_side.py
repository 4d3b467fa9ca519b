"""Work done side by side by an executor, with a bounded number of pieces under way."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from itertools import islice
from typing import TypeVar

from compoundkin.base.errors import InvalidInput, Problem

Piece = TypeVar("Piece")
Answer = TypeVar("Answer")


def answers(
    executor: Executor, work: Callable[[Piece], Answer], pieces: Iterable[Piece], room: Callable[[], int]
) -> Iterator[tuple[Piece, Answer]]:
    """Yield what some work answers to each piece, as soon as it does.

    So many are under way at a time as there is room for. What is not begun when the caller stops is cancelled.
    """
    waiting: dict[Future[Answer], Piece] = {}
    coming = iter(pieces)
    try:
        while True:
            for piece in islice(coming, max(0, room() - len(waiting))):
                waiting[_submitted(executor, work, piece)] = piece
            if not waiting:
                return
            for done in wait(waiting, return_when=FIRST_COMPLETED).done:
                yield waiting.pop(done), done.result()
    finally:
        for future in waiting:
            future.cancel()


def _submitted(executor: Executor, work: Callable[[Piece], Answer], piece: Piece) -> Future[Answer]:
    try:
        return executor.submit(work, piece)
    except BrokenExecutor:
        raise
    except RuntimeError as error:
        # what executors say that have been shut down
        raise InvalidInput(Problem("on", f"it takes no work: {error}", "give one that is open")) from None
