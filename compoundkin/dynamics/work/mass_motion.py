"""Motions of mass centres and of the links that turn about them: what momenta and inertia are made of."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from compoundkin.base.arrays import Number, cross, dot
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.poses import Pose
from compoundkin.kinematics.extremes import given_over
from compoundkin.kinematics.motion import Motion
from compoundkin.model.loads.mass import Mass
from compoundkin.model.units import Units


@dataclass(frozen=True, eq=False, repr=False)
class MassMotion(ShortRepr):
    """A mass with the derivatives of its centre and of its link's angle. Arrays are (designs, poses)."""

    link: str
    mass: Number
    inertia: Number
    centre: tuple[Number, ...]
    turning: tuple[Number, ...]  # angular velocity, angular acceleration

    def product(self, own: int, other: MassMotion, k: int) -> Number:
        """Return the product of a derivative of each of two motions."""
        turning = self.turning[own - 1] * other.turning[k - 1]
        return dot(self.centre[own], other.centre[k]) * self.mass + turning * self.inertia

    @property
    def force(self) -> Number:
        """Mass times acceleration."""
        return self.centre[2] * self.mass

    @property
    def moment(self) -> Number:
        """The moment about the world's origin that the acceleration takes."""
        return cross(self.centre[0], self.force) + self.turning[1] * self.inertia


def mass_motions(motion: Motion) -> Iterator[MassMotion]:
    """Yield the masses with their motions, to the order of the motion."""
    free = {spin.link for spin in motion.structure.passive}
    for mass in motion.mechanism.masses.values():
        pose, place = motion.poses[mass.link], place_of(motion, mass)
        centre = tuple(pose.derivative(place, k) for k in range(motion.order + 1))
        # a link that may turn freely, such as a roller, is not turned
        inertia = 0.0 if mass.link in free else given_over(motion, mass.inertia)
        yield MassMotion(mass.link, given_over(motion, mass.mass), inertia, centre, _turning(motion, pose))


def place_of(motion: Motion, mass: Mass) -> Number:
    """Return the place of a mass centre in its link's frame."""
    return given_over(motion, motion.mechanism.mass_centre(mass))


def _turning(motion: Motion, pose: Pose) -> tuple[Number, ...]:
    turning = pose.u.turning()
    return tuple(turning.derivative(k) for k in range(motion.order))


def units_of_masses(motion: Motion) -> Units:
    """Return the units of a mechanism with masses. Raises InvalidInput where it has no units, or no masses."""
    units = motion.mechanism.stated_units
    if not motion.mechanism.masses:
        raise InvalidInput(Problem("masses", "no link has a mass", 'write mass("bar", 0.2, at=(50, 0), inertia=40)'))
    return units
