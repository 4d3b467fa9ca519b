"""What comes of a case of the stress suite."""

from __future__ import annotations

import signal
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any


@dataclass
class Outcome:
    """What came of a case."""

    number: int
    faults: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    counts: Counter[str] = field(default_factory=Counter)
    seconds: float = 0.0
    own_seconds: float = 0.0


def shown(numbers: list[int]) -> str:
    """Some indices, in short."""
    numbers = [int(k) for k in numbers]
    return ", ".join(map(str, numbers)) if len(numbers) < 7 else f"{numbers[0]}..{numbers[-1]} ({len(numbers)})"


class TooSlow(Exception):
    """The case was broken off."""


@contextmanager
def broken_off(after: float) -> Iterator[None]:
    """Raise TooSlow where something takes longer."""

    def stop(*_: Any) -> None:
        raise TooSlow

    old = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, after)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, old)
