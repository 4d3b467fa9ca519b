"""The first closed pose of a group without a closed form: from a drawing or hint, among all its configurations.

Groups with higher pairs, and those of very many bodies, are searched from random starts instead.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence

import numpy as np

from compoundkin.base.errors import InvalidInput, NotAssembled, Problem
from compoundkin.base.poses import Pose
from compoundkin.base.series import Number
from compoundkin.kinematics.approach import column, first_of
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.chosen_modes import Shown
from compoundkin.kinematics.default_modes import regularity
from compoundkin.kinematics.groups import GroupSolver, equations_of
from compoundkin.kinematics.groups.general import bodies_at, known_configurations, surroundings
from compoundkin.kinematics.solving_order import SolvingOrder, residual
from compoundkin.model.drawn_poses import told_poses

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

# What the orientation of a link of one drawn point counts (a radian by so many squared sizes): it decides where points
# are where they are drawn in either mode, and nothing else.
TURNED = 1e-6
# Squared distances that differ by less than this part of them, or of the squared size, are rounding.
TIED = 1e-9, 1e-24

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
    for link, count in Counter(link for link, _ in letters).items():
        if count == 1 and link in shown.poses:
            gap = block.world[link].u.c[0] - column(shown.poses[link]).u.c[0]
            total = total + TURNED * (solving_order.size * np.abs(gap)) ** 2
    return total


def nearest_sign(
    solving_order: SolvingOrder, solver: GroupSolver, block: Block, shown: Shown, default: Callable[[], Number]
) -> tuple[Number, bool]:
    """Return the sign of a dyad that is nearest to what is shown, and if that tells.

    It is a number, or an array (designs, 1); the default one where both are alike. Where the dyad closes redundant
    pairs, these choose.
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
    letters, designs, count = letters_shown(solving_order, solver, shown), block.shape[0], 0
    search = _ClosedStates(solving_order, solver, block, shown.points, drawn=bool(letters))
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
        self, order: SolvingOrder, solver: GroupSolver, block: Block, sketch: Mapping[str, Number], drawn: bool
    ) -> None:
        self.solving_order, self.solver, self.block, self.sketch, self.drawn = order, solver, block, sketch, drawn
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
        """Return the poses of the group's bodies as far as the drawing and what is known already show them."""
        group, block = self.solver.group, self.block
        told = told_poses(
            {link: self._points(link) for link in (*group.uses, *group.links)},
            ((pair, block.ends[pair.name]) for pair in (*group.inner, *group.outer)),
            {k: first_of(p) for k, p in self.sketch.items()},
            {link: block.world[link].trimmed(0) for link in group.uses},
        )
        return [self._told(body.links, told) for body in group.bodies]

    def _told(self, links: tuple[str, ...], told: Mapping[str, Pose]) -> Pose | None:
        """Return the pose of a composite link's base, from the first of its links of which the pose is told."""
        link = next((link for link in links if link in told), None)
        if link is None:
            return None
        local = self.block.local.get(link)
        pose = told[link] if local is None else told[link].compose(local.trimmed(0).inverse())
        drawn = self.solving_order.structure.mechanism.drawn_poses.get(links[0])
        # pairs that count turns take the drawn angle, which at half a turn may have either sign
        return pose if drawn is None or pose.theta is not None else pose.counted(column(drawn).angle.c[0])

    def _points(self, link: str) -> dict[str, Number]:
        points = self.solving_order.structure.mechanism.geometry.points[link]
        return {letter: first_of(point) for letter, point in points.items()}

    def _held(self) -> list[tuple[Number, Number] | None]:
        """Return for each body a point that is drawn or known, in its own frame and where it is; or None."""
        uses = self.solver.group.uses
        seen = {k: self.block.world[n].at(p).c[0] for n in uses for k, p in self._points(n).items()}
        seen.update({k: first_of(p) for k, p in self.sketch.items()})
        bases = (self._points(body.links[0]) for body in self.solver.group.bodies)
        return [next(((p, seen[k]) for k, p in points.items() if k in seen), None) for points in bases]

    def _starts(self) -> Iterator[Number]:
        """Yield random states around where the group is attached, what is shown where it is shown.

        Newton may not get from what is shown to any closed state, so that later states are wholly random.
        """
        fixed = 1 if self.complete else COMPARED
        rng = np.random.default_rng(self.equations.n)
        centre, reach = surroundings(self.equations, self.block)
        held, middles = self._held(), self.equations.middles
        for number in range(STARTS):
            # far guides lead beyond the places where the group is attached
            wide = reach if number % 2 else np.maximum(reach, self.equations.size)
            bodies = []
            for guess, pin, middle in zip(self.guesses, held, middles, strict=True):
                spot = centre + complex(*rng.standard_normal(2)) * wide / 2.0
                u = np.full((1, 1), np.exp(1j * rng.uniform(-np.pi, np.pi)))
                point, place = (middle, spot) if pin is None or number >= fixed else pin
                bodies.append(Pose.of(place - u * point, u) if guess is None or number >= fixed else column(guess))
            state = self.equations.state(bodies)
            yield state.reshape((1,) * (3 - state.ndim) + state.shape)


def _unfound(solver: GroupSolver) -> Problem:
    return Problem(
        f"group of {', '.join(solver.group.links)}",
        "no assembled pose was found from the drawing or from random starts",
        "draw its points near an assembled pose, or give a hint",
    )
