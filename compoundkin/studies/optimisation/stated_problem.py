"""What is asked of better dimensions, held against the mechanism before any search begins."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from compoundkin.base.display import short_repr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics.solution import solve
from compoundkin.model.mechanism import Mechanism
from compoundkin.programs.dimensions import StatedDimensions, free_dimensions
from compoundkin.studies.goals.contract import DesignConstraint, Goal, GoalSum, GoalUnknown, Term
from compoundkin.studies.goals.least_goal import least
from compoundkin.studies.optimisation.design_problem import AskedConstraint, AskedGoal, DesignProblem
from compoundkin.studies.optimisation.search_space import SearchSpace
from compoundkin.studies.responses import Response, StudiedPath, studied_path
from compoundkin.studies.variations import hold_kinds, variation_of


def stated_problem(
    mechanism: Mechanism,
    free: Mapping[str, Any],
    goals: Goal | GoalSum,
    constraints: tuple[DesignConstraint, ...],
    **moved: Any,
) -> DesignProblem:
    """Return the problem, with the paths of all that is asked.

    `moved` is what `solve` is told of the motion: values, modes, rates. Raises what `solve` and `compile` raise, and
    InvalidInput for goals that do not fit the motion.
    """
    if not free:
        raise InvalidInput(Problem("free", "no dimension is free", 'give ranges: {"crank.B.x": (40, 60)}'))
    variations = {name: variation_of(f"free.{name}", one) for name, one in free.items()}
    terms: list[Term] = [*(goal for _, goal in goals.parts), *constraints]
    reference = solve(mechanism, **moved)
    asked = [term.outputs(reference) for term in terms]
    hold_kinds(variations, free_dimensions(StatedDimensions(mechanism, reference.inputs.ends), list(variations)))
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
        tuple(AskedGoal(goal, *path, own, weight) for goal, path, own, weight in of_goals),
        tuple(AskedConstraint(one, *path, own) for one, path, own in of_constraints),
    )


Asked = tuple[StudiedPath, Mapping[str, Response]]


def _paths(
    terms: Sequence[Term],
    asked: Sequence[tuple[str, ...]],
    studied: Callable[[Sequence[str]], tuple[StudiedPath, tuple[Response, ...]]],
) -> list[Asked]:
    """Return the path of each term: one for all along the motion, others for those with poses of their own."""
    along = {name for term, names in zip(terms, asked, strict=True) if not term.has_own_poses for name in names}
    some = next((names for names in asked if names), ())
    made: dict[tuple[str, ...], Asked] = {}
    found: list[Asked] = []
    for term, names in zip(terms, asked, strict=True):
        key = names if term.has_own_poses and names else tuple(sorted(along)) or some
        if key not in made:
            path, responses = studied(key)
            made[key] = path, {one.name: one for one in responses}
        path, responses_by_name = made[key]
        found.append((path, {name: responses_by_name[name] for name in names}))
    return found


def _ranges(start: int, unknowns: Sequence[tuple[GoalUnknown, ...]]) -> list[range]:
    """Return which numbers of the space are each term's own."""
    found = []
    for own in unknowns:
        found.append(range(start, start + len(own)))
        start += len(own)
    return found


def goals_of(objective: object) -> Goal | GoalSum:
    """Return what shall be least, a figure by its name too.

    Raises InvalidInput for anything else.
    """
    if isinstance(objective, str):
        return least(objective)
    if isinstance(objective, Goal | GoalSum):
        return objective
    remedy = 'give a goal, such as ck.goals.path("G", points), or the name of a figure, "G.velocity.length.greatest"'
    raise InvalidInput(Problem("objective", f"{short_repr(objective)} is nothing that could be least", remedy))


def constraints_of(subject_to: object) -> tuple[DesignConstraint, ...]:
    """Return the constraints; raises InvalidInput for what is none."""
    if isinstance(subject_to, DesignConstraint):
        return (subject_to,)
    found = tuple(subject_to) if isinstance(subject_to, Sequence) and not isinstance(subject_to, str) else (subject_to,)
    for place, one in enumerate(found):
        if not isinstance(one, DesignConstraint):
            remedy = "give constraints of ck.goals"
            raise InvalidInput(Problem(f"subject_to[{place}]", f"{short_repr(one)} is no constraint", remedy))
    return found
