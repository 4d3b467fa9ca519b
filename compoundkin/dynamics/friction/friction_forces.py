"""Friction forces by name: their sizes and powers, poses at which pairs wedge, and efforts at rest and in reverse."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.copies import CopiesFields
from compoundkin.base.wrenches import Wrench
from compoundkin.dynamics.friction.coulomb_friction import NONE, SEVERAL
from compoundkin.dynamics.friction.friction_contacts import LoadedContact
from compoundkin.kinematics.motion import Motion, Named
from compoundkin.model.attributes import unit_suffix

REASONS = {NONE: "no forces satisfy Coulomb's law", SEVERAL: "more than one set of forces satisfies Coulomb's law"}


@dataclass(frozen=True)
class Wedged:
    """A stretch of poses at which a mechanism is wedged. In its `pair` friction amplifies itself most."""

    pair: str
    stretch: PoseStretch
    reason: str

    def __str__(self) -> str:
        return f"wedged in {self.pair}, {self.stretch}: {self.reason}"


@dataclass(frozen=True, eq=False, repr=False)
class FrictionForces(CopiesFields):
    """The frictions of a motion. Arrays are (designs, poses) here, of the motion's shape in `pairs`.

    `sizes` by pairs are for a unit normal force, toward a growing coordinate of the pair; `state` is the number of
    solutions, `worst` the pair that wedges first. `backward` are the drivers' efforts in reversed motion, `intervals`
    the least and greatest efforts that hold a mechanism at rest. `undetermined` are the pairs whose normal force, and
    hence friction, equilibrium does not determine; all forces are then undetermined at the poses `left_open`, unless
    one of many possible distributions is `assumed`.
    """

    motion: Motion
    contacts: tuple[LoadedContact, ...]
    sizes: Mapping[str, Number]
    units: Mapping[str, Wrench]
    state: Number
    worst: Number
    resting: Number
    backward: Mapping[str, Number]
    intervals: Mapping[str, tuple[Number, Number]]
    undetermined: tuple[str, ...] = ()
    left_open: Number = False
    assumed: bool = False

    @cached_property
    def pairs(self) -> Mapping[str, PairFriction]:
        """The friction of every pair that has some, by the pair's name."""
        contacts = {contact.name: contact for contact in self.contacts}
        return Named("pair with friction", tuple(contacts), lambda name: PairFriction(self, contacts[name]))

    @property
    def power(self) -> Number:
        """The power of all frictions, never positive."""
        return sum((one.power for one in self.pairs.values()), np.zeros(self.motion.shape))

    def known(self, value: Number) -> Number:
        """Return a value in the motion's shape, NaN where not assembled or undetermined by friction."""
        return self.motion.grid.known(value if self.assumed else np.where(self.left_open, np.nan, value))

    @cached_property
    def remarks(self) -> tuple[str, ...]:
        """Remarks for a report: wedging, undetermined frictions, rest."""
        found = [str(one) for one in self.wedged]
        told = "equilibrium does not determine the normal force in {}, nor with its friction the drivers' efforts"
        found += [told.format(name) for name in self.undetermined]
        if self.contacts and np.any(self.resting):
            found.append("where no driver moves, efforts are intervals; forces of pairs are without friction")
        return tuple(found)

    @property
    def at_rest(self) -> Number:
        """Poses at which no driver moves: efforts are intervals, and forces of pairs are without friction."""
        return self.motion.grid.shaped(self.resting)

    @cached_property
    def wedged(self) -> tuple[Wedged, ...]:
        """The stretches of poses without forces, each with its pair and the reason."""
        return tuple(self._stretches())

    @property
    def is_wedged(self) -> Number:
        """The poses at which it is wedged, (designs, poses)."""
        return np.isin(self.state, tuple(REASONS)) & (self.motion.failed == 0)

    def _stretches(self) -> Iterator[Wedged]:
        stuck = self.is_wedged
        count = max(len(self.contacts), 1)
        for label, stretch in stretches_where(self.motion, np.where(stuck, self.state * count + self.worst, -1)):
            yield Wedged(self.contacts[label % count].name, stretch, REASONS[label // count])

    def __repr__(self) -> str:
        stuck = f", {len(self.wedged)} stretches wedged" if self.wedged else ""
        return f"FrictionForces({', '.join(contact.name for contact in self.contacts)}{stuck})"


@dataclass(frozen=True, eq=False, repr=False)
class PairFriction:
    """The friction in a pair, on its second link from its first."""

    forces: FrictionForces
    contact: LoadedContact

    @property
    def name(self) -> str:
        """The name of the pair."""
        return self.contact.name

    @property
    def is_moment(self) -> bool:
        """Whether it is a moment, as in a pin; else a force."""
        return self.contact.pair.is_couple

    @property
    def friction(self) -> Number:
        """The force, or in a pin the moment, positive toward a growing coordinate."""
        unit = self.forces.units[self.name]
        size = unit.moment if self.is_moment else np.abs(unit.force)
        return self.forces.known(self.forces.sizes[self.name] * size)

    @property
    def wrench(self) -> Wrench:
        """What it is on the second link, about the world's origin, (designs, poses)."""
        return self.forces.units[self.name].times(self.forces.sizes[self.name])

    @property
    def power(self) -> Number:
        """Its power, never positive."""
        poses = self.forces.motion.poses
        first, second = (poses[name] for name in self.contact.pair.rubbing)
        return self.forces.known(self.wrench.power(second) - self.wrench.power(first))

    def __repr__(self) -> str:
        return f"PairFriction({self.name}: {'moment' if self.is_moment else 'force'})"


def no_friction(motion: Motion) -> FrictionForces:
    """Return the empty frictions of a motion without friction."""
    nothing = np.zeros(motion.failed.shape, dtype=int)
    return FrictionForces(motion, (), {}, {}, nothing, nothing, nothing > 0, {}, {})


@dataclass(frozen=True)
class PoseStretch:
    """Neighbouring poses of a design, from index `first` to index `last`.

    `values` are those of the first driver at both ends, radians or lengths.
    """

    design: int
    first: int
    last: int
    driver: str
    values: tuple[float, float]
    where: str

    def __str__(self) -> str:
        return self.where


def stretches_where(motion: Motion, labels: Number) -> Iterator[tuple[int, PoseStretch]]:
    """Yield the stretches of poses with equal labels (designs, poses) and these; negative labels are skipped."""
    driver = next(iter(motion.inputs.drives))
    values = np.broadcast_to(motion.inputs.drives[driver][0], labels.shape)
    for design in np.flatnonzero((labels >= 0).any(axis=1)).tolist():
        row = labels[design]
        starts = np.flatnonzero(np.diff(row, prepend=-1)).tolist()
        for start, stop in zip(starts, [*starts[1:], len(row)], strict=True):
            if row[start] >= 0:
                ends = float(values[design, start]), float(values[design, stop - 1])
                where = _driver_range(motion, driver, ends, stop - start)
                yield int(row[start]), PoseStretch(design, start, stop - 1, driver, ends, where)


def _driver_range(motion: Motion, driver: str, ends: tuple[float, float], poses: int) -> str:
    is_angle = motion.structure.driven_angles[driver]
    unit = unit_suffix(is_angle, motion.mechanism.unit)
    low, high = (f"{np.rad2deg(end) if is_angle else end:.6g}" for end in ends)
    return f"{driver} at {low}{unit}" if poses == 1 else f"{driver} from {low} to {high}{unit}"
