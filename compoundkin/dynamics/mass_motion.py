"""Masses in motion: mass centres and their derivatives, the inertia that drivers feel, and the equation of motion.

With velocities v_i of the mass centres and angular velocities w_i at unit rate of driver i, and the accelerations that
the links have at the drivers' true speeds without any acceleration of theirs, the principle of virtual work gives
M_ij = sum m v_i . v_j + J w_i w_j and h_i = sum m v_i . a + J w_i alpha in M(q) q'' + h(q, q') = Q: no constraints, no
differences.

Source: T. R. Kane and D. A. Levinson, Dynamics: Theory and Applications, McGraw-Hill 1985, chapters 2 and 4.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number, cross, dot
from compoundkin.base.display import ShortRepr, aligned_text
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.poses import Pose
from compoundkin.kinematics.extremes import Places, extended_to
from compoundkin.kinematics.jacobian import moved_together
from compoundkin.kinematics.motion import Motion
from compoundkin.model.geometry import FRAME
from compoundkin.model.loads.mass import Mass
from compoundkin.model.units import Units
from compoundkin.structure.kinematic_structure import Structure


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
        """The moment of the inertia forces about the world's origin, with reversed sign."""
        return cross(self.centre[0], self.force) + self.turning[1] * self.inertia


def mass_motions(motion: Motion) -> Iterator[MassMotion]:
    """Yield the masses with their motions, to the order of the motion."""
    free = {spin.link for spin in motion.structure.passive}
    for mass in motion.mechanism.masses.values():
        pose, place = motion.poses[mass.link], mass_centre_place(motion, mass)
        centre = tuple(pose.derivative(place, k) for k in range(motion.order + 1))
        # a link that turns freely, such as a roller, has no rotary inertia
        inertia = 0.0 if mass.link in free else extended_to(motion, mass.inertia)
        yield MassMotion(mass.link, extended_to(motion, mass.mass), inertia, centre, _turning(motion, pose))


def mass_centre_place(motion: Motion, mass: Mass) -> Number:
    """Return the place of a mass centre in its link's frame."""
    return extended_to(motion, motion.mechanism.mass_centre(mass))


def _turning(motion: Motion, pose: Pose) -> tuple[Number, ...]:
    turning = pose.u.turning()
    return tuple(turning.derivative(k) for k in range(motion.order))


def units_of_masses(motion: Motion) -> Units:
    """Return the units of a mechanism with masses. Raises InvalidInput where it has no units, or no masses."""
    units = motion.mechanism.stated_units
    if not motion.mechanism.masses:
        raise InvalidInput(Problem("masses", "no link has a mass", 'write mass("bar", 0.2, at=(50, 0), inertia=40)'))
    return units


# In a text, less than this part of the greatest is rounding: of rates, which are squared, next to a dead point.
NO_INERTIA = 1e-14


