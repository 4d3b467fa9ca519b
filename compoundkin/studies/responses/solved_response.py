"""Responses that need `solve`: forces, and figures of groups without a closed form."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, InvalidMechanism, NotAssembled, NotDetermined
from compoundkin.kinematics.quantities import quantity
from compoundkin.studies.responses.designs import Designs, design_blocks
from compoundkin.studies.responses.response import Response

# The number of poses solved together, so that a motion with all its forces fits in memory.
MOST_POSES = 2**15
# The step of a central difference relative to the scale: truncation and rounding errors are alike.
STEP = 1e-5
# Errors of one design, which must not stop the others.
UNSOLVED = (InvalidInput, InvalidMechanism, NotAssembled, NotDetermined)


@dataclass(frozen=True)
class SolvedResponse(Response):
    """A quantity or figure found by `solve`. Its slopes are differences."""

    def values(self, designs: Designs) -> Number:
        """Return its values; figures are NaN for designs that are not assembled at all poses."""
        shape = (designs.number, designs.poses) if self.is_course else (designs.number,)
        found = np.full(shape, np.nan, dtype=complex if self.is_vector else float)
        for block in design_blocks(designs.number, designs.poses, MOST_POSES):
            for rows, values in self._parts(designs, np.array(block)):
                found[rows] = values
        return found

    def _parts(self, designs: Designs, rows: Number) -> Iterator[tuple[Number, Number]]:
        """Yield the values of some designs, in halves where one of them cannot be solved."""
        try:
            with np.errstate(all="ignore"):
                yield rows, self._solved(designs.picked(rows))
        except UNSOLVED:
            half = len(rows) // 2
            if half:
                yield from self._parts(designs, rows[:half])
                yield from self._parts(designs, rows[half:])

    def _solved(self, some: Designs) -> Number:
        motion = some.motion
        shape = some.number, some.poses
        values = np.broadcast_to(np.reshape(quantity(motion, self.name).values, motion.failed.shape), shape)
        failed = np.broadcast_to(motion.failed != 0, shape)
        return values if self.is_course else np.where(failed.any(axis=1), np.nan, values[:, 0])

    @property
    def has_slopes(self) -> bool:
        """False: its slopes are differences."""
        return False

    def slopes(self, designs: Designs) -> Number:
        """Return central differences, (coordinates, designs) and poses for a course."""
        found = []
        for one in designs.path.coordinates:
            step = STEP * designs.path.scale(one)
            above, below = (self.values(designs.moved(one, by)) for by in (step, -step))
            found.append((above - below) / (2.0 * step))
        return np.array(found)
