"""All configurations of a group without a closed form, in given surroundings, as x, y, theta of its bodies."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from compoundkin.base.errors import InvalidInput
from compoundkin.base.poses import Pose
from compoundkin.base.series import Number, constant
from compoundkin.kinematics.assembly import all_configurations, from_group
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.groups.steps import GeneralStep

# Where no theory counts a group's configurations, Newton searches them from so many random states.
STARTS = 60
STEPS = 40
# Groups of more bodies are searched too: the work for all configurations grows some sixtyfold with every two bodies.
MOST_BODIES = 8
# Configurations nearer than this (parts of the size, radians) are one.
SAME = 1e-6


class GroupStates(NamedTuple):
    """States (..., m, 3 n) of the real configurations, padded with NaN; `expected` is how many complex ones there are.

    `certified` says where none is missing. For groups that are searched only, `expected` is 0.
    """

    states: Number
    expected: int
    certified: Number


def group_states(step: GeneralStep, block: Block, size: float) -> GroupStates:
    """The real configurations in any surroundings, in a fixed order."""
    found = every_state(step, block, size)
    if found is not None:
        return found
    states = _searched(step, block, size)
    return GroupStates(states, 0, np.zeros(states.shape[:-2], dtype=bool))


def every_state(step: GeneralStep, block: Block, size: float, most: int = MOST_BODIES) -> GroupStates | None:
    """As `group_states`, without any search: None for groups with higher pairs, and those of very many bodies."""
    if len(step.group.bodies) > most:
        return None
    try:
        found = all_configurations(from_group(step.group, block, size))
    except InvalidInput:
        return None
    return GroupStates(found.states, found.expected, np.asarray(found.certified))


def _searched(step: GeneralStep, block: Block, size: float) -> Number:
    """What Newton finds from random states around the origins of what the group is attached to."""
    n = step.solver.n
    rng = np.random.default_rng(n)
    around = np.broadcast_arrays(*(block.world[link].z.c[0] for link in step.group.uses))
    shape = block.extent(step.group.uses)
    centre = np.broadcast_to(np.mean(around, axis=0), shape)
    spots = centre + size / 2.0 * _spots(rng, n, shape)
    turns = rng.uniform(-np.pi, np.pi, (STARTS, n)).reshape(STARTS, n, *[1] * len(shape))
    parts = [v for k in range(n) for v in np.broadcast_arrays(spots[:, k].real, spots[:, k].imag, turns[:, k])]
    solution = step.solver.newton(states_of(step, np.stack(parts, axis=-1)), block, steps=STEPS)
    bodies = step.solver.series(solution.state, block, 0)
    parts = [v for b in bodies for v in (b.z.c[0].real, b.z.c[0].imag, np.angle(b.u.c[0]))]
    states = np.stack(np.broadcast_arrays(*parts), axis=-1)
    return _once(np.moveaxis(np.where(solution.closed[..., None], states, np.nan), 0, -2), size)


def _spots(rng: np.random.Generator, n: int, shape: tuple[int, ...]) -> Number:
    spots = rng.standard_normal((STARTS, n)) + 1j * rng.standard_normal((STARTS, n))
    return spots.reshape(STARTS, n, *[1] * len(shape))


def _once(states: Number, size: float) -> Number:
    """Each state once, in the order of the angles of the bodies; padded with NaN."""
    shape = states.shape[:-2]
    lists = [_distinct(found, size) for found in states.reshape(-1, *states.shape[-2:])]
    most = max((len(found) for found in lists), default=0)
    out = np.full((len(lists), most, states.shape[-1]), np.nan)
    for row, found in zip(out, lists, strict=True):
        row[: len(found)] = found
    return out.reshape(*shape, most, states.shape[-1])


def _distinct(states: Number, size: float) -> Number:
    known = states[np.isfinite(states).all(axis=-1)]
    kept: list[Number] = []
    for state in known:
        if not any(apart(state, other, size) < SAME for other in kept):
            kept.append(state)
    kept.sort(key=lambda state: tuple(np.round(state[2::3], 6)))
    return np.array(kept).reshape(len(kept), states.shape[-1])


def apart(one: Number, other: Number, size: float) -> Number:
    """How far states (..., 3 n) are from each other: parts of the size, radians; whole turns do not count."""
    gap = one - other
    turn = np.abs(np.angle(np.exp(1j * gap[..., 2::3])))
    shift = np.maximum(np.abs(gap[..., 0::3]), np.abs(gap[..., 1::3])) / size
    return np.maximum(turn, shift).max(axis=-1)


def states_of(step: GeneralStep, seeds: Number) -> Number:
    """A group's states, as its solver has them, from x, y, theta of each body."""
    return step.solver.state(bodies_at(seeds))


def bodies_at(states: Number) -> list[Pose]:
    """The poses of bodies from states (..., 3 n): x, y, theta of each."""
    x, y, theta = states[..., 0::3], states[..., 1::3], states[..., 2::3]
    u, z = np.cos(theta) + 1j * np.sin(theta), x + 1j * y
    return [Pose(constant(z[..., k]), constant(u[..., k]), constant(theta[..., k])) for k in range(x.shape[-1])]
