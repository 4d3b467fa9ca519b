"""Optimisation of dimensions: the checked problem, the search from many starts, and its result."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from time import perf_counter
from typing import Any, Protocol

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.display import short_repr
from compoundkin.base.errors import (
    InvalidInput,
    Problem,
    UnassembledPoses,
    UnmetConstraints,
    suppress_pose_warnings,
    warn,
)
from compoundkin.base.linear import one_thread
from compoundkin.kinematics.configuration import Configuration
from compoundkin.kinematics.quantities import quantity
from compoundkin.kinematics.solution import solve
from compoundkin.model.mechanism import Mechanism
from compoundkin.programs.dimensions import StatedDimensions, free_dimensions
from compoundkin.studies.goals.goal import DesignConstraint, Goal, GoalSum, GoalUnknown, Term
from compoundkin.studies.goals.value_goals import least
from compoundkin.studies.optimisation.design_problem import (
    ConstraintSpec,
    DesignProblem,
    GoalSpec,
    SearchedDesigns,
    SearchSpace,
)
from compoundkin.studies.optimisation.design_search import DesignSearch, EndedSearch
from compoundkin.studies.optimisation.optimum import ChangedDimension, HeldConstraint, LocalMinimum, Optimum
from compoundkin.studies.optimisation.refinement import HOLDS_WITHIN
from compoundkin.studies.responses import Response, StudiedPath, studied_path
from compoundkin.studies.responses.assembled_range import assembled_range
from compoundkin.studies.samples.variations import check_kinds, variation_of


class DesignAtlas(Protocol):
    """Designs of many mechanisms that turn fully: whoever has some of a mechanism gives where searches may begin."""

    def designs_for(
        self, mechanism: Mechanism, ranges: Mapping[str, tuple[complex, complex]], seed: int
    ) -> Mapping[str, Number]:
        """Return values of dimensions by name, (designs,), complex of points, that make a mechanism one of its designs.

        `ranges` are from where to where they may be; what designs do not determine is drawn from there by the `seed`.
        Raises InvalidInput where it has no design of the mechanism.
        """


@checked
@one_thread
def optimise(
    mechanism: Mechanism,
    free: Mapping[str, Any],
    objective: Goal | GoalSum | str,
    subject_to: DesignConstraint | Sequence[DesignConstraint] = (),
    *,
    values: Any = None,
    speed: Any = None,
    acceleration: Any = None,
    jerk: Any = None,
    time: Any = None,
    modes: Mapping[str, int] | str | Configuration | None = None,
    starts: int = 64,
    atlas: DesignAtlas | None = None,
    seed: int = 0,
    method: str | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Optimum:
    """Return the mechanism with the dimensions that minimise an objective.

    `free` has the ranges of dimensions by name, `objective` is a goal of `ck.goals`, a sum of goals by weights, or the
    name of a figure to minimise; `subject_to` are constraints of `ck.goals`. `values`, rates, `time` and
    `modes` are those of `solve` and define the motion. Lengths are in the mechanism's unit, angles radians.

    Many designs are sampled, searches begin at the best `starts` of them, and the best ends are refined by a method
    of SciPy: "least_squares", "SLSQP", "trust-constr" or "differential_evolution", by default the one that fits. The
    result is reproducible for a `seed`. `progress(done, total)` is called after every step. Where there is an `atlas`
    (`coupler_atlas`) its designs of the mechanism's chain, at its scale and within the ranges, are sampled.

    Raises UnknownName for unknown dimensions and figures, InvalidInput for arguments that do not fit the mechanism,
    NotAssembled where no design within the ranges is assembled; warns UnmetConstraints where they hold nowhere,
    UnassembledPoses where the best design is not assembled between the poses of its goals.

    >>> from compoundkin.files import load
    >>> from compoundkin.studies.goals.value_goals import least
    >>> rocker = load("crank-rocker")
    >>> found = optimise(rocker, {"rocker.C.x": (3.5, 4.5)}, least("rocker.angle.stroke"), starts=4)
    >>> found.value < found.value_before
    True
    """
    began = perf_counter()
    moved = {"values": values, "speed": speed, "acceleration": acceleration, "jerk": jerk, "time": time, "modes": modes}
    _check_search_numbers(starts, seed)
    goals, constraints = checked_goals(objective), checked_constraints(subject_to)
    with suppress_pose_warnings(), np.errstate(all="ignore"):
        problem = stated_problem(mechanism, free, goals, constraints, **moved)
        given = None if atlas is None else _given(atlas, mechanism, problem, seed)
        search = DesignSearch(problem, starts, seed, method, progress, given=given)
        found = optimum_of_search(search, search.ends(), moved, began)
    _warn(found)
    return found


def _warn(found: Optimum) -> None:
    """Warn of violated constraints, and of a design that cannot be assembled or verified."""
    if not found.is_held:
        broken = [one.description for one in found.constraints if not one.is_held]
        warn(f"no design was found at which all constraints hold: not {', '.join(broken)}", UnmetConstraints)
    # goals with driver values of their own may need a part of the motion only
    if not found.is_whole and not all(one.has_own_poses for one in found.goals):
        remedy = "subject_to=compoundkin.goals.assembles() leads to one that can"
        warn(f"the design that was found cannot be assembled all along the motion; {remedy}", UnassembledPoses)
    if found.is_whole and not found.check.passed:
        # near a limit position the branch of the motion depends on its poses
        failed = ", ".join(found.check.failed)
        remedy = "subject_to=compoundkin.goals.assembles() keeps clear of limit positions"
        warn(f"the design that was found does not pass its verification ({failed}); {remedy}", UnassembledPoses)


def _given(atlas: DesignAtlas, mechanism: Mechanism, problem: DesignProblem, seed: int) -> Number:
    """Return the designs of an atlas within the ranges, by their parts. Raises InvalidInput where there are none."""
    space = problem.space
    ends = np.stack([space.low, space.high])
    ranges = {name: (complex(*ends[0, at]), complex(*ends[1, at])) for name, at in space.dimensions.items()}
    values = atlas.designs_for(mechanism, ranges, seed)
    both = ((values[name].real, values[name].imag)[: len(at)] for name, at in space.dimensions.items())
    numbers = [part for one in both for part in one]
    parts = np.full((len(numbers[0]), space.size), 0.5)
    parts[:, : space.own] = (np.array(numbers).T - space.low[: space.own]) / space.span[: space.own]
    outside = (parts < 0.0) | (parts > 1.0)
    inside = ~outside.any(axis=1)
    if not inside.any():
        name = space.names[int(outside.sum(axis=0).argmax())]
        what = f"no design of the atlas lies within the ranges, most are beyond that of {name}"
        raise InvalidInput(Problem("atlas", what, "widen it, or leave the atlas out"))
    return parts[inside]


def _check_search_numbers(starts: int, seed: int) -> None:
    """Raise InvalidInput for an invalid number of starts or seed."""
    if not 1 <= starts <= MOST_STARTS:
        raise InvalidInput(Problem("starts", f"{starts} is no number of starts", f"1 to {MOST_STARTS}"))
    if seed < 0:
        raise InvalidInput(Problem("seed", f"{seed} is no seed", "0 or more"))


# With more starts not all of them would be assembled designs of the sample.
MOST_STARTS = 1 << 12


def stated_problem(
    mechanism: Mechanism,
    free: Mapping[str, Any],
    goals: Goal | GoalSum,
    constraints: tuple[DesignConstraint, ...],
    **moved: Any,
) -> DesignProblem:
    """Return the problem, with the compiled paths of all goals and constraints.

    `moved` are the arguments of `solve`: values, modes, rates. Raises what `solve` and `compile` raise, and
    InvalidInput for goals that do not fit the motion.
    """
    if not free:
        raise InvalidInput(Problem("free", "no dimension is free", 'give ranges: {"crank.B.x": (40, 60)}'))
    variations = {name: variation_of(f"free.{name}", one) for name, one in free.items()}
    terms: list[Term] = [*(goal for _, goal in goals.parts), *constraints]
    reference = solve(mechanism, **moved)
    asked = [term.outputs(reference) for term in terms]
    check_kinds(variations, free_dimensions(StatedDimensions(mechanism, reference.inputs.ends), list(variations)))
    paths = _paths(terms, asked, lambda names: studied_path(mechanism, list(variations), names, **moved))
    unknowns = [term.unknowns(reference) for term in terms]
    space = SearchSpace.of(variations, tuple(one for own in unknowns for one in own))
    ranges = _ranges(space.own, unknowns)
    weights = [weight for weight, _ in goals.parts]
    of_goals = zip((goal for _, goal in goals.parts), paths, ranges, weights, strict=False)
    count = len(weights)
    of_constraints = zip(constraints, paths[count:], ranges[count:], strict=True)
    return DesignProblem(
        space,
        tuple(GoalSpec(goal, *path, own, weight) for goal, path, own, weight in of_goals),
        tuple(ConstraintSpec(one, *path, own) for one, path, own in of_constraints),
    )


RequestedResponses = tuple[StudiedPath, Mapping[str, Response]]


def _paths(
    terms: Sequence[Term],
    asked: Sequence[tuple[str, ...]],
    studied: Callable[[Sequence[str]], tuple[StudiedPath, tuple[Response, ...]]],
) -> list[RequestedResponses]:
    """Return the path of each term: one for all along the motion, others for those with poses of their own."""
    along = {name for term, names in zip(terms, asked, strict=True) if not term.has_own_poses for name in names}
    some = next((names for names in asked if names), ())
    made: dict[tuple[str, ...], RequestedResponses] = {}
    found: list[RequestedResponses] = []
    for term, names in zip(terms, asked, strict=True):
        key = names if term.has_own_poses and names else tuple(sorted(along)) or some
        if key not in made:
            path, responses = studied(key)
            made[key] = path, {one.name: one for one in responses}
        path, responses_by_name = made[key]
        found.append((path, {name: responses_by_name[name] for name in names}))
    return found


def _ranges(start: int, unknowns: Sequence[tuple[GoalUnknown, ...]]) -> list[range]:
    """Return the indices in the space of each term's unknowns."""
    found = []
    for own in unknowns:
        found.append(range(start, start + len(own)))
        start += len(own)
    return found