@dataclass(frozen=True, eq=False, repr=False)
class EquivalentInertia(ShortRepr):
    """The equivalent inertia at the drivers for every pose, and its derivatives by their coordinates.

    `matrix` is (..., drivers, drivers) and `slopes` (..., drivers, drivers, drivers), the last axis the coordinate that
    it is derived by. In units of mass and length, as masses are written: mass x length^2 for angles, a mass for slides.
    The kinetic energy is half of rates x matrix x rates.
    """

    drivers: tuple[str, ...]
    matrix: Number
    slopes: Number
    motion: Motion

    def text(self) -> str:
        """Return the least and greatest of it over the poses as text, with their places; angles in degrees.

        Of a single pose it is the value itself with its derivatives.
        """
        rows, units, motion = [], self.motion.mechanism.stated_units, self.motion
        ways = [units.length if motion.drives[name].is_angle else "" for name in self.drivers]
        largest = np.nanmax(np.abs(self.matrix).reshape(-1, *self.matrix.shape[-2:]), axis=0, initial=0.0)
        for i, j in zip(*np.triu_indices(len(ways)), strict=True):
            lengths = [way for way in (ways[i], ways[j]) if way]
            unit = " ".join((units.mass, *([f"{lengths[0]}^2"] if len(lengths) == 2 else lengths)))
            named = ", ".join(dict.fromkeys((self.drivers[i], self.drivers[j])))
            least = NO_INERTIA * float(np.sqrt(largest[i, i] * largest[j, j]))
            rows += self._rows(f"equivalent inertia at {named}", unit, self.matrix[..., i, j], least)
            for k, name in enumerate(self.drivers):
                by, size = ("rad", 1.0) if ways[k] else (units.length, float(np.max(motion.sizes)))
                rows += self._rows(f"its derivative by {name}", f"{unit}/{by}", self.slopes[..., i, j, k], least / size)
        return aligned_text(rows)

    def _rows(self, what: str, unit: str, values: Number, least: float) -> list[tuple[str | float, ...]]:
        """Return the extremes of values over the poses as rows of text; less than the least is rounding."""
        flat = np.reshape(values, (-1, self.motion.inputs.poses))
        flat = np.where(np.abs(flat) <= least, 0.0, flat)
        if not np.isfinite(flat).any():
            return [(what, "not assembled")]
        if flat.size == 1:
            return [(what, float(flat[0, 0]), unit)]
        rows: list[tuple[str | float, ...]] = []
        for word, found in (("least", np.nanargmin(flat)), ("greatest", np.nanargmax(flat))):
            design, pose = np.unravel_index(found, flat.shape)
            at = Places(self.motion, np.array([design]), np.array([float(pose)])).text(0)
            of = f"design {design}, " if len(flat) > 1 else ""
            rows.append((f"{what}, {word}", float(flat[design, pose]), unit, f"at {of}{at}"))
        return rows

    @property
    def inertia(self) -> Number:
        """The equivalent inertia at the only driver. Raises InvalidInput where there are several."""
        self._one()
        return self.matrix[..., 0, 0]

    @property
    def slope(self) -> Number:
        """Its derivative by the coordinate of the only driver. Raises InvalidInput where there are several."""
        self._one()
        return self.slopes[..., 0, 0, 0]

    def _one(self) -> None:
        if len(self.drivers) != 1:
            told = f"{len(self.drivers)} drivers have an equivalent inertia: {', '.join(self.drivers)}"
            raise InvalidInput(Problem("inertia", told, "take .matrix and .slopes"))


@checked
def equivalent_inertia(motion: Motion) -> EquivalentInertia:
    """Return the equivalent inertia at the drivers for every pose, with its derivatives.

    It depends on the poses only, not on speeds, loads and gravity. The derivatives follow from accelerations at
    constant unit speeds, without differences. Raises InvalidInput for a mechanism without masses.

    Source: reduced mass and its derivative, e.g. F. Wittenbauer, Graphische Dynamik, Springer 1923.

    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.model.loads.mass import mass
    >>> from compoundkin.model.mechanism import Mechanism
    >>> from compoundkin.kinematics import solve
    >>> bar, units = mass("crank", 3.0, at=(2, 0), inertia=1), {"length": "m", "mass": "kg", "force": "N"}
    >>> arm = Mechanism("m", link("frame", A=0), link("crank", A=0, B=4), drive("crank"), bar, units=units)
    >>> equivalent_inertia(solve(arm, [0.0, 1.0])).inertia.tolist()     # 1 + 3 x 2^2
    [13.0, 13.0]
    >>> print(equivalent_inertia(solve(arm, [0.5])).text())
    equivalent inertia at crank  13  kg m^2
    its derivative by crank       0  kg m^2/rad
    """
    units_of_masses(motion)
    drivers = tuple(motion.drives)
    with np.errstate(all="ignore"):
        alone = [_masses(motion, {name: 1.0}) for name in drivers]
        second = _second(motion, drivers, alone)
        count = len(drivers)
        matrix, slopes = np.empty((*motion.failed.shape, count, count)), np.empty((*motion.failed.shape, *(count,) * 3))
        for i in range(count):
            for j in range(count):
                matrix[..., i, j] = sum(a.product(1, b, 1) for a, b in zip(alone[i], alone[j], strict=True))
                for k in range(count):
                    slopes[..., i, j, k] = _slope(alone, second, (i, j, k))
    return EquivalentInertia(drivers, _in_motion_shape(motion, matrix), _in_motion_shape(motion, slopes), motion)


def _masses(motion: Motion, speeds: Mapping[str, Number]) -> tuple[MassMotion, ...]:
    return tuple(mass_motions(moved_together(motion, speeds, 2)))


def _second(
    motion: Motion, drivers: tuple[str, ...], alone: list[tuple[MassMotion, ...]]
) -> dict[tuple[int, int], tuple[MassMotion, ...]]:
    """Return the masses with second derivatives by two coordinates instead of accelerations."""
    found = {(k, k): moved for k, moved in enumerate(alone)}
    for i in range(len(drivers)):
        for k in range(i):
            both = _masses(motion, {drivers[i]: 1.0, drivers[k]: 1.0})
            mixed = tuple(_mixed(*of) for of in zip(both, alone[i], alone[k], strict=True))
            found[i, k] = found[k, i] = mixed
    return found


