"""A mechanism examined at its own dimensions: an assembled pose, how it moves from there, and what is held twice."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

from compoundkin.base.poses import Pose
from compoundkin.model.mechanism import Mechanism
from compoundkin.structure.composites import composites
from compoundkin.structure.redundancy.assembled_pose import Assembly, assembled, corrected
from compoundkin.structure.redundancy.constraint_equations import ROUNDED, STRICT, Array, Equations, Tolerance
from compoundkin.structure.redundancy.finite_motion import Flex, flex_of, null_space, rank_of
from compoundkin.structure.redundancy.self_stress import Candidate, candidates, stresses

# Wider equations than those of some hundred links take a dense decomposition many seconds.
WIDEST = 1500
# What opens by so many times the rounding of printed dimensions is not closed by taking them to be rounded.
FAR = 100.0
# At a pose that is found by iteration where the equations are singular, residuals of 1e-15 leave the pose, and so what
# ought to be zero, uncertain by their root.
ITERATED = 1e-6


@dataclass(frozen=True)
class Examined:
    """A mechanism examined at its own dimensions: an assembled pose, how it moves, and its states of self-stress."""

    equations: Equations
    assembly: Assembly

    @cached_property
    def rows(self) -> Array:
        """The rows of the pairs at the assembled pose."""
        return self.equations.jacobian(self.assembly.state)[0]

    @property
    def dependent(self) -> float:
        """Below which part of the largest a singular value at the assembled pose is zero."""
        return max(self.equations.tolerance.rank, 0.0 if self.assembly.is_given else ITERATED)

    @cached_property
    def rank(self) -> int:
        """The rank of the rows."""
        return rank_of(self.rows, self.dependent)

    @cached_property
    def flex(self) -> Flex:
        """How it moves. Where no row is redundant, all that is left free is motion."""
        state = self.assembly.state
        if self.rank == len(self.rows):
            free = null_space(self.rows, self.dependent)
            return Flex(state, free, free.shape[1])
        return flex_of(self.equations, state, self.dependent)

    @cached_property
    def stress(self) -> Array:
        """The states of self-stress, at a pose that is not special."""
        return stresses(self.equations, self.flex.state)

    @cached_property
    def candidates(self) -> list[Candidate]:
        """What may be left out."""
        bodies = composites(self.equations.mechanism)
        return candidates(self.equations, self.flex.state, self.stress, bodies) if self.stress.shape[1] else []

    @property
    def determined(self) -> int:
        """How many of its motions the drivers determine."""
        return rank_of(self.equations.driving(self.flex.state) @ self.flex.along, self.equations.tolerance.rank)


def examined(mechanism: Mechanism, poses: Mapping[str, Pose] | None = None) -> Examined:
    """A mechanism examined at its own dimensions; taken to be rounded where exact ones leave no motion."""
    exact = _examined(mechanism, STRICT, poses)
    if exact.assembly.is_closed and (exact.rank == len(exact.rows) or exact.flex.along.shape[1]):
        return exact
    if not exact.assembly.is_closed and exact.assembly.residual > FAR * ROUNDED.closed:
        # so far open is nothing by rounding
        return exact
    rounded = _examined(mechanism, ROUNDED, poses)
    return rounded if rounded.assembly.is_closed and rounded.flex.along.shape[1] else exact


def _examined(mechanism: Mechanism, tolerance: Tolerance, poses: Mapping[str, Pose] | None) -> Examined:
    equations = Equations(mechanism, tolerance)
    if poses is None:
        return Examined(equations, assembled(equations))
    return Examined(equations, corrected(equations, equations.state(poses)))
