"""The inertia that a mechanism's drivers feel, and its derivatives by their coordinates."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.dynamics.work.mass_motion import MassMotion, mass_motions, units_of_masses
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.unit_rates import moved_together


@dataclass(frozen=True, eq=False, repr=False)
class EquivalentInertia(ShortRepr):
    """The inertia that drivers feel at every pose, and its derivatives by their coordinates.

    `matrix` is (..., drivers, drivers) and `slopes` (..., drivers, drivers, drivers), the last axis the coordinate that
    it is derived by. In units of mass and length, as masses are written: mass x length^2 for angles, a mass for slides.
    The kinetic energy is half of rates x matrix x rates.
    """

    drivers: tuple[str, ...]
    matrix: Number
    slopes: Number

    @property
    def inertia(self) -> Number:
        """The inertia that the only driver feels. Raises InvalidInput where there are several."""
        self._one()
        return self.matrix[..., 0, 0]

    @property
    def slope(self) -> Number:
        """Its derivative by the coordinate of the only driver. Raises InvalidInput where there are several."""
        self._one()
        return self.slopes[..., 0, 0, 0]

    def _one(self) -> None:
        if len(self.drivers) != 1:
            told = f"{len(self.drivers)} drivers feel an inertia: {', '.join(self.drivers)}"
            raise InvalidInput(Problem("inertia", told, "take .matrix and .slopes"))


@checked
def equivalent_inertia(motion: Motion) -> EquivalentInertia:
    """Return the inertia that drivers feel at every pose, with its derivatives.

    It depends on the poses only: speeds, loads and gravity do not matter. The derivatives come of accelerations at
    constant unit speeds, without a difference. Raises InvalidInput for a mechanism without masses.

    Source: reduced mass and its derivative, e.g. F. Wittenbauer, Graphische Dynamik, Springer 1923.

    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.model.loads import mass
    >>> from compoundkin.model.mechanism import Mechanism
    >>> from compoundkin.kinematics import solve
    >>> bar, units = mass("crank", 3.0, at=(2, 0), inertia=1), {"length": "m", "mass": "kg", "force": "N"}
    >>> arm = Mechanism("m", link("frame", A=0), link("crank", A=0, B=4), drive("crank"), bar, units=units)
    >>> equivalent_inertia(solve(arm, [0.0, 1.0])).inertia.tolist()     # 1 + 3 x 2^2
    [13.0, 13.0]
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
    return EquivalentInertia(drivers, _shown(motion, matrix), _shown(motion, slopes))


def _masses(motion: Motion, speeds: Mapping[str, Number]) -> tuple[MassMotion, ...]:
    return tuple(mass_motions(moved_together(motion, speeds, 2)))


def _second(
    motion: Motion, drivers: tuple[str, ...], alone: list[tuple[MassMotion, ...]]
) -> dict[tuple[int, int], tuple[MassMotion, ...]]:
    """Return the masses with their second derivatives by two coordinates in the place of accelerations."""
    found = {(k, k): moved for k, moved in enumerate(alone)}
    for i in range(len(drivers)):
        for k in range(i):
            both = _masses(motion, {drivers[i]: 1.0, drivers[k]: 1.0})
            mixed = tuple(_mixed(*of) for of in zip(both, alone[i], alone[k], strict=True))
            found[i, k] = found[k, i] = mixed
    return found


def _mixed(both: MassMotion, one: MassMotion, other: MassMotion) -> MassMotion:
    """Return what two coordinates that move together add to the accelerations, by each of the two."""
    centre = 0.5 * (both.centre[2] - one.centre[2] - other.centre[2])
    turning = 0.5 * (both.turning[1] - one.turning[1] - other.turning[1])
    return MassMotion(both.link, both.mass, both.inertia, (both.centre[0], 0j, centre), (0.0, turning))


def _slope(
    alone: list[tuple[MassMotion, ...]], second: dict[tuple[int, int], tuple[MassMotion, ...]], at: tuple[int, int, int]
) -> Number:
    i, j, k = at
    rows = zip(second[i, k], alone[j], second[j, k], alone[i], strict=True)
    return sum(a.product(2, b, 1) + c.product(2, d, 1) for a, b, c, d in rows)


def _shown(motion: Motion, values: Number) -> Number:
    """Return values (designs, poses, ...) in the motion's shape, NaN where poses are not assembled."""
    values[np.broadcast_to(motion.failed, values.shape[:2]) != 0] = np.nan
    return values.reshape(*motion.shape, *values.shape[2:])
