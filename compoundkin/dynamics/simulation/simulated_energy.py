"""The energy of a simulated motion: kinetic, potential, the work of loads without a potential, and the error."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from compoundkin.base.arrays import Number, dot, first_entry
from compoundkin.base.display import ShortRepr
from compoundkin.dynamics.loaded_block import loaded_blocks
from compoundkin.dynamics.mass_motion import mass_motions
from compoundkin.kinematics.motion import Motion
from compoundkin.model.loads.contract import Load

# The rounding error of the total energy.
ROUNDING = 64.0 * np.finfo(float).eps


@dataclass(frozen=True, eq=False, repr=False)
class SimulatedEnergy(ShortRepr):
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
        """The energy error: the change of the total less the work, both since the first time."""
        return self.total - self.total[0] - (self.work - self.work[0])

    @property
    def peak(self) -> float:
        """The greatest of kinetic energy, change of potential energy, and work."""
        parts = (self.kinetic, self.potential - self.potential[0], self.work)
        return max(float(np.max(np.abs(part))) for part in parts)

    @property
    def worst(self) -> float:
        """The greatest error relative to the peak, zero where it is rounding of the total."""
        error = float(np.max(np.abs(self.error)))
        rounding = ROUNDING * float(np.max(np.abs(self.total)))
        return error / self.peak if error > rounding and self.peak else 0.0


def joined_energy(parts: Sequence[SimulatedEnergy]) -> SimulatedEnergy:
    """Return the energies of several phases in a row."""
    if len(parts) == 1:
        return parts[0]
    kinetic, potential, work = (
        np.concatenate([getattr(one, name) for one in parts]) for name in ("kinetic", "potential", "work")
    )
    return SimulatedEnergy(kinetic, potential, work)


def simulated_energy(motion: Motion, work: Number) -> SimulatedEnergy:
    """Return the energies of a motion of one design."""
    mechanism = motion.mechanism
    factor, fall = mechanism.stated_units.inertia, complex(first_entry(mechanism.free_fall))
    kinetic, potential = np.zeros(motion.shape), np.zeros(motion.shape)
    for own in mass_motions(motion):
        kinetic += np.ravel(own.product(1, own, 1)) * (factor / 2.0)
        potential -= np.ravel(dot(fall, own.centre[0]) * own.mass) * factor
    for loaded in loaded_blocks(motion):
        for load in sorted_loads(motion)[0]:
            energy: Number = load.energy(loaded)
            potential[loaded.poses] += np.ravel(energy)
    return SimulatedEnergy(kinetic, potential, work)


def sorted_loads(motion: Motion) -> tuple[tuple[Load, ...], tuple[Load, ...]]:
    """Return the loads that have a potential, and the others."""
    first = next(iter(loaded_blocks(motion)))
    loads = motion.mechanism.loads.values()
    stored = [load for load in loads if load.energy(first) is not None]
    return tuple(stored), tuple(load for load in loads if load not in stored)
