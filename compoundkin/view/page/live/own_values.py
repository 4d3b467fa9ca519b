"""What the program of a page finds with the mechanism's own dimensions: where it agrees, a page need not hold it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from compoundkin.base.arrays import unwrapped
from compoundkin.base.series import Number
from compoundkin.kinematics.quantities import quantity
from compoundkin.model.attributes import OF_LINKS
from compoundkin.programs.recording.recorded_outputs import ProgramOutput
from compoundkin.programs.tables.page_program import PageProgram

# In parts of the largest value: what is packed with seven digits agrees.
AGREES = 1e-9


@dataclass(frozen=True, eq=False)
class OwnValues:
    """The values that a program finds at the poses of a page."""

    program: PageProgram
    chosen: Number

    @cached_property
    def failed(self) -> Number:
        """Where the motion is not assembled."""
        return self.program.motion.failed[0, self.chosen] != 0

    @cached_property
    def closes(self) -> bool:
        """Whether it is assembled where the motion is."""
        goods = self.program.own([node for _, node in self.program.goods], self.chosen)
        every = [np.broadcast_to(good, self.failed.shape).astype(bool) for good in goods]
        return bool(np.array_equal(np.logical_and.reduce([np.ones(self.failed.shape, bool), *every]), ~self.failed))

    def has_link(self, name: str) -> bool:
        """Tell whether it finds a link, its velocities and accelerations."""
        link, order = self.program.motion.links[name], self.program.order
        wrapped = self.program.mechanism.block.world[name].theta is None
        nodes = [node for moved in self.program.links[name] for node in moved]
        found = self.program.own(nodes, self.chosen) if self.closes else []
        known = [
            part
            for k in range(order + 1)
            for part in self._moved(link.origin.derivative(k), getattr(link, OF_LINKS[k]))
        ]
        return self.closes and all(
            self._agrees(one, other, wrapped and k == 2)
            for k, (one, other) in enumerate(zip(found, known, strict=True))
        )

    def has_output(self, output: ProgramOutput, nodes: Sequence[int]) -> bool:
        """Tell whether it finds an output."""
        values = np.broadcast_to(quantity(self.program.motion, output.name).values, self.program.motion.shape)
        parts = (values,) if len(nodes) == 1 else (values.real, values.imag)
        found = self.program.own(nodes, self.chosen) if self.closes else []
        return self.closes and all(
            self._agrees(one, self._of(part), output.is_wrapped) for one, part in zip(found, parts, strict=True)
        )

    def _moved(self, z: Number, turned: Number) -> tuple[Number, Number, Number]:
        return self._of(np.real(z)), self._of(np.imag(z)), self._of(turned)

    def _of(self, values: Number) -> Number:
        return np.broadcast_to(values, self.program.motion.shape)[..., self.chosen]

    def _agrees(self, found: Number, known: Number, wrapped: bool) -> bool:
        values = np.where(self.failed, np.nan, found)
        if wrapped:
            values = unwrapped(np.where(values == -np.pi, np.pi, values))
        largest = np.nanmax(np.abs(np.where(np.isfinite(known), known, 0.0)), initial=1e-300)
        return bool(np.allclose(values, known, rtol=0.0, atol=AGREES * largest + 1e-12, equal_nan=True))
