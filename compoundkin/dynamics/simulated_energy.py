"""The energy of a simulated motion: kinetic, potential, the work of what has no potential, and what does not add up."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compoundkin.base.display import PrintsShort
from compoundkin.base.series import Number
from compoundkin.dynamics.loaded_block import LoadedBlock, loaded_blocks
from compoundkin.kinematics.motion import Motion


@dataclass(frozen=True, eq=False, repr=False)
class SimulatedEnergy(PrintsShort):
    """Energies at the times of a simulation, in units of force times length.

    `work` is that of loads without a potential and of prescribed drivers since the start.
    """

    kinetic: Number
    potential: Number
    work: Number

    @property
    def total(self) -> Number:
        """The kinetic and the potential energy."""
        return self.kinetic + self.potential

    @property
    def error(self) -> Number:
        """What does not add up: the change of the total less the work."""
        return self.total - self.total[0] - self.work

    @property
    def peak(self) -> float:
        """The greatest energy that was moved about: kinetic, of a change of the potential, or of the work."""
        parts = (self.kinetic, self.potential - self.potential[0], self.work)
        return max(float(np.max(np.abs(part))) for part in parts)

    @property
    def worst(self) -> float:
        """The greatest error as a part of the peak."""
        return float(np.max(np.abs(self.error))) / self.peak if self.peak else 0.0


def simulated_energy(motion: Motion, work: Number) -> SimulatedEnergy:
    """Return the energies of a motion of one design."""
    kinetic, potential = np.zeros(motion.failed.shape), np.zeros(motion.failed.shape)
    for loaded in loaded_blocks(motion):
        at = loaded.designs, loaded.poses
        kinetic[at], potential[at] = _of_block(loaded)
    return SimulatedEnergy(kinetic[0], potential[0], work)


def _of_block(loaded: LoadedBlock) -> tuple[Number, Number]:
    factor, mechanism = loaded.units.inertia, loaded.motion.mechanism
    kinetic: Number = 0.0
    potential: Number = 0.0
    fall = mechanism.gravity * loaded.units.metre
    for mass in mechanism.masses.values():
        own, spin = loaded.fitted(mass.mass) * factor, loaded.fitted(mass.inertia) * factor
        centre, turned = loaded.place(mass.link, mass.at).c, loaded.pose(mass.link).u.c
        if len(centre) > 1:
            kinetic = kinetic + own * abs(centre[1]) ** 2 / 2.0
        if len(turned) > 1:
            kinetic = kinetic + spin * abs(turned[1]) ** 2 / 2.0
        potential = potential - own * (fall.conjugate() * centre[0]).real
    return kinetic, potential
