"""Better dimensions: the search from many starts at once, its refinement, and the answer."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from time import perf_counter
from typing import Any

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.errors import (
    InvalidInput,
    Problem,
    UnassembledPoses,
    UnmetConstraints,
    suppress_pose_warnings,
    warn,
)
from compoundkin.kinematics.configuration import Configuration
from compoundkin.model.mechanism import Mechanism
from compoundkin.studies.goals.contract import DesignConstraint, Goal, GoalSum
from compoundkin.studies.optimisation.answer import answer
from compoundkin.studies.optimisation.design_search import DesignSearch
from compoundkin.studies.optimisation.optimum import Optimum
from compoundkin.studies.optimisation.stated_problem import constraints_of, goals_of, stated_problem


@checked
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
    seed: int = 0,
    method: str | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Optimum:
    """Return the mechanism with better dimensions: those at which an objective is least.

    `free` has the ranges of dimensions by name, `objective` is a goal of `ck.goals`, a sum of goals by weights, or the
    name of a figure that shall be least; `subject_to` are constraints of `ck.goals`. `values`, rates, `time` and
    `modes` are those of `solve`: the motion along which goals ask. Lengths are in the mechanism's unit, angles radians.

    Many designs are looked at, searches begin at the best `starts` of them, and the best ends are refined by a method
    of SciPy: "least_squares", "SLSQP", "trust-constr" or "differential_evolution", by default the one that fits. The
    answer is the same for a `seed`. `progress(done, total)` is told of every step.

    Raises UnknownName for dimensions and figures that there are not, InvalidInput for what does not fit the mechanism,
    NotAssembled where no design within the ranges is assembled; warns UnmetConstraints where they hold nowhere,
    UnassembledPoses where the best design goes through all that is asked, and is lost in between.

    >>> from compoundkin.files import shipped_mechanisms
    >>> from compoundkin.studies.goals.least_goal import least
    >>> rocker = shipped_mechanisms.load_named("crank-rocker")
    >>> found = optimise(rocker, {"rocker.C.x": (3.5, 4.5)}, least("rocker.angle.stroke"), starts=4)
    >>> found.value < found.value_before
    True
    """
    began = perf_counter()
    moved = {"values": values, "speed": speed, "acceleration": acceleration, "jerk": jerk, "time": time, "modes": modes}
    _hold(starts, seed)
    goals, constraints = goals_of(objective), constraints_of(subject_to)
    with suppress_pose_warnings(), np.errstate(all="ignore"):
        problem = stated_problem(mechanism, free, goals, constraints, **moved)
        search = DesignSearch(problem, starts, seed, method, progress)
        found = answer(search, search.ends(), moved, began)
    _warn(found)
    return found


def _warn(found: Optimum) -> None:
    """Warn of an answer that is not what was asked, or cannot be made."""
    if not found.is_held:
        broken = [one.told for one in found.constraints if not one.is_held]
        warn(f"no design was found at which all constraints hold: not {', '.join(broken)}", UnmetConstraints)
    # goals with driver values of their own may need a part of the motion only
    if not found.is_whole and not all(one.has_own_poses for one in found.goals):
        remedy = "subject_to=compoundkin.goals.assembles() leads to one that can"
        warn(f"the design that was found cannot be assembled all along the motion; {remedy}", UnassembledPoses)
    if found.is_whole and not found.check.passed:
        # so near to a limit position the motion goes on in another branch, or not, by how its poses lie
        failed = ", ".join(found.check.failed)
        remedy = "subject_to=compoundkin.goals.assembles() keeps clear of limit positions"
        warn(f"the design that was found does not pass its verification ({failed}); {remedy}", UnassembledPoses)


def _hold(starts: int, seed: int) -> None:
    """Raise InvalidInput for numbers that no search can begin with."""
    if not 1 <= starts <= MOST_STARTS:
        raise InvalidInput(Problem("starts", f"{starts} is no number of starts", f"1 to {MOST_STARTS}"))
    if seed < 0:
        raise InvalidInput(Problem("seed", f"{seed} is no seed", "0 or more"))


# More starts than that would not all be assembled designs of those that are looked at.
MOST_STARTS = 1 << 12
