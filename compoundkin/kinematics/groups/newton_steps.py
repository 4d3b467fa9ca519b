"""Newton's steps of a group from a state nearby, a known number of them: straight-line arithmetic."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from compoundkin.base.arrays import Number
from compoundkin.base.linear import Elimination, Row
from compoundkin.base.newton import elementwise_largest
from compoundkin.base.poses import Pose
from compoundkin.base.series import Series
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.groups.group_equations import CONVERGED, GroupEquations

# After steps that are not known to have converged, a correction that moves farther than this may have left its branch.
STRAY = 0.03


class ClosedState(NamedTuple):
    """Where steps led.

    The bodies' poses there, the matrix there, and whether all is as it should be.
    """

    bodies: Mapping[int, Pose]
    matrix: Elimination
    closed: Number


class NewtonSteps(NamedTuple):
    """So many of Newton's steps, and a last one.

    Steps before the last come from states that are only near, such as those predicted from another pose. Rates have the
    matrix of where the last one led: that of the step is as good in value, but does not change with dimensions as it.
    """

    equations: GroupEquations
    before: int = 0

    def closed(self, state: Sequence[Number], block: Block, leap: float) -> ClosedState:
        """Correct a state that moves no farther than a leap."""
        equations, leading, found = self.equations, block.leading(), list(state)
        for _ in range(self.before + 1):
            bodies = equations.kept_poses(found)
            step = self._matrix(bodies, leading).times(equations.residual(bodies, leading, 0))
            found = [value - change for value, change in zip(found, step, strict=True)]
        moved = [value - start for value, start in zip(found, state, strict=True)]
        near = self._largest(moved) <= (min(leap, STRAY) if self.before else leap)
        exact = self._largest(step) <= CONVERGED
        bodies = equations.kept_poses(found)
        return ClosedState(bodies, self._matrix(bodies, leading), near & exact)

    def _matrix(self, bodies: Mapping[int, Pose], leading: Block) -> Elimination:
        return Elimination([*self._rows(bodies, leading)], self.equations.width)

    def _largest(self, change: Sequence[Number]) -> Number:
        return elementwise_largest([one * weight for one, weight in zip(change, self.equations.weights, strict=True)])

    def _rows(self, bodies: Mapping[int, Pose], block: Block) -> Iterator[Row]:
        """Yield the Jacobian by rows: the equations' rates as one number of the state grows at unit rate."""
        equations = self.equations
        columns = [
            equations.residual({**bodies, body: moving}, block, 1)
            for body in equations.kept
            for moving in _moved_alone(bodies[body], equations.middles[body])
        ]
        for entries in zip(*columns, strict=True):
            yield dict(enumerate(entries))

    def series(self, found: ClosedState, block: Block) -> list[Pose]:
        """Return all bodies' poses to the block's order."""
        equations, kept = self.equations, dict(found.bodies)
        for k in range(1, block.order + 1):
            kept = equations.grown(kept, equations.next_rates(kept, found.matrix, block, k))
        whole = {**kept, **{bar.body: bar.pose(kept, block, block.order) for bar in equations.bars}}
        return [whole[k] for k in range(equations.n)]


def _moved_alone(pose: Pose, middle: complex) -> Iterator[Pose]:
    """Yield a pose as it moves at unit rate in x, y, and angle about its middle. What stands still has no rates."""
    z, u = pose.z.c[0], pose.u.c[0]
    yield Pose(Series((z, 1.0 + 0j)), pose.u)
    yield Pose(Series((z, 1j)), pose.u)
    turned = 1j * u
    yield Pose(pose.z if middle == 0 else Series((z, turned * -middle)), Series((u, turned)))
