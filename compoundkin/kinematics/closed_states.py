"""Where closed states of a group are looked for: what is drawn, all its configurations, or random starts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.poses import Pose
from compoundkin.kinematics.approach import column, first_of
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.groups import GroupSolver, equations_of
from compoundkin.kinematics.groups.attached_places import surroundings
from compoundkin.kinematics.groups.general import bodies_at, known_configurations
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.model.mechanism import poses_from_drawing

# Random starts for a group that is not drawn completely; those after the first closed one only where a
# drawing can tell the better of two.
STARTS = 200
COMPARED = 50

# Up to so many bodies all configurations are found in some milliseconds.
MOST_BODIES = 6


def every_state(solver: GroupSolver, block: Block, most: int = MOST_BODIES) -> Number | None:
    """Return all real configurations of a group, or None where they are not known.

    They are (m, designs, 1, width), NaN where a design has fewer. Those of more than `most` bodies are not looked for.
    """
    equations = equations_of(solver)
    found = known_configurations(solver.group, block, equations.size, most)
    if found is None:
        return None
    states = np.moveaxis(equations.state(bodies_at(found.states)), -2, 0)
    placed = states.reshape(len(states), *(1,) * (4 - states.ndim), *states.shape[1:])
    return np.broadcast_to(placed, (len(states), *block.shape, equations.width))


class ClosedStates:
    """Where a closed state is looked for; `complete` where all bodies are drawn."""

    def __init__(
        self, order: SolvingOrder, solver: GroupSolver, block: Block, sketch: Mapping[str, Number], drawn: bool
    ) -> None:
        self.solving_order, self.solver, self.block, self.sketch, self.drawn = order, solver, block, sketch, drawn
        self.equations = equations_of(solver)
        self.guesses = self._guesses()
        self.complete = all(self.guesses[k] is not None for k in self.equations.kept)

    def batches(self) -> Iterator[Number]:
        """Yield what is drawn completely; then all configurations, or random starts.

        The latter are taken where no theory knows the configurations. For a single design all at once, else one by one.
        """
        single = self.block.shape[0] == 1
        starts = self._starts()
        if self.complete:
            yield next(starts)
        every = every_state(self.solver, self.block)
        if every is not None and len(every):
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
        told = poses_from_drawing(
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
