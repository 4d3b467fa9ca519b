"""What is redundant at a mechanism's own dimensions, and its structure without that.

What is left out is checked along the whole motion. It is chosen so that what remains falls into groups with closed
forms where it can.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeAlias

import numpy as np

from compoundkin.base.poses import Pose
from compoundkin.model.mechanism import Mechanism
from compoundkin.structure.composites import composites
from compoundkin.structure.kinematic_structure import Structure
from compoundkin.structure.parts import Group, Relaxation
from compoundkin.structure.redundancy.assembled_pose import AssembledPose, assemble, corrected
from compoundkin.structure.redundancy.constraint_equations import ROUNDED, STRICT, Array, ConstraintEquations, Tolerance
from compoundkin.structure.redundancy.finite_motion import FiniteMotion, finite_motion, null_space, rank_of
from compoundkin.structure.redundancy.self_stress import Candidate, candidates, chosen, strength, stresses

# Wider equations than those of some hundred links take a dense decomposition many seconds.
WIDEST = 1500
# What opens by so many times the rounding of printed dimensions is not closed by taking them to be rounded.
FAR = 100.0
# At a pose that is found by iteration where the equations are singular, residuals of 1e-15 leave the pose, and so what
# ought to be zero, uncertain by their root.
ITERATED = 1e-6
# The bodies of a dyad, and the letters of its pairs where it has a closed form.
DYAD, SIMPLE = 2, frozenset("RP")
# How many structures are compared, and by how much weaker than the first choice others may be.
COMPARED = 400
WEAKER = 0.1
# A group without a closed form takes so many times as long as a dyad, and more with the number of its bodies.
GENERAL = 10


# Takes a mechanism apart, part of some pairs left out.
Decomposed: TypeAlias = Callable[[Mechanism, Relaxation], Structure]


@dataclass(frozen=True)
class Diagnosis:
    """The diagnosis of a mechanism at its own dimensions.

    An assembled pose, how it moves, and its states of self-stress.
    """

    equations: ConstraintEquations
    pose: AssembledPose

    @cached_property
    def rows(self) -> Array:
        """The rows of the pairs at the assembled pose."""
        return self.equations.jacobian(self.pose.state)[0]

    @property
    def dependent(self) -> float:
        """The part of the largest below which a singular value is zero. It is at the assembled pose."""
        return max(self.equations.tolerance.rank, 0.0 if self.pose.is_given else ITERATED)

    @cached_property
    def rank(self) -> int:
        """The rank of the rows."""
        return rank_of(self.rows, self.dependent)

    @cached_property
    def motion(self) -> FiniteMotion:
        """How it moves. Where no row is redundant, all that is left free is motion."""
        state = self.pose.state
        if self.rank == len(self.rows):
            free = null_space(self.rows, self.dependent)
            return FiniteMotion(state, free, free.shape[1])
        return finite_motion(self.equations, state, self.dependent)

    @cached_property
    def stress(self) -> Array:
        """The states of self-stress, at a pose that is not special."""
        if self.rank == len(self.rows):
            # independent rows have none
            return np.zeros((self.rank, 0))
        return stresses(self.equations, self.motion.state)

    @cached_property
    def candidates(self) -> list[Candidate]:
        """What may be left out."""
        bodies = composites(self.equations.mechanism)
        return candidates(self.equations, self.motion.state, self.stress, bodies) if self.stress.shape[1] else []

    @property
    def determined(self) -> int:
        """How many of its motions the drivers determine."""
        return rank_of(self.equations.driving(self.motion.state) @ self.motion.along, self.equations.tolerance.rank)


def diagnose(mechanism: Mechanism, poses: Mapping[str, Pose] | None = None) -> Diagnosis:
    """Diagnose a mechanism at its own dimensions. They are taken to be rounded where exact ones leave no motion."""
    exact = _diagnosed(mechanism, STRICT, poses)
    if exact.pose.is_closed and (exact.rank == len(exact.rows) or exact.motion.along.shape[1]):
        return exact
    if not exact.pose.is_closed and exact.pose.residual > FAR * ROUNDED.closed:
        # so far open is nothing by rounding
        return exact
    rounded = _diagnosed(mechanism, ROUNDED, poses)
    return rounded if rounded.pose.is_closed and rounded.motion.along.shape[1] else exact


def _diagnosed(mechanism: Mechanism, tolerance: Tolerance, poses: Mapping[str, Pose] | None) -> Diagnosis:
    equations = ConstraintEquations(mechanism, tolerance)
    if poses is None:
        return Diagnosis(equations, assemble(equations))
    return Diagnosis(equations, corrected(equations, equations.state(poses)))


def without_redundancy(structure: Structure, decomposed: Decomposed) -> Structure:
    """Return the structure without what is redundant. This is where its mechanism moves although it is overconstrained.

    The structure itself where nothing moves, or where its equations are too many to tell. `decomposed` takes the
    mechanism apart without some parts of pairs; what remains falls into dyads, which have closed forms, where it can.
    """
    mechanism = structure.mechanism
    if 3 * len(mechanism.links) > WIDEST:
        return structure
    with np.errstate(all="ignore"):
        found = diagnose(mechanism)
        if not found.pose.is_closed or found.motion.along.shape[1] <= len(structure.passive):
            return structure
        return _chosen(structure, found, decomposed)


def _chosen(structure: Structure, found: Diagnosis, decomposed: Decomposed) -> Structure:
    states = found.stress.shape[1]
    picked = chosen(found.candidates, states)
    if not picked:
        return structure
    pose = _relaxation(found)

    def made(parts: Sequence[Candidate]) -> Structure:
        return decomposed(structure.mechanism, replace(pose, dropped=tuple(one.dropped for one in parts)))

    limit, order = WEAKER * strength(picked), found.candidates
    best = made(picked)
    least, left = _cost(best, picked, order), COMPARED
    improved = True
    while improved and left > 0:
        improved = False
        for other in _neighbours(picked, order):
            if left <= 0:
                break
            if sum(len(one.forces) for one in other) != states or strength(other) < limit:
                continue
            left -= 1
            trial = made(other)
            cost = _cost(trial, other, order)
            if cost < least:
                best, least, picked, improved = trial, cost, other, True
                break
    return best if _excess(best) < _excess(structure) else structure


def _neighbours(picked: Sequence[Candidate], order: Sequence[Candidate]) -> list[list[Candidate]]:
    """List the choices in which one part is exchanged, the last written first."""
    found = []
    for k in range(len(picked)):
        rest = [*picked[:k], *picked[k + 1 :]]
        taken = {one.place for one in rest}
        found += [[*rest, other] for other in reversed(order) if other.place not in taken and other is not picked[k]]
    return found


def _cost(made: Structure, picked: Sequence[Candidate], order: Sequence[Candidate]) -> tuple[int, ...]:
    """Weigh what is left undecomposed or may fail, how hard the groups are, and what is left out."""
    places = list(dict.fromkeys(one.place for one in order))
    early = sum(len(places) - places.index(one.place) for one in picked)
    oblique = sum(not one.is_aligned for one in picked)
    return _excess(made), oblique, sum(_effort(group) for group in made.groups), early


def _excess(structure: Structure) -> int:
    return sum(fault.amount for fault in structure.faults)


def _effort(group: Group) -> int:
    count = len(group.bodies)
    is_closed = (count == DYAD and set(group.name) <= SIMPLE) or (count == 1 and len(group.outer) == 2)
    return count if is_closed else GENERAL * count * count


def _relaxation(found: Diagnosis) -> Relaxation:
    """Return the assembled pose; where nothing is drawn, one that is not special."""
    equations = found.equations
    drawn = bool(equations.mechanism.sketch)
    poses = equations.poses(found.pose.state if drawn else found.motion.state)
    carriers = equations.mechanism.carriers
    places = {letter: equations.place(poses, names[0], letter) for letter, names in carriers.items()}
    return Relaxation((), places, poses)
