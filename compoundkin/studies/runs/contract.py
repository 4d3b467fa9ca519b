"""Where the rows of a run go: memory or a folder."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from compoundkin.base.display import ShortRepr
from compoundkin.studies.runs.study_plan import StudyPlan
from compoundkin.studies.runs.study_rows import StudyRows


@dataclass(frozen=True, eq=False, repr=False)
class RunStore(ABC, ShortRepr):
    """Where the rows of a study go. `kept` says to people where those are that a stopped run leaves."""

    plan: StudyPlan

    @abstractmethod
    def missing(self) -> Iterator[range]:
        """Yield the rows that are not there yet."""

    @property
    @abstractmethod
    def task(self) -> Callable[[range], Any]:
        """What a worker does with some rows; it can be pickled."""

    @abstractmethod
    def take(self, rows: range, answer: Any) -> None:
        """Take what a worker answers."""

    @abstractmethod
    def finished(self) -> StudyRows:
        """Return all rows that are there, when nothing is missing any more."""

    @abstractmethod
    def kept(self) -> str:
        """Return what a stopped run leaves, in words, and what to do."""
