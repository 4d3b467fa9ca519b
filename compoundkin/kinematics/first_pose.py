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
from compoundkin.kinematics.default_modes import regularity
from compoundkin.kinematics.groups import GroupSolver, equations_of
from compoundkin.kinematics.groups.general import bodies_at, known_configurations
from compoundkin.kinematics.solving_order import SolvingOrder, residual
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


def shown(solving_order: SolvingOrder, solver: GroupSolver, sketch: Mapping[str, Number]) -> Letters:
    """Return the letters a sketch shows on a group's links, with their links."""
    links = solving_order.structure.mechanism.links
    return [(link, letter) for link in solver.group.links for letter in links[link].points if letter in sketch]


def distance(solving_order: SolvingOrder, letters: Letters, sketch: Mapping[str, Number], block: Block) -> Number:
    """Return the summed squared distances of a group's points from where they are drawn."""
    points = solving_order.structure.mechanism.geometry.points
    total: Number = 0.0
    for link, letter in letters:
        gap = block.world[link].at(first_of(points[link][letter])).c[0] - first_of(sketch[letter])
        total = total + np.abs(gap) ** 2
    return total


def nearest_sign(
    solving_order: SolvingOrder, solver: GroupSolver, block: Block, sketch: Mapping[str, Number]
) -> Number:
    """Return the sign of a dyad that is nearest to a sketch. It is a number, or an array (designs, 1).

    Where it closes redundant pairs, these choose.
    """
    letters, closing, cost = shown(solving_order, solver, sketch), solving_order.closing(solver), []
    for sign in (1, -1):
        trial = block.copy()
        solver.close(trial, sign)
        cost.append(
            residual(closing, trial, solving_order.size) if closing else distance(solving_order, letters, sketch, trial)
        )
    best = np.where(cost[1] < cost[0], -1.0, 1.0)
    return float(best.flat[0]) if np.all(best == best.flat[0]) else np.atleast_2d(best)


def first_state(
    solving_order: SolvingOrder, solver: GroupSolver, block: Block, sketch: Mapping[str, Number], number: int | None
) -> tuple[Number, str]:
    """Find a closed state of a group at a single pose, and its chooser.

    It is (designs, 1, width), NaN for designs without.

    With `number` it is that of the real configurations in their order, counted from 1. Raises NotAssembled where no
    design has any.
    """
    if number is not None:
        return _numbered(solver, block, number), "number"
    search = _ClosedStates(solving_order, solver, block, sketch)
    letters, designs, count = shown(solving_order, solver, sketch), block.shape[0], 0
    best, least = np.full((designs, 1, search.equations.width), np.nan), np.full((designs, 1), np.inf)
    for batch in search.batches():
        found = search.equations.newton(batch, block, STEPS, LONGEST)
        trial = block.copy()
        solver.close(trial, found.state)
        count += 1 if designs > 1 else len(batch)
        cost = distance(solving_order, letters, sketch, trial) if letters else -regularity(solver, found.state, trial)
        state, cost = found.state, np.where(found.closed, cost, np.inf)
        if designs == 1:
            first = int(np.argmin(cost))
            state, cost = state[first : first + 1], cost[first : first + 1]
        best = np.where((cost < least)[..., None], state, best)
        least = np.minimum(cost, least)
        enough = (letters and search.complete and count == 1) or count >= COMPARED
        if enough and np.isfinite(least).all():
            break
    if not np.isfinite(least).any():
        raise NotAssembled(_unfound(solver))
    return best, "drawing" if letters else "default"


def _every(solver: GroupSolver, block: Block) -> Number | None:
    """Return all real configurations (m, designs, 1, width), NaN where a design has fewer; None where not known."""
    equations = equations_of(solver)
    found = known_configurations(solver.group, block, equations.size, MOST_BODIES)
    if found is None or not found.states.shape[-2]:
        return None
    states = np.moveaxis(equations.state(bodies_at(found.states)), -2, 0)
    placed = states.reshape(len(states), *(1,) * (4 - states.ndim), *states.shape[1:])
    return np.broadcast_to(placed, (len(states), *block.shape, equations.width))


