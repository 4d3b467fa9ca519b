"""The efforts of drivers along their coordinates, and the power and energy of everything that acts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from compoundkin.base.arrays import Number, cross
from compoundkin.base.copies import CopiesFields
from compoundkin.base.display import DisplaysHtml
from compoundkin.base.wrenches import Wrench
from compoundkin.dynamics.force_result import ForceResult
from compoundkin.dynamics.loaded_block import LoadedBlock, loaded_blocks
from compoundkin.dynamics.reactions.link_wrench import FRICTION
from compoundkin.dynamics.reactions.pair_forces import PairForce
from compoundkin.kinematics.motion import Motion, described
from compoundkin.kinematics.quantities import Quantity, Table, table_of
from compoundkin.model.loads.mass import Mass
from compoundkin.structure.mobility_count import DrivenPair


@dataclass(frozen=True, eq=False, repr=False)
class DriverEffort:
    """What a driver does: its torque or thrust along its coordinate, and its power."""

    forces: ForceResult
    driven: DrivenPair

    @property
    def name(self) -> str:
        """The name of the driver."""
        return self.driven.drive.name

    @property
    def unit(self) -> str:
        """The unit of the effort: that of a moment, or of a force."""
        units = self.forces.units
        return units.moment if self.is_angle else units.force

    @property
    def effort(self) -> Number:
        """The torque or thrust on the driven link. Positive where it drives the coordinate up."""
        pair = self.driven.pair
        return self.forces.friction.known(self.along * pair.driven_by(self.driven.drive.link))

    @property
    def interval(self) -> tuple[Number, Number]:
        """The least and the greatest effort that hold it, of the motion's shape.

        Where drivers move they are one number, the effort. At rest friction holds too, whichever way it is needed.
        """
        friction, effort = self.forces.friction, self.effort
        ends = friction.intervals.get(self.name)
        if ends is None:
            return effort, effort
        low, high = (np.where(friction.at_rest, friction.known(end), effort) for end in ends)
        return low, high

    @property
    def backward(self) -> Number:
        """The effort if all moves the other way, under the same loads."""
        found = self.forces.friction.backward.get(self.name)
        return self.effort if found is None else self.forces.friction.known(found)

    @property
    def along(self) -> Number:
        """The effort along the pair's own coordinate, (designs, poses)."""
        found = PairForce(self.forces, self.driven.pair)
        effort = self.driven.pair.effort(found.ends, found.poses, self.forces.wrenches[found.name])
        if not self.forces.singular:
            return effort
        # at change points it is determined though reactions may have no limit
        by_work = self.forces.efforts_by_work[self.name] * self.driven.pair.driven_by(self.driven.drive.link)
        return np.where(np.isfinite(effort), effort, by_work)

    @property
    def wrench(self) -> Wrench:
        """What it does to the second link of the driven pair, (designs, poses)."""
        found = PairForce(self.forces, self.driven.pair)
        return found.pair.wrenches(found.ends, found.poses)[-1].times(self.along)

    @property
    def power(self) -> Number:
        """Effort times rate, positive where the driver gives it."""
        return self.effort * self.derivative(1)

    @property
    def is_angle(self) -> bool:
        """Whether its coordinate is an angle, and its effort a torque."""
        found: bool = self.forces.motion.drives[self.name].is_angle
        return found

    def derivative(self, k: int) -> Number:
        """Return the k-th derivative of its coordinate, as of the motion."""
        found: Number = self.forces.motion.drives[self.name].derivative(k)
        return found

    def __repr__(self) -> str:
        return described(self, self.forces.grid, f"{self.name}: {self.unit}")


