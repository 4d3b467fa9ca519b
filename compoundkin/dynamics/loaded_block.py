"""Some designs x some poses of a solved motion as loads see them, and the wrenches on each link."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from compoundkin.base.arrays import Number
from compoundkin.base.errors import Problem, UnknownName
from compoundkin.base.poses import FIXED, Pose
from compoundkin.base.series import Series, as_series
from compoundkin.base.wrenches import Wrench
from compoundkin.kinematics.block import Block, blocks, rectangle
from compoundkin.kinematics.driver_values import fit, mapped
from compoundkin.kinematics.extremes import extended_to
from compoundkin.kinematics.motion import Motion
from compoundkin.model.loads.contract import Load
from compoundkin.model.loads.mass import Mass
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import Ends
from compoundkin.model.units import Units
from compoundkin.structure.kinematic_structure import Structure


@dataclass(frozen=True)
class LoadedBlock:
    """Some designs x some poses of a motion, with the quantities that loads need."""

    motion: Motion
    block: Block
    designs: slice
    poses: slice
    counted: dict[str, Number] = field(default_factory=dict)  # angles of pairs over the whole motion, computed once

    @cached_property
    def units(self) -> Units:
        """The mechanism's units."""
        return self.motion.mechanism.stated_units

    @property
    def time(self) -> Number | None:
        """The times in seconds, None for a motion that is not in time."""
        return None if self.motion.time is None else self._cut(fit(self.motion.shape)(self.motion.time))

    def pose(self, link: str) -> Pose:
        """Return the pose of a link with its derivatives."""
        return self.block.world[link]

    def place(self, link: str, point: str | complex) -> Series:
        """Return the position of a point of a link, given by its letter or its place in the link."""
        own = self.motion.mechanism.geometry.points[link][point] if isinstance(point, str) else point
        return as_series(self.block.world[link].at(self.fitted(own)))

    def pair(self, name: str) -> tuple[Pair, Ends]:
        """Return a pair by its name, and its sides on its links."""
        return self.motion.solving_order.pairs[name], self.block.ends[name]

    def coordinate(self, name: str) -> Series:
        """Return the free coordinate of a pair or a driver. Angles are counted along the motion."""
        pair, sign = self._meant(name)
        found = pair.coordinate(self._ends(pair), self._poses(pair))
        value = self._counted(pair) if pair.free_is_angle else found.c[0]
        return Series((value * sign, *(one * sign for one in found.c[1:])))

    def _counted(self, pair: Pair) -> Number:
        """Return an angle with its turns over the whole motion, computed once for all blocks."""
        if pair.name not in self.counted:
            self.counted[pair.name] = fit(self.motion.shape)(self.counted_angle(pair))
        return self._cut(self.counted[pair.name])

    def counted_angle(self, pair: Pair) -> Number:
        """Return the angle of a pair with its turns, or between two links of a multiple pin that no pair joins.

        A driver's is as it is driven, whatever turn it starts in.
        """
        for name, own in self.motion.structure.driven.items():
            if own.pair.name == pair.name:
                return self.motion.drives[name].value * own.pair.driven_by(own.drive.link)
        if pair.name in self.motion.solving_order.pairs:
            return self.motion.pairs[pair.name].value
        first, second = (self.motion.links[link].angle for link in pair.members)
        return second - first

    def unit_effort(self, name: str) -> Iterator[tuple[str, Wrench]]:
        """Yield the links of a pair with the wrenches of a unit effort."""
        pair, sign = self._meant(name)
        unit = pair.wrenches(self._ends(pair), self._poses(pair))[-1].times(float(sign))
        yield pair.members[1], unit
        yield pair.members[0], -unit

    def _meant(self, name: str) -> tuple[Pair, int]:
        """Return the pair of a name, as the motion has it where it does, and the sign of the coordinate."""
        meant = self.motion.solving_order.pair_meant(name)
        if meant is None:
            raise UnknownName(Problem(name, "there is no such pair, pin or driver"))
        return meant

    def _ends(self, pair: Pair) -> Ends:
        """Return the sides of a pair; two links of a multiple pin may have one that no group uses."""
        known = self.block.ends.get(pair.name)
        if known is not None:
            return known
        return tuple(mapped(end, self.fitted) for end in pair.ends(self.motion.mechanism.geometry))

    def _poses(self, pair: Pair) -> tuple[Pose, ...]:
        return tuple(self.block.world[name] for name in pair.members)

    def fitted(self, value: Any, where: str = "load") -> Number:
        """Return the part of a value at these poses. `where` names it in errors."""
        return self._cut(extended_to(self.motion, value, where))

    def _cut(self, value: Number) -> Number:
        return rectangle(value, self.designs, self.poses)

    def known(self, inertia: bool) -> dict[str, Wrench]:
        """Return the known wrench on every link: loads, weights, and inertia if requested."""
        found = self.applied()
        for mass in self.motion.mechanism.masses.values() if inertia else ():
            found[mass.link] = found.get(mass.link, Wrench()) + self.inertia(mass)
        return found

    def applied(self) -> dict[str, Wrench]:
        """Return the wrench of loads and weights on every link."""
        found: dict[str, Wrench] = {}
        for _, link, wrench in self.named_loads():
            found[link] = found.get(link, Wrench()) + wrench
        return found

    def named_loads(self) -> Iterator[tuple[Load | Mass, str, Wrench]]:
        """Yield each load and each weight, with a link and its wrench there."""
        mechanism = self.motion.mechanism
        for load in mechanism.loads.values():
            for link, wrench in load.wrenches(self):
                yield load, link, wrench
        for mass in mechanism.masses.values() if mechanism.gravity != 0 else ():
            yield mass, mass.link, self.weight(mass)

    def freed(self, link: str, wrench: Wrench) -> Wrench:
        """Return a wrench on a link without the moment on a link that turns freely, such as a roller."""
        return without_free_turning(self.motion.structure, self.block, link, wrench)

    def weight(self, mass: Mass) -> Wrench:
        """Return the weight of a link."""
        pull = self.fitted(mass.mass) * (self.units.inertia * self.motion.mechanism.free_fall)
        return Wrench.at(self.place(mass.link, mass.at).c[0], pull)

    def inertia(self, mass: Mass) -> Wrench:
        """Return the inertia wrench of a link.

        It is minus mass times acceleration, minus inertia times that of the angle.

        Source: J. le Rond d'Alembert's principle, about the mass centre.
        """
        factor = self.units.inertia
        centre = self.place(mass.link, mass.at)
        pull = _second(centre) * (self.fitted(mass.mass) * -factor)
        turning = self.block.world[mass.link].u
        spin = _angular_acceleration(turning) * (self.fitted(mass.inertia) * -factor)
        return Wrench.at(centre.c[0], pull, spin)