def _mixed(both: MassMotion, one: MassMotion, other: MassMotion) -> MassMotion:
    """Return the mixed second derivatives by two coordinates."""
    centre = 0.5 * (both.centre[2] - one.centre[2] - other.centre[2])
    turning = 0.5 * (both.turning[1] - one.turning[1] - other.turning[1])
    return MassMotion(both.link, both.mass, both.inertia, (both.centre[0], 0j, centre), (0.0, turning))


def _slope(
    alone: list[tuple[MassMotion, ...]], second: dict[tuple[int, int], tuple[MassMotion, ...]], at: tuple[int, int, int]
) -> Number:
    i, j, k = at
    rows = zip(second[i, k], alone[j], second[j, k], alone[i], strict=True)
    return sum(a.product(2, b, 1) + c.product(2, d, 1) for a, b, c, d in rows)


def _in_motion_shape(motion: Motion, values: Number) -> Number:
    """Return values (designs, poses, ...) in the motion's shape, NaN where poses are not assembled."""
    values[np.broadcast_to(motion.failed, values.shape[:2]) != 0] = np.nan
    return values.reshape(*motion.shape, *values.shape[2:])


OF_DESIGNS = "its numbers are arrays, and one design is simulated at a time"


class MovingMass(NamedTuple):
    """The mass of a moving link and its centre in the link's frame, in units consistent with forces."""

    link: str
    centre: complex
    mass: float
    inertia: float


def moving_masses(structure: Structure) -> tuple[MovingMass, ...]:
    """Return the masses of the links. Raises InvalidInput for arrays over designs.

    A link that turns freely, such as a roller, has no rotary inertia.
    """
    mechanism, free = structure.mechanism, {spin.link for spin in structure.passive}
    if np.size(mechanism.gravity) > 1:
        raise InvalidInput(Problem("gravity", OF_DESIGNS, "give single numbers"))
    factor, found = mechanism.stated_units.inertia, []
    for own in mechanism.masses.values():
        at = mechanism.mass_centre(own)
        if any(np.size(value) > 1 for value in (own.mass, own.inertia, at)):
            raise InvalidInput(Problem(f"masses.{own.link}", OF_DESIGNS, "give single numbers"))
        mass, inertia = (float(np.ravel(value)[0]) * factor for value in (own.mass, own.inertia))
        if own.link != FRAME:
            turned = 0.0 if own.link in free else inertia
            found.append(MovingMass(own.link, complex(np.ravel(at)[0]), mass, turned))
    return tuple(found)


class InertiaTerms(NamedTuple):
    """The mass matrix, the bias (inertia forces without accelerations of the drivers), and the weights."""

    matrix: Number
    bias: Number
    weight: Number


def inertia_terms(
    masses: Sequence[MovingMass], world: Mapping[str, Pose], count: int, gravity: complex
) -> InertiaTerms:
    """Return the terms of an equation of motion at one pose of `count` drivers.

    Each pose has in its columns the rates at unit rate of every driver, and last those of the true motion without
    accelerations of the drivers.
    """
    rates = np.zeros((2 * len(masses), count + 1), dtype=complex)
    second = np.zeros(2 * len(masses), dtype=complex)
    weights = np.empty(2 * len(masses))
    for k, own in enumerate(masses):
        pose = world[own.link]
        centre, u = pose.at(own.centre).c, pose.u.c
        weights[2 * k], weights[2 * k + 1] = own.mass, own.inertia
        if len(centre) > 2:
            rates[2 * k] = _flat(centre[1])
            second[2 * k] = 2.0 * _last(centre[2])
        if len(u) > 2:
            rates[2 * k + 1] = _flat(cross(u[0], u[1]))
            second[2 * k + 1] = 2.0 * _last(cross(u[0], u[2]))
    back = rates[:, :count].conj().T * weights
    falling = np.tile([gravity, 0j], len(masses))
    return InertiaTerms((back @ rates[:, :count]).real, (back @ second).real, (back @ falling).real)


def _flat(value: Number) -> Number:
    return value.reshape(-1) if isinstance(value, np.ndarray) else value


def _last(value: Number) -> Number:
    return value.reshape(-1)[-1] if isinstance(value, np.ndarray) else value
