"""Returns of a group without a closed form after a gap, to the configuration of the same sign if there is just one."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from compoundkin.base.arrays import Number, column
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.closed_states import every_state
from compoundkin.kinematics.group_paths import Followed, GroupPath, both_ways
from compoundkin.kinematics.groups import equations_of

# So many pieces of a branch are looked for, and so many poses of it at most.
MOST_PIECES = 8
MOST_POSES = 20_000
# All configurations at a pose take half a millisecond: of more designs, with gaps of some eighty poses each, only the
# branch is followed.
MOST_DESIGNS = 250
# All configurations of groups of more bodies take too long to be asked for at every pose.
MOST_BODIES = 4


@dataclass(frozen=True)
class _Kin:
    """The configurations with the sign of the Jacobian that a group has. How many there are, and one of them.

    Both are by design and place: `count` (designs, places), -1 where it is not known, and `states` (..., width).
    """

    places: Number
    count: Number
    states: Number


def with_returns(way: Followed, k: int, home: GroupPath, period: float = np.inf) -> GroupPath:
    """Return a path of group `k` with its returns after gaps, each by itself.

    A configuration that goes on beside the branch itself, or beside another one of its sign, is no return of it. After
    `period` places the way is the same again.
    """
    kin = _kin(way, k, home, period) if len(home.reach) <= MOST_DESIGNS else None
    if kin is None:
        return home
    todo, found = kin.count == 1, list[GroupPath]()
    for _ in range(MOST_PIECES):
        if not todo.any():
            break
        every, i, rows = np.arange(len(todo)), np.argmax(todo, axis=1), todo.any(axis=1)
        piece = both_ways(way, k, np.where(rows[:, None], kin.states[every, i], np.nan)[:, None], kin.places[i])
        low, high = piece.reach[:, :1], piece.reach[:, 1:]
        inside = (kin.places >= low) & (kin.places <= high)
        todo = todo & ~inside
        todo[every, i] = False
        keeps = rows & ~(inside & (kin.count > 1)).any(axis=1)
        for other in (home, *found):
            keeps = keeps & ~_overlaps(piece.reach, other.reach, period)
        if keeps.any():
            found.append(replace(piece, reach=np.where(keeps[:, None], piece.reach, np.nan)))
    return replace(home, returns=tuple(found))


def _overlaps(piece: Number, home: Number, period: float) -> Number:
    """Tell for which designs a piece lies beside another one, also after a period."""
    shifts = (0.0,) if np.isinf(period) else (-period, 0.0, period)
    beside = [(piece[:, 0] < home[:, 1] + shift) & (piece[:, 1] > home[:, 0] + shift) for shift in shifts]
    return np.logical_or.reduce(beside)


def _kin(way: Followed, k: int, home: GroupPath, period: float) -> _Kin | None:
    """Return the kin of a branch where it has a gap. None where it has none, or configurations are not known."""
    low, high = home.reach[:, :1], home.reach[:, 1:]
    places = np.arange(way.given.poses, dtype=float)
    gone = ((places < low) | (places > high)) & (home.side != 0.0)[:, None]
    if np.isfinite(period):
        gone = (places > high) & (places < low + period)
    stride = 1 + int(np.count_nonzero(gone)) // MOST_POSES
    places, gone = places[::stride], gone[:, ::stride]
    designs, index = np.nonzero(gone)
    if not len(designs):
        return None
    found = kin_at(way, k, home, designs, places[index])
    if found is None:
        return None
    count, state = found
    counts = np.full(gone.shape, -1)
    states = np.full((*gone.shape, state.shape[-1]), np.nan)
    counts[designs, index], states[designs, index] = count, state
    return _Kin(places, counts, states)


def kin_at(way: Followed, k: int, home: GroupPath, designs: Number, places: Number) -> tuple[Number, Number] | None:
    """Return how many configurations have a branch's sign, and one of them. None where they are not known.

    `designs` and `places` are those of single poses. Where an earlier group is not assembled, the number is -1.
    """
    solver = way.solving_order.solvers[k]
    if len(solver.group.bodies) > MOST_BODIES:
        return None
    equations = equations_of(solver)
    count, states = np.full(len(designs), -1), np.full((len(designs), equations.width), np.nan)
    known = np.flatnonzero(column(_before(way, k, designs, places).failed == 0, len(designs)))
    if not len(known):
        return count, states
    block = _before(way, k, designs[known], places[known])
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


def _before(way: Followed, k: int, designs: Number, places: Number) -> Block:
    """Return what is solved before a group at single poses."""
    return way.run(way.given.pick(designs, places), 0, places[:, None], designs[:, None], k)


def why_no_return(way: Followed, k: int, home: GroupPath, design: int, place: float) -> str:
    """Say why a group does not come back at a pose of a gap."""
    if len(home.reach) > MOST_DESIGNS:
        return f"whether it comes back is looked for in motions of up to {MOST_DESIGNS} designs only"
    found = kin_at(way, k, home, np.array([design]), np.array([place]))
    if found is None:
        return "not all its configurations are known, so that none can be told to be its own after a gap"
    count = int(found[0][0])
    if count < 1:
        return "no configuration has the sign of its Jacobian there"
    if count == 1:
        return "the one configuration there with the sign of its Jacobian goes on beside it and is another branch"
    return f"{count} configurations there have the sign of its Jacobian, so that none can be told to be its own"