def without_free_turning(structure: Structure, block: Block, link: str, wrench: Wrench) -> Wrench:
    """Return a wrench on a link; of a link that turns freely only the force at its pin."""
    if not any(spin.link == link for spin in structure.passive):
        return wrench
    spun = (step for body in structure.bodies for step in body.driven if step.is_passive)
    pin = next(step.pair for step in spun if step.drive.link == link)
    end = block.ends[pin.name][pin.members.index(link)]
    return Wrench.at(block.world[link].at(end.point).c[0], wrench.force)


def loaded_blocks(motion: Motion) -> Iterator[LoadedBlock]:
    """Yield a motion in blocks whose arrays stay in cache."""
    inputs, counted = motion.inputs, dict[str, Number]()
    for designs, poses in blocks(inputs.designs, inputs.poses):
        cut = inputs.cut(designs, poses)
        world = {name: _pose(pose, designs, poses) for name, pose in motion.poses.items()}
        shape = (designs.stop - designs.start, poses.stop - poses.start)
        yield LoadedBlock(motion, Block(shape, cut.ends, world, {}, motion.order), designs, poses, counted)


def _pose(pose: Pose, designs: slice, poses: slice) -> Pose:
    if pose is FIXED:
        return pose
    return pose.mapped(lambda series: Series(tuple([rectangle(c, designs, poses) for c in series.c])))


def _second(series: Series) -> Number:
    """Return the second time derivative."""
    return series.c[2] * 2.0 if len(series.c) > 2 else 0j


def _angular_acceleration(turning: Series) -> Number:
    return turning.turning().c[1] if len(turning.c) > 2 else 0.0
