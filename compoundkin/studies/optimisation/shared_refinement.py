"""Several designs refined side by side: what their searches ask for is computed in one call for all of them."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from threading import Condition
from typing import Any

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.studies.optimisation.design_problem import DesignProblem, SearchedDesigns
from compoundkin.studies.optimisation.search_space import SearchSpace
from compoundkin.studies.optimisation.single_design import DesignsOfSearch

Refine = Callable[[DesignsOfSearch, Number, Number], Number]


@dataclass(eq=False, repr=False)
class _Round(ShortRepr):
    """What all searches ask for; it is computed when the last of those that go on has asked.

    So each round has the same designs whatever the threads do, and the answer does not depend on them.
    """

    problem: DesignProblem
    live: int
    asked: dict[int, Number] = field(default_factory=dict)
    answers: dict[int, tuple[SearchedDesigns, int] | Exception] = field(default_factory=dict)
    changed: Condition = field(default_factory=Condition)

    def at(self, search: int, parts: Number) -> tuple[SearchedDesigns, int]:
        """Return the designs of a round, and which of them is that of a search."""
        with self.changed:
            self.asked[search] = parts
            self._compute()
            while search not in self.answers:
                self.changed.wait()
            found = self.answers.pop(search)
        if isinstance(found, Exception):
            raise found
        return found

    def leave(self) -> None:
        """Note that a search has ended."""
        with self.changed:
            self.live -= 1
            self._compute()

    def _compute(self) -> None:
        if not self.asked or len(self.asked) < self.live:
            return
        searches = sorted(self.asked)
        try:
            designs = self.problem.at(np.stack([self.asked[one] for one in searches]))
            _ = designs.assembled
            self.answers.update({one: (designs, place) for place, one in enumerate(searches)})
        except Exception as error:  # each search ends by it, and none waits for ever
            self.answers.update(dict.fromkeys(searches, error))
        self.asked.clear()
        self.changed.notify_all()


@dataclass(frozen=True, eq=False, repr=False)
class SharedProblem(ShortRepr):
    """The problem as one of the searches sees it."""

    space: SearchSpace
    together: _Round
    search: int

    def at(self, parts: Number) -> SharedDesign:
        """Return one design by parts of the ranges."""
        return SharedDesign(parts[None, :], *self.together.at(self.search, parts), self.together.changed)


@dataclass(frozen=True, eq=False, repr=False)
class SharedDesign(ShortRepr):
    """One design of a round: each of its numbers has one row."""

    parts: Number
    designs: SearchedDesigns
    place: int
    lock: Condition

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        with self.lock:
            return getattr(self.designs, name)[self.place : self.place + 1]


def refined_together(
    problem: DesignProblem, parts: list[Number], scales: Number, refine: Refine, tell: Callable[[int], None]
) -> list[Number]:
    """Return designs refined by a method of SciPy, each from its own start. `tell` is told how many are done."""
    if not parts:
        return []
    together, done = _Round(problem, len(parts)), []

    def work(search: int) -> Number:
        try:
            with np.errstate(all="ignore"):
                return refine(SharedProblem(problem.space, together, search), parts[search], scales)
        finally:
            together.leave()

    with warnings.catch_warnings(), ThreadPoolExecutor(len(parts)) as threads:
        # SciPy says where slopes did not change from one step to the next
        warnings.simplefilter("ignore", UserWarning)
        for found in threads.map(work, range(len(parts))):
            done.append(found)
            tell(len(done))
    return done