def _numbered(solver: GroupSolver, block: Block, number: int) -> Number:
    every = _every(solver, block)
    links = ", ".join(solver.group.links)
    if every is None:
        what = "its configurations are not known one by one, so that none has a number"
        raise InvalidInput(Problem(f"group of {links}", what, "draw its points, or give a hint"))
    if number > len(every):
        remedy = "configurations() lists them"
        raise NotAssembled(Problem(f"group of {links}", f"it has {len(every)} configurations, not {number}", remedy))
    return every[number - 1]


class _ClosedStates:
    """Where a closed state is looked for; `complete` where all bodies are drawn."""

    def __init__(
        self, solving_order: SolvingOrder, solver: GroupSolver, block: Block, sketch: Mapping[str, Number]
    ) -> None:
        self.solving_order, self.solver, self.block, self.sketch = solving_order, solver, block, sketch
        self.drawn = bool(shown(solving_order, solver, sketch))
        self.equations = equations_of(solver)
        self.guesses = self._guesses()
        self.complete = all(self.guesses[k] is not None for k in self.equations.kept)

    def batches(self) -> Iterator[Number]:
        """Yield what is drawn completely; then all configurations, or random starts where they are not known.

        For a single design all at once, else one by one.
        """
        single = self.block.shape[0] == 1
        starts = self._starts()
        if self.complete:
            yield next(starts)
        every = _every(self.solver, self.block)
        if every is not None:
            yield from [every[:, 0]] if single else every
            return
        if not self.complete:
            yield next(starts)
        if single:
            rest = list(starts)
            # where nothing is drawn none is nearest, and more are tried only where these do not close
            first = 0 if self.drawn else COMPARED
            yield from (np.concatenate(part) for part in (rest[:first], rest[first:]) if part)
        else:
            yield from starts

    def _guesses(self) -> list[Pose | None]:
        """Return the poses of the group's bodies as far as drawn points and points known already show them."""
        points = self.solving_order.structure.mechanism.geometry.points
        seen = {
            k: self.block.world[n].at(first_of(p)).c[0] for n in self.solver.group.uses for k, p in points[n].items()
        }
        seen.update({k: first_of(p) for k, p in self.sketch.items()})
        drawn = self.solving_order.structure.mechanism.geometry.drawn
        found = []
        for base in (body.links[0] for body in self.solver.group.bodies):
            pose = fitted_pose({k: first_of(p) for k, p in points[base].items()}, seen)
            # pairs that count turns take the drawn angle, which at half a turn may have either sign
            found.append(pose.counted(column(drawn[base]).angle.c[0]) if pose and base in drawn else pose)
        return found

    def _starts(self) -> Iterator[Number]:
        """Yield random states around the frame, the bodies that are shown where they are shown.

        Newton may not get from what is shown to any closed state, so that later states are wholly random.
        """
        held = 1 if self.complete else COMPARED
        rng = np.random.default_rng(self.equations.n)
        frame = list(self.solving_order.structure.mechanism.geometry.points[FRAME].values())
        centre = complex(np.mean([np.mean(p) for p in frame]))
        for number in range(STARTS):
            bodies = []
            for guess in self.guesses:
                spot = centre + complex(*rng.standard_normal(2)) * self.solving_order.size / 2.0
                angle = rng.uniform(-np.pi, np.pi)
                random = Pose.of(np.full((1, 1), spot), np.full((1, 1), np.exp(1j * angle)))
                bodies.append(random if guess is None or number >= held else column(guess))
            state = self.equations.state(bodies)
            yield state.reshape((1,) * (3 - state.ndim) + state.shape)


def _unfound(solver: GroupSolver) -> Problem:
    return Problem(
        f"group of {', '.join(solver.group.links)}",
        "no assembled pose was found from the drawing or from random starts",
        "draw its points near an assembled pose, or give a hint",
    )