def checked_goals(objective: object) -> Goal | GoalSum:
    """Return the goals, also for the name of a figure. Raises InvalidInput for other objects."""
    if isinstance(objective, str):
        return least(objective)
    if isinstance(objective, Goal | GoalSum):
        return objective
    remedy = 'give a goal, such as ck.goals.path("G", points), or the name of a figure, "G.velocity.length.greatest"'
    raise InvalidInput(Problem("objective", f"{short_repr(objective)} is not an objective", remedy))


def checked_constraints(subject_to: object) -> tuple[DesignConstraint, ...]:
    """Return the constraints; raises InvalidInput for other objects."""
    if isinstance(subject_to, DesignConstraint):
        return (subject_to,)
    found = tuple(subject_to) if isinstance(subject_to, Sequence) and not isinstance(subject_to, str) else (subject_to,)
    for place, one in enumerate(found):
        if not isinstance(one, DesignConstraint):
            remedy = "give constraints of ck.goals"
            raise InvalidInput(Problem(f"subject_to[{place}]", f"{short_repr(one)} is not a constraint", remedy))
    return found


# A bound or constraint is active within this part of the range or of the margin's size.
AT_END = 1e-4


def optimum_of_search(search: DesignSearch, ends: list[EndedSearch], moved: Mapping[str, Any], began: float) -> Optimum:
    """Return the result of a search. `moved` are the arguments of `solve`."""
    problem, begun = search.problem, search.begun
    best = problem.at(ends[0].parts)
    minima = tuple(_minimum(problem, one, moved) for one in ends if one.is_refined or one is ends[0])
    own = problem.space.own
    found = problem.space.numbers(ends[0].parts)
    return Optimum(
        value=float(best.values[0]),
        value_before=_value_before(problem),
        changes=_changes(problem, ends[0].parts, begun.matters),
        constraints=_held_constraints(problem, best, begun.scales),
        unknowns=dict(zip(problem.space.names[own:], found[own:].tolist(), strict=True)),
        goals=tuple(one.term for one in problem.goals),
        minima=minima,
        begun=begun.values,
        ended=_search_ends(len(begun.values), ends),
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


def _search_ends(starts: int, ends: list[EndedSearch]) -> Number:
    """Return the objective at which each search ended, NaN where constraints hold less than at the best."""
    found = np.full(starts, np.nan)
    for one in ends:
        if one.violation <= ends[0].violation:
            found[[k for k in one.searches if k < starts]] = one.value
    return found


def _value_before(problem: DesignProblem) -> float:
    """Return the objective of the original mechanism, perhaps outside the bounds."""
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


def _held_constraints(problem: DesignProblem, best: SearchedDesigns, scales: Number) -> tuple[HeldConstraint, ...]:
    found, place = [], 0
    for one in problem.constraints:
        margins = one.term.margins(best.trial(one))[0]
        parts = margins / scales[place : place + len(margins)]
        place += len(margins)
        is_held, binds = bool(parts.min() >= -HOLDS_WITHIN), bool(abs(parts.min()) < AT_END)
        found.append(
            HeldConstraint(one.term.description, float(margins.min()), _unit(problem, one.term), is_held, binds)
        )
    return tuple(found)


def _unit(problem: DesignProblem, term: Term) -> str:
    """Return the unit of a term: its own, or that of its outputs."""
    reference = problem.path.reference
    units = {quantity(reference, name).unit for name in term.outputs(reference)}
    return term.unit or (units.pop() if len(units) == 1 else "")
