"""Forces that equilibrium leaves open, in words: which part of them, together with which others."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from compoundkin.base.arrays import Number, cross, dot
from compoundkin.dynamics.force_result import ForceResult
from compoundkin.dynamics.reactions.link_wrench import UNKNOWN_VECTOR
from compoundkin.dynamics.reactions.pair_forces import PairForce
from compoundkin.dynamics.reactions.reverse_pass import UndeterminedPart
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.profile_contact import as_profile_contact
from compoundkin.structure.mobility_count import Dropped

# The angle within which a force is along a line of a link at every pose.
ALONG = 1e-3


@dataclass(frozen=True, eq=False)
class Undetermined:
    """Part of the force in a pair that equilibrium does not determine.

    `part` says which, `others` are the pairs in states of self-stress with it; were all of `freed` left free, it would
    be determined. `line` is the direction of the part, NaN where it is the whole force or a moment; `poses` are those
    at which it is open, in the motion's shape.
    """

    pair: str
    part: str
    others: tuple[str, ...]
    freed: tuple[Dropped, ...]
    line: Number = field(repr=False)
    poses: Number = field(repr=False)

    def __str__(self) -> str:
        return f"{self.pair}: {self.part}, balanced by forces in {', '.join(self.others)}"


def undetermined_forces(forces: ForceResult) -> tuple[Undetermined, ...]:
    """Return the undetermined parts of the forces in all pairs."""
    if not forces.relaxed:
        return ()
    held = {name: PairForce(forces, forces.solving_order.pairs[name]) for name in forces.wrenches}
    left = {name: one.acting.open for name, one in held.items()}
    return tuple(found for name, one in left.items() if one is not None for found in _parts(forces, held[name], one))


# A contact is no part of a state of self-stress that has less than this part of its greatest normal force there.
NO_PART = 1e-9


def pressing_force(forces: ForceResult, name: str) -> float:
    """Return the force that presses a contact at a single pose, negative where it would have to pull.

    Where equilibrium leaves open how contacts share it, as in conjugate cams, it is what they have to spare while
    none pulls, and infinite where they can be squeezed between each other.
    """
    held = {pair.name: PairForce(forces, pair) for pair in forces.solving_order.pairs.values()
            if (contact := as_profile_contact(pair)) is not None and not contact.has_ends}  # fmt: skip
    normals = {one: float(np.ravel(own.normal)[0]) for one, own in held.items()}
    if not forces.relaxed:
        return normals[name]
    units = {one: own.pair.wrenches(own.ends, own.poses)[0].force for one, own in held.items()}
    rows = [[float(np.ravel(dot(units[one], state[one].force))[0]) for one in held]
            for state in forces.self_stress.states]  # fmt: skip
    return spare_force(list(held).index(name), np.array([*normals.values()]), np.reshape(rows, (-1, len(held))))


def spare_force(which: int, normals: Number, states: Number) -> float:
    """Return the force that presses one of some contacts, by those without self-stress and its states, each a row.

    Where states have it with others it is what they have to spare while none pulls.
    """
    large = np.abs(states) > NO_PART * np.max(np.abs(states), axis=1, keepdims=True, initial=0.0)
    shared = large[:, which]
    if not shared.any():
        return float(normals[which])
    own = large[shared].any(axis=0)
    return _spare(normals[own], states[shared][:, own])


def _spare(normals: Number, states: Number) -> float:
    """Return the greatest least force of contacts under states of self-stress, each row one."""
    from scipy.optimize import linprog

    states = states / np.max(np.abs(states), axis=1, keepdims=True)
    if len(states) == 1:
        return _spare_along(normals, states[0])
    # n + s . x >= t with the greatest t
    columns = np.column_stack([-states.T, np.ones(len(normals))])
    goal = np.append(np.zeros(len(states)), -1.0)
    scale = float(np.max(np.abs(normals))) or 1.0
    found = linprog(goal, A_ub=columns, b_ub=normals / scale, bounds=(None, None))
    return np.inf if found.status == UNBOUNDED else -float(found.fun) * scale


def _spare_along(normals: Number, state: Number) -> float:
    """Return this by a single state: the least is where a force that grows with the state meets one that falls."""
    grows, falls = state > 0.0, state < 0.0
    if not (grows.any() and falls.any()):
        return np.inf
    up, down = state[grows][:, None], -state[falls]
    met = (normals[grows][:, None] * down + normals[falls] * up) / (up + down)
    return float(np.min(met))


# The status of a linear program without an end.
UNBOUNDED = 3


def _parts(forces: ForceResult, held: PairForce, left: UndeterminedPart) -> Iterator[Undetermined]:
    others, freed = forces.self_stress.sharing(held.name)
    shown, line = forces.motion.grid.shaped, forces.motion.grid.known(left.line)
    if np.any(left.force):
        part = _direction(forces, held.pair, left)
        yield Undetermined(held.name, part, others, freed, line, shown(left.force))
    # the moment of a single force is undetermined with it
    if np.any(left.moment) and held.pair.held_angles:
        part = f"the moment about {held.at}"
        yield Undetermined(held.name, part, others, freed, UNKNOWN_VECTOR + 0.0 * line, shown(left.moment))


def _direction(forces: ForceResult, pair: Pair, left: UndeterminedPart) -> str:
    """Say which part of a force is open."""
    if pair.held == 1 or pair.held_angles:
        return "the normal force"
    line = np.where(left.force, left.line, np.nan)
    if np.all(np.isnan(line[left.force])):
        return "the force, in all directions"
    motion, letter = forces.motion, pair.letters[0]
    for link in pair.members:
        points = motion.mechanism.geometry.points[link]
        for other in points if letter in points else ():
            if other != letter:
                along = motion.poses[link].u.c[0] * (points[other] - points[letter])
                apart = np.abs(cross(along / np.abs(along), np.where(np.isnan(line), along / np.abs(along), line)))
                if np.all(apart < ALONG):
                    return f"the force along {letter} {other} of {link}"
    return "the force along one line"
