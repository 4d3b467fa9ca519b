"""Where searches begin: many designs of Sobol's sequence looked at in one call, and the most promising of them."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import NotAssembled, Problem
from compoundkin.studies.optimisation.design_problem import DesignProblem, SearchedDesigns
from compoundkin.studies.responses.failed_parts import failed_name
from compoundkin.studies.samples.sobol import SobolSample

# So many designs are looked at for each start, at least and at most so many in all.
FOR_EACH, AT_LEAST, AT_MOST = 16, 1 << 10, 1 << 16
# So many at once: their curves stay in the cache of a processor, or near it.
AT_ONCE = 1 << 10
# A start is worth a search where it is better than so many of its neighbours.
NEIGHBOURS = 8


@dataclass(frozen=True, eq=False, repr=False)
class StartingDesigns(ShortRepr):
    """The designs at which searches begin, the most promising first.

    They are parts of the ranges. `screened` designs were looked at, `assembled` of them were. `scales` are the sizes of
    margins among those. What `matters` are the numbers by which anything changes that is asked.
    """

    parts: Number
    values: Number
    screened: int
    assembled: int
    scales: Number
    matters: Number


def starting_designs(problem: DesignProblem, starts: int, seed: int, own: Number) -> StartingDesigns:
    """Return so many starts, and with them a design of one's own. Raises NotAssembled where there are none.

    Best of all are designs that are better than their neighbours. Source: A. Törn, S. Viitanen, Topographical global
    optimization, in: Recent Advances in Global Optimization, Princeton 1992.
    """
    total = min(max(AT_LEAST, 1 << (FOR_EACH * starts - 1).bit_length()), AT_MOST)
    sample, failures = SobolSample(AT_MOST, seed), Counter[str]()
    found: list[tuple[Number, Number, Number]] = []
    row = kept = looked = 0
    while row < total or (kept < starts and row < AT_MOST):
        units = sample.units(problem.space.size, range(row, row + AT_ONCE))
        designs = problem.at(problem.guessed(units if row else np.concatenate([own, units])))
        row += AT_ONCE
        looked += len(designs.parts)
        good = designs.assembled
        kept += int(good.sum())
        found.append((designs.parts[good], designs.values[good], designs.margins[good]))
        if not kept:
            failures.update(_failed(designs))
    if not kept:
        raise _none(looked, failures)
    parts, values, margins = (np.concatenate(one) for one in zip(*found, strict=True))
    scales = _scales(margins)
    order = _promising(parts, values, np.minimum(margins / scales, 0.0).sum(axis=1))[:starts]
    matters = _matters(problem, parts[order])
    return StartingDesigns(np.where(matters, parts[order], own), values[order], looked, kept, scales, matters)


def _matters(problem: DesignProblem, parts: Number) -> Number:
    """Tell by which numbers anything changes: those of which some slope is not nothing."""
    designs = problem.at(parts)
    return (designs.value_slopes != 0.0).any(axis=0) | (designs.margin_slopes != 0.0).any(axis=(0, 1))


def _scales(margins: Number) -> Number:
    """Return the size of each margin: what half of the designs are within."""
    middle = np.median(np.abs(margins), axis=0)
    return np.where(middle > 0.0, middle, 1.0)


def _promising(parts: Number, values: Number, held: Number) -> Number:
    """Return the order of designs: first those better than all neighbours, then the others."""
    rank = np.empty(len(parts))
    rank[np.lexsort((values, -held))] = np.arange(len(parts))
    is_best = np.zeros(len(parts), dtype=bool)
    squares = (parts**2).sum(axis=1)
    near = min(NEIGHBOURS + 1, len(parts))
    for rows in np.array_split(np.arange(len(parts)), -(-len(parts) // AT_ONCE)):
        distances = squares[rows, None] + squares - 2.0 * parts[rows] @ parts.T
        neighbours = np.argpartition(distances, near - 1, axis=1)[:, :near]
        is_best[rows] = (rank[neighbours] >= rank[rows, None]).all(axis=1)
    return np.lexsort((rank, ~is_best))


def _failed(designs: SearchedDesigns) -> Counter[str]:
    """Count designs by the group that first cannot be assembled, or the guide that is beyond an end."""
    counted: Counter[str] = Counter()
    path = designs.problem.path
    failed = designs.designs(path).found.failed
    if failed is not None:
        first = np.where(failed > 0, failed, np.iinfo(failed.dtype).max).min(axis=-1)
        for index, count in zip(*np.unique(first[(failed > 0).any(axis=-1)], return_counts=True), strict=True):
            counted[failed_name(path.reference, int(index))] += int(count)
    return counted


def _none(screened: int, failures: Counter[str]) -> NotAssembled:
    which = f"none of {screened} designs within the ranges"
    remedy = "give ranges around dimensions that can be assembled, or drive over a smaller range"
    if not failures:
        # at all poses each of them is: it is lost in between, or a number is beyond all bounds
        what = f"{which} is assembled between all poses too, with a finite number for all that is asked"
        return NotAssembled(Problem("free", what, remedy))
    told = ", ".join(f"{name} in {count}" for name, count in failures.most_common(3))
    return NotAssembled(Problem("free", f"{which} can be assembled at all poses: it fails at {told}", remedy))
