"""The states in which a group without a closed form closes: where its path begins, and where it returns after a gap."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from compoundkin.base.arrays import Number, column
from compoundkin.base.poses import Pose
from compoundkin.kinematics.block import Block, size_in
from compoundkin.kinematics.curve.driver_path import DriverPath, as_column, first_of
from compoundkin.kinematics.curve.group_paths import Followed, GroupPath, followed_path
from compoundkin.kinematics.groups import GroupSolver, equations_of
from compoundkin.kinematics.groups.general import bodies_at, known_configurations
from compoundkin.kinematics.groups.group_equations import surroundings
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.model.mechanism import poses_from_drawing

# Random starts for a group that is not drawn completely; those after the first closed one only where a
# drawing can tell the better of two.
STARTS = 200
COMPARED = 50
# Up to so many bodies all configurations are found in some milliseconds.
MOST_BODIES_ENUMERATED = 6


def every_state(solver: GroupSolver, block: Block, most: int = MOST_BODIES_ENUMERATED) -> Number | None:
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
    """The states from which a closed one of a group is looked for.

    A sketch has the points that are shown; `drawn` says whether any are, so that the nearest to them is wanted.
    `complete` is whether all bodies of the group are.
    """

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
        return pose if drawn is None or pose.theta is not None else pose.counted(as_column(drawn).angle.c[0])

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
            wide = reach if number % 2 else np.maximum(reach, size_in(self.block.ends, self.equations.size))
            bodies = []
            for guess, pin, middle in zip(self.guesses, held, middles, strict=True):
                spot = centre + complex(*rng.standard_normal(2)) * wide / 2.0
                u = np.full((1, 1), np.exp(1j * rng.uniform(-np.pi, np.pi)))
                point, place = (middle, spot) if pin is None or number >= fixed else pin
                bodies.append(Pose.of(place - u * point, u) if guess is None or number >= fixed else as_column(guess))
            state = self.equations.state(bodies)
            yield state.reshape((1,) * (3 - state.ndim) + state.shape)


# So many pieces of a branch are looked for, and so many poses of it at most.
MOST_PIECES = 8
MOST_POSES = 20_000
# All configurations at a pose take half a millisecond: of more designs, with gaps of some eighty poses each, only the
# branch is followed.
MOST_DESIGNS = 250
# All configurations of groups of more bodies take too long to be asked for at every pose.
MOST_BODIES = 4


@dataclass(frozen=True)
class _SameSign:
    """The configurations in a branch's gaps with the sign of its Jacobian: how many there are, and one of them.

    Both are by design and place: `count` (designs, places), -1 where it is not known, and `states` (..., width).
    """

    places: Number
    count: Number
    states: Number


def with_returns(curve: Followed, k: int, home: GroupPath) -> GroupPath:
    """Return a path of group `k` with its returns after gaps, each by itself.

    A configuration that goes on beside the branch itself, or beside another one of its sign, is no return of it.
    """
    period = curve.path.period
    alike = _same_sign(curve, k, home, period) if len(home.reach) <= MOST_DESIGNS else None
    if alike is None:
        return home
    todo, found = alike.count == 1, list[GroupPath]()
    for _ in range(MOST_PIECES):
        if not todo.any():
            break
        every, i, rows = np.arange(len(todo)), np.argmax(todo, axis=1), todo.any(axis=1)
        piece = followed_path(
            curve, k, np.where(rows[:, None], alike.states[every, i], np.nan)[:, None], alike.places[i]
        )
        low, high = piece.reach[:, :1], piece.reach[:, 1:]
        inside = (alike.places >= low) & (alike.places <= high)
        todo = todo & ~inside
        todo[every, i] = False
        keeps = rows & ~(inside & (alike.count > 1)).any(axis=1)
        for other in (home, *found):
            keeps = keeps & ~_overlaps(piece.reach, other.reach, period)
        if keeps.any():
            found.append(replace(piece, reach=np.where(keeps[:, None], piece.reach, np.nan)))
    return replace(home, returns=tuple(found))


def _samples(path: DriverPath) -> Number:
    """Return the places at which a branch is looked for in its gaps: the samples, and those half way between."""
    return np.union1d(path.samples, (path.samples[1:] + path.samples[:-1]) / 2.0)


def _overlaps(piece: Number, home: Number, period: float) -> Number:
    """Tell for which designs a piece lies beside another one, also after a period."""
    shifts = (0.0,) if np.isinf(period) else (-period, 0.0, period)
    beside = [(piece[:, 0] < home[:, 1] + shift) & (piece[:, 1] > home[:, 0] + shift) for shift in shifts]
    return np.logical_or.reduce(beside)


def _same_sign(curve: Followed, k: int, home: GroupPath, period: float) -> _SameSign | None:
    """Return what has the sign of a branch in its gaps. None where it has none, or configurations are not known."""
    low, high = home.reach[:, :1], home.reach[:, 1:]
    places = _samples(curve.path)
    gone = ((places < low) | (places > high)) & (home.side != 0.0)[:, None]
    if np.isfinite(period):
        gone = (places > high) & (places < low + period)
    stride = 1 + int(np.count_nonzero(gone)) // MOST_POSES
    places, gone = places[::stride], gone[:, ::stride]
    designs, index = np.nonzero(gone)
    if not len(designs):
        return None
    found = same_sign_at(curve, k, home, designs, places[index])
    if found is None:
        return None
    count, state = found
    counts = np.full(gone.shape, -1)
    states = np.full((*gone.shape, state.shape[-1]), np.nan)
    counts[designs, index], states[designs, index] = count, state
    return _SameSign(places, counts, states)


def same_sign_at(
    curve: Followed, k: int, home: GroupPath, designs: Number, places: Number
) -> tuple[Number, Number] | None:
    """Return how many configurations have a branch's sign, and one of them. None where they are not known.

    `designs` and `places` are those of single poses. Where an earlier group is not assembled, the number is -1.
    """
    solver = curve.solving_order.solvers[k]
    if len(solver.group.bodies) > MOST_BODIES:
        return None
    equations = equations_of(solver)
    count, states = np.full(len(designs), -1), np.full((len(designs), equations.width), np.nan)
    known = np.flatnonzero(column(_before(curve, k, designs, places).failed == 0, len(designs)))
    if not len(known):
        return count, states
    block = _before(curve, k, designs[known], places[known])
    every = every_state(solver, block, MOST_BODIES)
    if every is None:
        return None
    side = equations.rates(every, block, 0)[1]
    same = np.broadcast_to(side, every.shape[:-1]) == home.side[designs[known], None]
    fits = np.isfinite(every).all(axis=-1) & same
    count[known] = fits.sum(axis=0)[:, 0]
    if len(every):
        first = np.argmax(fits[..., 0], axis=0)
        states[known] = every[first, np.arange(len(known)), 0]
    return count, states


def _before(curve: Followed, k: int, designs: Number, places: Number) -> Block:
    """Return what is solved before a group at single poses."""
    return curve.run(curve.path.pick(designs, places), 0, places[:, None], designs[:, None], k)


def why_no_return(curve: Followed, k: int, home: GroupPath, design: int, place: float) -> str:
    """Say why a group does not come back at a pose of a gap."""
    if len(home.reach) > MOST_DESIGNS:
        return f"whether it comes back is looked for in motions of up to {MOST_DESIGNS} designs only"
    found = same_sign_at(curve, k, home, np.array([design]), np.array([place]))
    if found is None:
        return "not all its configurations are known, so that none can be told to be its own after a gap"
    count = int(found[0][0])
    if count < 1:
        return "no configuration has the sign of its Jacobian there"
    if count == 1:
        return "the one configuration there with the sign of its Jacobian goes on beside it and is another branch"
    return f"{count} configurations there have the sign of its Jacobian, so that none can be told to be its own"
