"""Any other group: Newton's method on the pairs' own equations; its configurations are numbered."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import ClassVar, Self

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput
from compoundkin.base.poses import Pose
from compoundkin.base.series import constant
from compoundkin.kinematics.assembly import all_configurations, from_group
from compoundkin.kinematics.block import Block, size_in
from compoundkin.kinematics.configuration import Configurations, state_distance
from compoundkin.kinematics.groups.contract import GroupSolver
from compoundkin.kinematics.groups.force_transmission import PassedForce, forces_of, worst_transmission
from compoundkin.kinematics.groups.group_equations import GroupEquations, Member, NewtonSteps, middle_of, surroundings
from compoundkin.kinematics.groups.pair_sides import Reason, alone
from compoundkin.model.pairs.contract import Ends
from compoundkin.model.pairs.profile_contact import as_profile_contact
from compoundkin.structure.mobility_count import Group

# Where no theory counts a group's configurations, Newton searches them from so many random states.
STARTS = 60
STEPS = 40
# Groups of more bodies are searched too: the work for all configurations grows some sixtyfold with every two bodies.
MOST_BODIES = 8
# Configurations nearer than this (parts of the size, radians) are one.
SAME = 1e-6


class GeneralSolver(GroupSolver):
    """The solver of a group without a closed form.

    Its configurations have no sign, and are followed along the motion.
    """

    modes: ClassVar[int] = 0
    equations: GroupEquations

    def __init__(self, index: int, group: Group, size: float, middles: tuple[complex, ...] = ()) -> None:
        super().__init__(index, group)
        where = {link: k for k, body in enumerate(group.bodies) for link in body.links}
        self.pairs = (*group.inner, *group.outer)
        members = tuple(tuple(Member(name, where.get(name)) for name in pair.members) for pair in self.pairs)
        self.equations = GroupEquations(len(group.bodies), self.pairs, members, size, middles)

    @classmethod
    def of(cls, index: int, group: Group, size: float, ends: Mapping[str, Ends]) -> Self:
        """Return the solver of any group."""
        return cls(index, group, size, tuple(middle_of(body, group, ends) for body in group.bodies))

    def close(self, block: Block, mode: Number) -> None:
        """Correct a state, add the derivatives, and the group's links to what is known."""
        found = self.equations.newton(mode, block)
        closed = found.closed & (found.moved < block.limits.leap)
        keeps = block.limits.keeps_states
        if not keeps:
            block.fail(closed, self.index)
        state = np.where(closed[..., None], found.state, mode if keeps else np.nan)
        for body, pose in zip(self.group.bodies, self.equations.series(state, block, block.order), strict=True):
            block.publish(body, pose)

    def from_state(self, steps: int = 0) -> GroupSolver:
        """Return the solver that closes it from a state nearby.

        So many steps before the last may be long.
        """
        return GeneralFromState(self, steps)

    @property
    def width(self) -> int:
        """How many numbers a state has."""
        return self.equations.width

    def state(self, block: Block) -> Sequence[Number]:
        """Return x, y and angle of each body that is no bar."""
        poses = [block.world[self.group.bodies[k].links[0]] for k in self.equations.kept]
        return [v for pose in poses for v in (pose.z.c[0].real, pose.z.c[0].imag, pose.angle.c[0])]

    @cached_property
    def _forces(self) -> tuple[GroupEquations, tuple[PassedForce, ...]]:
        """The equations of all bodies, none of them left out as a bar, and the forces that pass between them."""
        own = self.equations
        whole = GroupEquations(own.n, own.pairs, own.members, own.size, own.middles, bars=False)
        return whole, forces_of(whole)

    @property
    def tells_transmission(self) -> bool:
        """Whether some body or contact passes on one force."""
        return bool(self._forces[1])

    @property
    def has_transmission_angle(self) -> bool:
        """Whether it is one body with a single contact."""
        return len(self.group.bodies) == 1 and len(self.group.outer) == 2 and self.tells_transmission

    def transmission(self, block: Block) -> Number:
        """Return the angle of the body or contact that transmits worst."""
        return worst_transmission(*self._forces, block, [body.links[0] for body in self.group.bodies])

    def every(self, block: Block) -> Configurations:
        """Return the real configurations.

        Where no theory knows them, they are those that are found from random states.
        """
        found = known_configurations(self.group, block, self.equations.size)
        return self._searched(block) if found is None else found

    def reasons(self, block: Block) -> tuple[Reason, ...]:
        """Return that its path came to a limit, or a pair to its end. The limit is a limit position."""
        limit = "the tracked configuration ends at a limit position, where the group's equations become singular"
        profiled = (pair for pair in map(as_profile_contact, self.pairs) if pair and pair.has_ends)
        open_ = [f"{pair.letters[0]} leaves the profile of {pair.members[0]}" for pair in profiled]
        return alone(f"{limit}, or where {' or '.join(open_)} at an end" if open_ else limit)

    def _searched(self, block: Block) -> Configurations:
        """Return what Newton finds from random states around the places where the group is attached."""
        n, size = len(self.equations.kept), size_in(block.ends, self.equations.size)
        rng = np.random.default_rng(self.equations.n)
        centre, reach = surroundings(self.equations, block)
        shape = block.extent(self.group.uses)
        single = [1] * len(shape)
        spots = rng.standard_normal((STARTS, n)) + 1j * rng.standard_normal((STARTS, n))
        spots = np.broadcast_to(centre, shape) + reach / 2.0 * spots.reshape(STARTS, n, *single)
        turns = rng.uniform(-np.pi, np.pi, (STARTS, n)).reshape(STARTS, n, *single)
        start = [v for k in range(n) for v in np.broadcast_arrays(spots[:, k].real, spots[:, k].imag, turns[:, k])]
        known = np.stack(start, axis=-1)
        found = self.equations.newton(known, block, steps=STEPS)
        bodies = self.equations.series(found.state, block, 0)
        numbers = [v for b in bodies for v in (b.z.c[0].real, b.z.c[0].imag, np.angle(b.u.c[0]))]
        states = np.where(found.closed[..., None], np.stack(np.broadcast_arrays(*numbers), axis=-1), np.nan)
        return Configurations.of_states(_once(np.moveaxis(states, 0, -2), size))


