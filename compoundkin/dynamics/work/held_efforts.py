"""What holds drivers at rest: their efforts by virtual work at any values, and how these change with the values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.dynamics.loaded_block import loaded_blocks
from compoundkin.dynamics.work.virtual_work import virtual_efforts
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.unit_rates import moved_alone, moved_together

# Slopes are differences of fourth order over steps of so much (radians, parts of the size): what they leave out and
# what rounding leaves in them are both some 1e-12 of the slope.
STEP = 1e-3
STENCIL = ((-2, 1.0 / 12.0), (-1, -8.0 / 12.0), (1, 8.0 / 12.0), (2, -1.0 / 12.0))


@dataclass(frozen=True, eq=False, repr=False)
class HeldEfforts(ShortRepr):
    """The efforts that hold some drivers, which are let go. Others stay where they are."""

    free: tuple[str, ...]

    def at(self, motion: Motion) -> Number:
        """Return the efforts at rest, (drivers, designs, poses)."""
        found = virtual_efforts(motion, False)
        return np.array([found[name] for name in self.free])

    def slopes(self, motion: Motion) -> Number:
        """Return the derivatives of the efforts by the drivers' values, (effort, value, designs, poses)."""
        columns = []
        for name in self.free:
            step = STEP * motion.solving_order.unit(name)
            parts = (weight * self.at(self._beyond(motion, {name: k * step})) for k, weight in STENCIL)
            columns.append(sum(parts) / step)
        found = np.stack(columns, axis=1)
        return 0.5 * (found + np.swapaxes(found, 0, 1))

    @staticmethod
    def _beyond(motion: Motion, values: Mapping[str, Number]) -> Motion:
        moved: Motion = moved_together(motion, {}, 1, values)
        return moved

    def scales(self, motion: Motion) -> Number:
        """Return the largest that a load asks of each driver, (drivers,)."""
        found = np.zeros(len(self.free))
        for k, name in enumerate(self.free):
            with np.errstate(all="ignore"):
                for at, unit in zip(loaded_blocks(motion), loaded_blocks(moved_alone(motion, name)), strict=True):
                    for _, link, wrench in at.named_loads():
                        power = np.abs(at.freed(link, wrench).power(unit.pose(link)))
                        found[k] = max(found[k], float(np.max(power, initial=0.0, where=np.isfinite(power))))
        return found
