"""The answer of a search put together: what changed, what binds, and all designs at which searches ended."""

from __future__ import annotations

from collections.abc import Mapping
from time import perf_counter
from typing import Any

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.kinematics.quantities import quantity
from compoundkin.studies.goals.contract import Term
from compoundkin.studies.optimisation.design_problem import DesignProblem, SearchedDesigns
from compoundkin.studies.optimisation.design_search import DesignSearch
from compoundkin.studies.optimisation.local_minima import EndedSearch
from compoundkin.studies.optimisation.optimum import ChangedDimension, HeldConstraint, LocalMinimum, Optimum
from compoundkin.studies.optimisation.single_design import HELD
from compoundkin.studies.responses.assembled_range import assembled_range

# What ends so near to a bound, or to the end of a margin, as a part of its range or size, is bound by it.
AT_END = 1e-4


def answer(search: DesignSearch, ends: list[EndedSearch], moved: Mapping[str, Any], began: float) -> Optimum:
    """Return what a search has found. `moved` is what `solve` is told of the motion."""
    problem, begun = search.problem, search.begun
    best = problem.at(ends[0].parts)
    minima = tuple(_minimum(problem, one, moved) for one in ends if one.is_refined or one is ends[0])
    own = problem.space.own
    found = problem.space.numbers(ends[0].parts)
    return Optimum(
        value=float(best.values[0]),
        value_before=_before(problem),
        changes=_changes(problem, ends[0].parts, begun.matters),
        constraints=_held(problem, best, begun.scales),
        unknowns=dict(zip(problem.space.names[own:], found[own:].tolist(), strict=True)),
        goals=tuple(one.term for one in problem.goals),
        minima=minima,
        begun=begun.values,
        ended=_ended(len(begun.values), ends),
        screened=begun.screened,
        assembled=begun.assembled,
        evaluations=problem.count[0],
        seconds=perf_counter() - began,
        method=search.word,
        before=problem.path.reference,
        is_whole=bool(assembled_range(best.designs(problem.path)).assembled[0]),
    )


def _minimum(problem: DesignProblem, one: EndedSearch, moved: Mapping[str, Any]) -> LocalMinimum:
    dimensions = {name: value.item() for name, value in problem.space.of_dimensions(one.parts[None, :]).items()}
    is_held = one.violation == 0.0
    return LocalMinimum(one.value, dimensions, one.searches, is_held, problem.path.compiled, moved)


def _ended(starts: int, ends: list[EndedSearch]) -> Number:
    """Return the objective at which each search ended, NaN where constraints hold less than at the best."""
    found = np.full(starts, np.nan)
    for one in ends:
        if one.violation <= ends[0].violation:
            found[[k for k in one.searches if k < starts]] = one.value
    return found


def _before(problem: DesignProblem) -> float:
    """Return the objective of the mechanism as it stands, perhaps outside the bounds."""
    space = problem.space
    parts = space.parts(problem.own_dimensions, inside=False)[None, :]
    return float(problem.at(problem.guessed(parts)).values[0])


def _changes(problem: DesignProblem, parts: Number, matters: Number) -> tuple[ChangedDimension, ...]:
    space, stated = problem.space, problem.path.compiled.programs.stated
    before, after = (space.numbers(one)[: space.own] for one in (space.parts(problem.own_dimensions, False), parts))
    units = {one.name: stated.unit(one) for one in problem.path.compiled.programs.dimensions}
    owners = [name for name, places in space.dimensions.items() for _ in places]
    found = []
    for k, name in enumerate(space.names[: space.own]):
        bound = "low" if parts[k] < AT_END else "high" if parts[k] > 1.0 - AT_END else ""
        low, high = float(space.low[k]), float(space.high[k])
        told = bound if matters[k] else ""
        of = ChangedDimension(
            name, units[owners[k]], float(before[k]), float(after[k]), low, high, told, bool(matters[k])
        )
        found.append(of)
    return tuple(found)


def _held(problem: DesignProblem, best: SearchedDesigns, scales: Number) -> tuple[HeldConstraint, ...]:
    found, place = [], 0
    for one in problem.constraints:
        margins = one.term.margins(best.trial(one))[0]
        parts = margins / scales[place : place + len(margins)]
        place += len(margins)
        is_held, binds = bool(parts.min() >= -HELD), bool(abs(parts.min()) < AT_END)
        found.append(HeldConstraint(one.term.told, float(margins.min()), _unit(problem, one.term), is_held, binds))
    return tuple(found)


def _unit(problem: DesignProblem, term: Term) -> str:
    """Return the unit of a term: its own, or that of what it asks."""
    reference = problem.path.reference
    units = {quantity(reference, name).unit for name in term.outputs(reference)}
    return term.unit or (units.pop() if len(units) == 1 else "")
