"""The first closed pose of a group without a closed form: from a drawing or hint, among all its configurations.

Groups with higher pairs, and those of very many bodies, are searched from random starts instead.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, NotAssembled, Problem
from compoundkin.kinematics.approach import first_of
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.chosen_modes import Shown
from compoundkin.kinematics.closed_states import COMPARED, ClosedStates, every_state
from compoundkin.kinematics.default_modes import regularity
from compoundkin.kinematics.groups import GroupSolver
from compoundkin.kinematics.solving_order import SolvingOrder, residual

# Newton is given more steps here than when tracking: a random start is far away.
STEPS = 40
# and no step longer than this (of the size, or radians): from near a limit position it would lead anywhere.
LONGEST = 0.3

# What the orientation of a link of one drawn point counts (a radian by so many squared sizes): it decides where points
# are where they are drawn in either mode, and nothing else.
TURNED = 1e-6
# Squared distances that differ by less than this part of them, or of the squared size, are rounding.
TIED = 1e-9, 1e-24
# What is drawn within this part of the size of an outer contact is drawn there; an inner one must be nearer by as much.
NEARER = 1e-6

Letters = list[tuple[str, str]]


def letters_shown(solving_order: SolvingOrder, solver: GroupSolver, shown: Shown) -> Letters:
    """Return the letters that are shown on a group's links, with their links."""
    links = solving_order.structure.mechanism.links
    return [(link, letter) for link in solver.group.links for letter in links[link].points if letter in shown.points]


def distance(solving_order: SolvingOrder, letters: Letters, shown: Shown, block: Block) -> Number:
    """Return the summed squared distances of a group's points from where they are shown.

    Where only one point of a link is shown, but its orientation is told, that counts a little too.
    """
    points = solving_order.structure.mechanism.geometry.points
    total: Number = 0.0
    for link, letter in letters:
        gap = block.world[link].at(first_of(points[link][letter])).c[0] - first_of(shown.points[letter])
        total = total + np.abs(gap) ** 2
    links = [link for link, _ in letters if link in shown.poses]
    for link in links:
        if links.count(link) == 1:
            gap = block.world[link].u.c[0] - first_of(shown.poses[link].u.c[0])
            total = total + TURNED * (solving_order.size * np.abs(gap)) ** 2
    return total


def nearest_sign(
    solving_order: SolvingOrder, solver: GroupSolver, block: Block, shown: Shown, default: Callable[[], Number]
) -> tuple[Number, bool]:
    """Return the sign of a dyad nearest to what is shown.

    It is a number, or an array (designs, 1), and the default one where both are alike; whether they are not is told
    too. Where the dyad closes redundant pairs, these choose.
    """
    letters, closing, cost = letters_shown(solving_order, solver, shown), solving_order.closing(solver), []
    for sign in (1, -1):
        trial = block.copy()
        solver.close(trial, sign)
        cost.append(
            residual(closing, trial, solving_order.size) if closing else distance(solving_order, letters, shown, trial)
        )
    rounding = 0.0 if closing else TIED[1] * solving_order.size**2
    tied = np.abs(cost[1] - cost[0]) <= TIED[0] * np.maximum(*cost) + rounding
    best = np.where(cost[1] < cost[0], -1.0, 1.0)
    if np.any(tied) and not closing:
        best = np.where(tied, default(), best)
    if best.size == 1:
        return best.item(), bool(closing) or not tied.item()
    chosen = float(best.flat[0]) if np.all(best == best.flat[0]) else np.atleast_2d(best)
    return chosen, bool(closing) or not np.all(tied)


def first_state(
    solving_order: SolvingOrder, solver: GroupSolver, block: Block, shown: Shown, number: int | None
) -> tuple[Number, str]:
    """Find a closed state of a group at a single pose, and its chooser.

    It is (designs, 1, width), NaN for designs without.

    With `number` it is that of the real configurations in their order, counted from 1. Raises NotAssembled where no
    design has any.
    """
    if number is not None:
        return _numbered(solver, block, number), "number"
    best, least, by = _nearest_state(solving_order, solver, block, shown)
    if not np.isfinite(least).any():
        raise NotAssembled(_unfound(solver))
    return best, by


def shows_inner(solving_order: SolvingOrder, solver: GroupSolver, block: Block, shown: Shown) -> bool:
    """Tell whether a configuration without a sign is the nearest to what is shown.

    All groups before are assembled in the block; of several designs it is so for one.
    """
    followed, letters = solver.followed(), letters_shown(solving_order, solver, shown)
    if followed is None or not letters:
        return False
    outer: Number = np.inf
    for sign in (1, -1):
        trial = block.copy()
        solver.close(trial, sign)
        outer = np.fmin(outer, np.sqrt(distance(solving_order, letters, shown, trial)))
    nearer = NEARER * solving_order.size
    if np.all(outer < nearer):
        return False
    inner = np.sqrt(_nearest_state(solving_order, followed, block, shown)[1])
    return bool(np.any(inner < outer - nearer))


def _nearest_state(
    solving_order: SolvingOrder, solver: GroupSolver, block: Block, shown: Shown
) -> tuple[Number, Number, str]:
    """Return the closed states nearest to what is shown, what they cost (inf where there are none), and the chooser."""
    letters, designs, count = letters_shown(solving_order, solver, shown), block.shape[0], 0
    search = ClosedStates(solving_order, solver, block, shown.points, drawn=bool(letters))
    best, least = np.full((designs, 1, search.equations.width), np.nan), np.full((designs, 1), np.inf)
    for batch in search.batches():
        found = search.equations.newton(batch, block, STEPS, LONGEST)
        trial = block.copy()
        solver.close(trial, found.state)
        count += 1 if designs > 1 else len(batch)
        cost = distance(solving_order, letters, shown, trial) if letters else -regularity(solver, found.state, trial)
        state, cost = found.state, np.where(found.closed, cost, np.inf)
        if designs == 1:
            first = int(np.argmin(cost))
            state, cost = state[first : first + 1], cost[first : first + 1]
        best = np.where((cost < least)[..., None], state, best)
        least = np.minimum(cost, least)
        enough = (letters and search.complete and count == 1) or count >= COMPARED
        if enough and np.isfinite(least).all():
            break
    return best, least, "drawing" if letters else "default"


def _numbered(solver: GroupSolver, block: Block, number: int) -> Number:
    every = every_state(solver, block)
    links = ", ".join(solver.group.links)
    if every is None:
        what = "its configurations are not known one by one, so that none has a number"
        raise InvalidInput(Problem(f"group of {links}", what, "draw its points, or give a hint"))
    if number > len(every):
        remedy = "configurations() lists them"
        raise NotAssembled(Problem(f"group of {links}", f"it has {len(every)} configurations, not {number}", remedy))
    return every[number - 1]


def _unfound(solver: GroupSolver) -> Problem:
    return Problem(
        f"group of {', '.join(solver.group.links)}",
        "no assembled pose was found from the drawing or from random starts",
        "draw its points near an assembled pose, or give a hint",
    )
