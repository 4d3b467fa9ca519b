"""The shaking force: what a mechanism does to its frame."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from compoundkin.base.arrays import Number, Vectors
from compoundkin.base.wrenches import Wrench
from compoundkin.dynamics.found_forces import FoundForces
from compoundkin.dynamics.named_forces.link_forces import link_forces
from compoundkin.dynamics.named_forces.link_wrench import DRIVER, PAIR, LinkWrench, as_vectors, moment_about
from compoundkin.kinematics.results import told
from compoundkin.model.geometry import FRAME


@dataclass(frozen=True, eq=False, repr=False)
class ShakingForce:
    """The force of a mechanism on its frame.

    It is that of pairs, of drivers' reactions, of springs and dampers fixed to the frame. External loads on the frame
    are none of the mechanism's: they are in `external` alone. Without those it is the sum of loads and weights less
    that of masses times accelerations.
    """

    forces: FoundForces

    @cached_property
    def parts(self) -> tuple[LinkWrench, ...]:
        """All that acts on the frame, by name and kind."""
        return tuple(link_forces(self.forces, FRAME))

    @property
    def pairs(self) -> tuple[LinkWrench, ...]:
        """The forces of pairs on the frame, without drivers' reactions."""
        return self._of(PAIR)

    @property
    def reactions(self) -> tuple[LinkWrench, ...]:
        """The drivers' reactions."""
        return self._of(DRIVER)

    @property
    def external(self) -> tuple[LinkWrench, ...]:
        """The loads on the frame that do not come from a link."""
        return tuple(one for one in self.parts if not one.by)

    @property
    def whole(self) -> Wrench:
        """All that the mechanism does to the frame, about the world's origin, (designs, poses)."""
        if self.forces.singular:
            # where single forces have no limit their sum may have one
            return self.forces.on_frame - _sum(self.external)
        return _sum(one for one in self.parts if one.by)

    @property
    def force(self) -> Vectors:
        """The shaking force, complex; `.xy` gives (..., 2)."""
        return as_vectors(self.forces.motion, self.whole.force)

    def moment_about(self, point: Any) -> Number:
        """Return the shaking moment about a letter or a place of the world. It depends on the point: say which."""
        return moment_about(self.forces.motion, self.whole, point)

    def _of(self, kind: str) -> tuple[LinkWrench, ...]:
        return tuple(one for one in self.parts if one.kind == kind)

    def __repr__(self) -> str:
        return told(self, self.forces.grid, ", ".join(one.name for one in self.parts[:6]))


def _sum(acting: Iterable[LinkWrench]) -> Wrench:
    whole = Wrench()
    for one in acting:
        whole = whole + one.whole
    return whole
