"""Local minima among the ends of searches: which are the same, and how many searches ended at each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.studies.optimisation.design_problem import DesignProblem
from compoundkin.studies.optimisation.single_design import HELD, merit

# Ends are the same design where all their dimensions are within this part of the ranges: searches end far closer.
SAME = 1e-3


@dataclass(frozen=True, eq=False, repr=False)
class EndedSearch(ShortRepr):
    """A design at which searches ended, by parts of the ranges.

    `searches` are those, by number.
    """

    parts: Number
    violation: float
    value: float
    searches: tuple[int, ...]
    is_refined: bool = True

    @property
    def rank(self) -> tuple[float, float]:
        """What ends are compared by."""
        return self.violation, self.value


def ended_searches(
    problem: DesignProblem,
    parts: Number,
    scales: Number,
    held: float = HELD,
    searches: Sequence[tuple[int, ...]] | None = None,
) -> list[EndedSearch]:
    """Return the different designs among ends of searches, the best first.

    Violations below `held` do not count; `searches` say which ended at each. Those that are not assembled are
    left out.
    """
    which = [(k,) for k in range(len(parts))] if searches is None else searches
    found = merit(problem.at(parts), scales, held)
    order = sorted((k for k in range(len(parts)) if np.isfinite(found[k][1])), key=lambda k: (found[k], k))
    kept: list[EndedSearch] = []
    own = problem.space.own
    for k in order:
        for place, other in enumerate(kept):
            if np.abs(other.parts[:own] - parts[k, :own]).max() < SAME:
                kept[place] = EndedSearch(other.parts, *other.rank, (*other.searches, *which[k]))
                break
        else:
            kept.append(EndedSearch(parts[k], *found[k], which[k]))
    return kept
