"""The first closed pose of a group without a closed form: from a drawing or hint, among all its configurations.

Groups with higher pairs, and those of very many bodies, are searched from random starts instead.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from compoundkin.base.errors import InvalidInput, NotAssembled, Problem
from compoundkin.base.poses import Pose
from compoundkin.base.series import Number
from compoundkin.kinematics.approach import column, first_of
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.group_states import every_state, states_of
from compoundkin.kinematics.groups.steps import GeneralStep, Step
from compoundkin.kinematics.solving_order import Plan
from compoundkin.model.elements import FRAME
from compoundkin.model.geometry import fitted_pose

# Random starts for a group that is not drawn completely; those after the first closed one only where a
# drawing can tell the better of two.
STARTS = 200
COMPARED = 50
# Newton is given more steps here than when tracking: a random start is far away.
STEPS = 40
# and no step longer than this (of the size, or radians): from near a limit position it would lead anywhere.
LONGEST = 0.3

# Up to so many bodies all configurations are found in some milliseconds.
MOST_BODIES = 6

Letters = list[tuple[str, str]]


def shown(plan: Plan, step: Step, sketch: Mapping[str, Number]) -> Letters:
    """The letters a sketch shows on the links of a group, each with its link."""
    links = plan.structure.mechanism.links
    return [(link, letter) for link in step.group.links for letter in links[link].points if letter in sketch]


def distance(plan: Plan, letters: Letters, sketch: Mapping[str, Number], block: Block) -> Number:
    """The summed squared distances of a group's points from where they are drawn."""
    points = plan.structure.mechanism.geometry.points
    total: Number = 0.0
    for link, letter in letters:
        gap = block.world[link].at(first_of(points[link][letter])).c[0] - first_of(sketch[letter])
        total = total + np.abs(gap) ** 2
    return total


def first_state(
    plan: Plan, step: GeneralStep, block: Block, sketch: Mapping[str, Number], designs: int, number: int | None = None
) -> tuple[Number, str]:
    """A closed state (designs, 1, width) of a group at a single pose, and what chose it; NaN for designs without.

    With `number` it is that of the real configurations in their order, counted from 1. Raises NotAssembled where no
    design has any.
    """
    if number is not None:
        return _numbered(plan, step, block, designs, number), "number"
    letters = shown(plan, step, sketch)
    best = np.full((designs, 1, step.solver.width), np.nan)
    least = np.full((designs, 1), np.inf)
    guesses = _guesses(plan, step, block, sketch)
    complete = all(guesses[k] is not None for k in step.solver.kept)
    batches = _batches(plan, step, block, guesses, designs)
    count = 0
    for batch in batches:
        found = step.solver.newton(batch, block, STEPS, LONGEST)
        trial = block.copy()
        step.run(trial, found.state)
        order = count + np.arange(len(batch), dtype=float)[:, None]
        count += 1 if designs > 1 else len(batch)
        cost = np.where(found.closed, distance(plan, letters, sketch, trial) if letters else order, np.inf)
        state = found.state
        if designs == 1:
            first = int(np.argmin(cost))
            state, cost = state[first : first + 1], cost[first : first + 1]
        best = np.where((cost < least)[..., None], state, best)
        least = np.minimum(cost, least)
        enough = not letters or (complete and count == 1) or count >= COMPARED
        if enough and np.isfinite(least).all():
            break
    if not np.isfinite(least).any():
        raise NotAssembled(_unfound(step))
    return best, "drawing" if letters else "first found"


def _batches(plan: Plan, step: GeneralStep, block: Block, guesses: list[Pose | None], designs: int) -> Iterator[Number]:
    """What is drawn, where it is drawn completely; then all configurations, or random starts where they are not known.

    For a single design all at once, else one by one.
    """
    starts = _starts(plan, step, guesses)
    complete = all(guesses[k] is not None for k in step.solver.kept)
    if complete:
        yield next(starts)
    every = _every(plan, step, block, designs)
    if every is not None:
        yield from [every[:, 0]] if designs == 1 else every
        return
    if not complete:
        yield next(starts)
    if designs == 1:
        yield np.concatenate(list(starts))
    else:
        yield from starts


def _every(plan: Plan, step: GeneralStep, block: Block, designs: int) -> Number | None:
    """All real configurations (m, designs, 1, width), NaN where a design has fewer; None where they are not known."""
    found = every_state(step, block, plan.size, MOST_BODIES)
    if found is None or not found.states.shape[-2]:
        return None
    states = np.moveaxis(states_of(step, found.states), -2, 0)
    placed = states.reshape(len(states), *(1,) * (4 - states.ndim), *states.shape[1:])
    return np.broadcast_to(placed, (len(states), designs, 1, step.solver.width))


def _numbered(plan: Plan, step: GeneralStep, block: Block, designs: int, number: int) -> Number:
    every = _every(plan, step, block, designs)
    links = ", ".join(step.group.links)
    if every is None:
        what = "its configurations are not known one by one, so that none has a number"
        raise InvalidInput(Problem(f"group of {links}", what, "draw its points, or give a hint"))
    if number > len(every):
        remedy = "configurations() lists them"
        raise NotAssembled(Problem(f"group of {links}", f"it has {len(every)} configurations, not {number}", remedy))
    return every[number - 1]


def _guesses(plan: Plan, step: GeneralStep, block: Block, sketch: Mapping[str, Number]) -> list[Pose | None]:
    """The poses of the group's bodies as far as drawn points and points known already show them."""
    points = plan.structure.mechanism.geometry.points
    seen = {k: block.world[n].at(first_of(p)).c[0] for n in step.group.uses for k, p in points[n].items()}
    seen.update({k: first_of(p) for k, p in sketch.items()})
    drawn = plan.structure.mechanism.geometry.drawn
    found = []
    for base in (body.links[0] for body in step.group.bodies):
        pose = fitted_pose({k: first_of(p) for k, p in points[base].items()}, seen)
        # pairs that count turns take the drawn angle, which at half a turn may have either sign
        found.append(pose.counted(column(drawn[base]).angle.c[0]) if pose and base in drawn else pose)
    return found


def _starts(plan: Plan, step: GeneralStep, guesses: list[Pose | None]) -> Iterator[Number]:
    """Random states around the frame, the bodies that are shown where they are shown.

    Newton may not get from what is shown to any closed state, so that later states are wholly random.
    """
    held = 1 if all(guesses[k] is not None for k in step.solver.kept) else COMPARED
    rng = np.random.default_rng(step.solver.n)
    frame = list(plan.structure.mechanism.geometry.points[FRAME].values())
    centre = complex(np.mean([np.mean(p) for p in frame]))
    for number in range(STARTS):
        bodies = []
        for guess in guesses:
            spot = centre + complex(*rng.standard_normal(2)) * plan.size / 2.0
            angle = rng.uniform(-np.pi, np.pi)
            random = Pose.of(np.full((1, 1), spot), np.full((1, 1), np.exp(1j * angle)))
            bodies.append(random if guess is None or number >= held else column(guess))
        state = step.solver.state(bodies)
        yield state.reshape((1,) * (3 - state.ndim) + state.shape)


def _unfound(step: GeneralStep) -> Problem:
    return Problem(
        f"group of {', '.join(step.group.links)}",
        "no assembled pose was found from the drawing or from random starts",
        "draw its points near an assembled pose, or give a hint",
    )