@dataclass(frozen=True, repr=False)
class Powers(DisplaysHtml, CopiesFields):
    """The power of all that acts in a motion, and its energies.

    Powers are in the unit of force times length per second, energies in that of moments; arrays have the motion's
    shape. Positive power drives the mechanism; `kinetic_rate` is the growth of kinetic energy. Springs and dampers are
    loads; the `potential` is that of gravity and of springs, but for those whose force is a function or a table.
    """

    motion: Motion
    drives: Mapping[str, Number]
    loads: Mapping[str, Number]
    gravity: Number
    friction: Number
    kinetic_rate: Number
    kinetic: Number
    potential: Number

    @cached_property
    def sum(self) -> Number:
        """The power of all that acts less the growth of kinetic energy: zero except for rounding."""
        given = sum((*self.drives.values(), *self.loads.values()), start=self.gravity + self.friction)
        return given - self.kinetic_rate

    @property
    def table(self) -> Table:
        """All of it as columns, a row for each pose."""
        drivers = table_of(self.motion, *self.motion.drives)
        units = self.motion.mechanism.stated_units
        named = {
            **{f"{name}.power": value for name, value in (*self.drives.items(), *self.loads.items())},
            "gravity.power": self.gravity,
            "friction.power": self.friction,
            "kinetic.rate": self.kinetic_rate,
            "sum": self.sum,
        }
        energies = {"kinetic.energy": self.kinetic, "potential.energy": self.potential}
        found = (
            *(Quantity(name, units.power, np.reshape(value, -1)) for name, value in named.items()),
            *(Quantity(name, units.moment, np.reshape(value, -1)) for name, value in energies.items()),
        )
        return Table(f"{self.motion.mechanism.title}: power", (*drivers.columns, *found))

    def __repr__(self) -> str:
        loads = f"{len(self.drives)} drivers, {len(self.loads)} loads"
        return f"Powers({loads}, {np.size(self.gravity)} poses)"


def powers_of(forces: ForceResult) -> Powers:
    """Return the powers and energies of forces. Raises InvalidInput for a motion without velocities."""
    motion = forces.motion
    motion.grid.require(1)
    found: dict[str, dict[str, Number]] = {"loads": {name: _zeros(motion) for name in motion.mechanism.loads}}
    found["sums"] = {name: _zeros(motion) for name in ("gravity", "friction", "rate", "kinetic", "potential")}
    with np.errstate(all="ignore"):
        for at in loaded_blocks(motion):
            for name, value in _loads(at).items():
                found["loads"][name][at.designs, at.poses] = value
            for name, value in _sums(at, forces).items():
                found["sums"][name][at.designs, at.poses] = value
    loads, sums = ({name: motion.grid.known(value) for name, value in part.items()} for part in found.values())
    drives = {name: DriverEffort(forces, driven).power for name, driven in motion.structure.driven.items()}
    if forces.held is not None:
        drives[forces.held.name] = forces.held.power
    return Powers(
        motion, drives, loads, sums["gravity"], sums["friction"], sums["rate"], sums["kinetic"], sums["potential"]
    )  # fmt: skip


def _zeros(motion: Motion) -> Number:
    return np.zeros(motion.failed.shape)


def _loads(at: LoadedBlock) -> dict[str, Number]:
    """Return the power of every load."""
    found: dict[str, Number] = {}
    for load in at.motion.mechanism.loads.values():
        for link, wrench in load.wrenches(at):
            found[load.name] = found.get(load.name, 0.0) + at.freed(link, wrench).power(at.pose(link))
    return found


def _sums(at: LoadedBlock, forces: ForceResult) -> dict[str, Number]:
    """Return sums over masses and frictions: the powers of weights, inertia and friction, and the energies."""
    found: dict[str, Number] = dict.fromkeys(("gravity", "friction", "rate", "kinetic", "potential"), 0.0)
    free_fall = at.motion.mechanism.free_fall
    for load in at.motion.mechanism.loads.values():
        energy = load.energy(at)
        found["potential"] += 0.0 if energy is None else energy
    for mass in at.motion.mechanism.masses.values():
        heavy = at.fitted(mass.mass) * at.units.inertia
        centre = at.place(mass.link, mass.at)
        found["gravity"] += at.freed(mass.link, at.weight(mass)).power(at.pose(mass.link))
        found["potential"] -= heavy * (np.conj(free_fall) * centre.c[0]).real
        found["kinetic"] += _kinetic(at, mass)
        if forces.inertia:
            found["rate"] -= at.freed(mass.link, at.inertia(mass)).power(at.pose(mass.link))
    for one in (one for one in forces.more if one.kind == FRICTION):
        found["friction"] += one.whole.part(at.designs, at.poses).power(at.pose(one.on))
    return found


def _kinetic(at: LoadedBlock, mass: Mass) -> Number:
    """Return the kinetic energy of a link. A link that turns freely, such as a roller, does not turn."""
    factor = 0.5 * at.units.inertia
    found = at.fitted(mass.mass) * np.abs(at.place(mass.link, mass.at).derivative(1)) ** 2
    if all(spin.link != mass.link for spin in at.motion.structure.passive):
        turning = at.pose(mass.link).u
        found = found + at.fitted(mass.inertia) * cross(turning.c[0], turning.derivative(1)) ** 2
    return found * factor