class GeneralFromState(GeneralSolver):
    """The same group, closed from a state near its own.

    It takes straight-line arithmetic and no search.
    """

    def __init__(self, solver: GeneralSolver, steps: int) -> None:
        vars(self).update(vars(solver))
        own = solver.equations
        # bodies by their origins: what is the same state for all dimensions
        self.equations = GroupEquations(own.n, own.pairs, own.members, own.size)
        self.steps = NewtonSteps(self.equations, steps)

    def side(self, block: Block, state: Sequence[Number]) -> Number:
        """Return the determinant of its equations."""
        return self.steps.closed(state, block, block.limits.leap).matrix.determinant

    def close(self, block: Block, mode: Sequence[Number]) -> None:
        """Correct a state, add the derivatives, and the group's links to what is known."""
        found = self.steps.closed(mode, block, block.limits.leap)
        block.fail(found.closed, self.index)
        for body, pose in zip(self.group.bodies, self.steps.series(found, block), strict=True):
            block.publish(body, pose)


def known_configurations(group: Group, block: Block, size: float, most: int = MOST_BODIES) -> Configurations | None:
    """Return all configurations of a group without any search.

    None for groups with higher pairs, and those of more than `most` bodies.
    """
    if len(group.bodies) > most:
        return None
    try:
        return all_configurations(from_group(group, block, size))
    except InvalidInput:
        return None


def _once(states: Number, size: Number) -> Number:
    """Return each state once, in the order of the angles of the bodies; padded with NaN."""
    shape = states.shape[:-2]
    sizes = np.broadcast_to(size, shape).ravel()
    lists = [_distinct(found, own) for found, own in zip(states.reshape(-1, *states.shape[-2:]), sizes, strict=True)]
    most = max((len(found) for found in lists), default=0)
    out = np.full((len(lists), most, states.shape[-1]), np.nan)
    for row, found in zip(out, lists, strict=True):
        row[: len(found)] = found
    return out.reshape(*shape, most, states.shape[-1])


def _distinct(states: Number, size: float) -> Number:
    known = states[np.isfinite(states).all(axis=-1)]
    kept: list[Number] = []
    for state in known:
        if not any(state_distance(state, other, size) < SAME for other in kept):
            kept.append(state)
    kept.sort(key=lambda state: tuple(np.round(state[2::3], 6)))
    return np.array(kept).reshape(len(kept), states.shape[-1])


def bodies_at(states: Number) -> list[Pose]:
    """Return the poses of bodies from states (..., 3 n). They are x, y, theta of each."""
    x, y, theta = states[..., 0::3], states[..., 1::3], states[..., 2::3]
    u, z = np.cos(theta) + 1j * np.sin(theta), x + 1j * y
    return [Pose(constant(z[..., k]), constant(u[..., k]), constant(theta[..., k])) for k in range(x.shape[-1])]
