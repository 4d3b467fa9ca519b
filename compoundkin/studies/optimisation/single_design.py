"""The functions of one design, as the methods of SciPy ask for them; the best design they came by is kept."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.studies.optimisation.design_problem import SearchedDesigns
from compoundkin.studies.optimisation.search_space import SearchSpace

# Margins violated by less than this part of their size hold: SciPy's methods end so near.
HELD = 1e-7
# What a design that cannot be assembled is worse by, in sizes of the objective: a line search takes a shorter step.
WORSE = 10.0


class DesignsOfSearch(Protocol):
    """The problem as a search of one design sees it, alone or beside others."""

    @property
    def space(self) -> SearchSpace:
        """Where it searches."""

    def at(self, parts: Number) -> Any:
        """Return one design by parts of the ranges, with all numbers of `SearchedDesigns`."""


@dataclass(eq=False, repr=False)
class SingleDesign(ShortRepr):
    """Objective and constraints at parts of the ranges, both in sizes of their own."""

    problem: DesignsOfSearch
    scales: Number
    best: Number
    size: float = 1.0
    _last: Any = field(init=False)
    _known: Any = field(init=False)

    def __post_init__(self) -> None:
        self._last = self._known = self.problem.at(self.best)
        self.merit = merit(self._last, self.scales)[0]
        self.size = max(abs(float(self._last.values[0])), np.finfo(float).tiny)

    def value(self, parts: Number) -> float:
        """Return the objective; of what cannot be assembled a great one."""
        at = self._at(parts)
        if not at.assembled[0]:
            return float(np.abs(self._known.values[0])) / self.size + WORSE
        return float(at.values[0]) / self.size

    def value_slopes(self, parts: Number) -> Number:
        """Return its slopes."""
        return _finite(self._at(parts).value_slopes[0]) / self.size

    def residuals(self, parts: Number) -> Number:
        """Return the residuals; NaN where it cannot be assembled."""
        return self._at(parts).residuals[0]

    def residual_slopes(self, parts: Number) -> Number:
        """Return their slopes."""
        return _finite(self._at(parts).residual_slopes[0])

    def margins(self, parts: Number) -> Number:
        """Return the margins; of what cannot be assembled those of the design before."""
        at = self._at(parts)
        return (at if at.assembled[0] else self._known).margins[0] / self.scales

    def margin_slopes(self, parts: Number) -> Number:
        """Return their slopes."""
        return _finite(self._at(parts).margin_slopes[0]) / self.scales[:, None]

    def _at(self, parts: Number) -> Any:
        inside = np.clip(parts, *self.problem.space.bounds)
        if not np.array_equal(inside, self._last.parts[0]):
            self._last = self.problem.at(inside)
            found = merit(self._last, self.scales)[0]
            if found < self.merit:
                self.best, self.merit = inside, found
            if self._last.assembled[0]:
                self._known = self._last
        return self._last


def merit(designs: SearchedDesigns, scales: Number, held: float = HELD) -> list[tuple[float, float]]:
    """Return what designs are compared by.

    It is violation first where there is more than `held`, then the objective.
    """
    violated = np.maximum(-designs.margins / scales, 0.0).sum(axis=1)
    pairs = zip(np.where(violated > held, violated, 0.0), designs.values, designs.assembled, strict=True)
    return [(float(off), float(value)) if good else (np.inf, np.inf) for off, value, good in pairs]


def _finite(slopes: Number) -> Number:
    return np.where(np.isfinite(slopes), slopes, 0.0)
